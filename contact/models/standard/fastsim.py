"""Tractions of rolling contact by Kalker's simplified theory, strip by strip: FASTSIM.

J. J. Kalker, Vehicle System Dynamics 11 (1982) 1-13, doi:10.1080/00423118208968684. Three flexibilities, one each for
longitudinal and lateral creepage and for spin, from the coefficients of the ellipse with the patch's second moments;
tractions are bounded by friction times a paraboloid of the patch's load, P (half^2 - x^2) on a strip of that half
length: on an ellipse Kalker's own, and on other patches what becomes of it. Where they slide they turn by steps of
second order: 16 cells do what 64 do otherwise.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


class ElasticFoundation(NamedTuple):
    """Flexibilities m/Pa: displacement by traction, of pure longitudinal and lateral creepage and of spin."""

    along: float
    across: float
    spin: float


@compiled
def bed(a: float, b: float, G: float, kalker: tuple[float, float, float]) -> ElasticFoundation:
    """Of an ellipse of semi-axes a, b [m], shear modulus G [Pa], coefficients C11, C22, C23 (Kalker 1990, eq. 2.79)."""
    return ElasticFoundation(
        8.0 * a / (3.0 * G * kalker[0]),
        8.0 * a / (3.0 * G * kalker[1]),
        np.pi * a * np.sqrt(a / b) / (4.0 * G * kalker[2]),
    )


@compiled
def strip_tractions(
    half: float,
    creep: tuple[float, float],
    spin: tuple[float, float, float],
    flexible: ElasticFoundation,
    bounds: Array,
    traction: Array,
    slip: Array,
) -> None:
    """Fill tractions (m, 2) Pa on the faster body and slips (m, 2) over the speed, on m equal cells of a strip of a
    half length m, from the trailing end.

    creep: longitudinal and lateral, of the patch's middle; spin: what this strip has more of both, and what the lateral
    one grows by along x, 1/m; bounds (m,) Pa. Tractions are those in the middles of the cells.
    """
    m = len(bounds)
    h, qx, qy = 2.0 * half / m, 0.0, 0.0
    mean = 0.5 * (flexible.along + flexible.across)
    step, x = 0.5 * h, half - 0.25 * h
    for i in range(m - 1, -1, -1):
        dx = step * (creep[0] / flexible.along + spin[0] / flexible.spin)
        dy = step * (creep[1] / flexible.across + (spin[1] + spin[2] * x) / flexible.spin)
        before, size = np.hypot(qx, qy), np.hypot(qx - dx, qy - dy)
        if size <= bounds[i]:
            qx, qy = qx - dx, qy - dy
            slip[i, 0] = slip[i, 1] = 0.0
        else:
            # what is there already, shortened so that the traction turns to second order in the step
            kept = max(1.0 + 0.5 * (bounds[i] - size) / before, 0.5) if before > 0.0 else 1.0
            qx, qy = kept * qx - dx, kept * qy - dy
            share = bounds[i] / np.hypot(qx, qy)
            qx, qy = share * qx, share * qy
            excess = (size - bounds[i]) * mean / (step * bounds[i])
            slip[i, 0], slip[i, 1] = -excess * qx, -excess * qy
        traction[i, 0], traction[i, 1] = qx, qy
        x -= 0.75 * h if i == m - 1 else h
        step = h
