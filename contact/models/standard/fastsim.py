"""Tractions of rolling contact by Kalker's simplified theory, strip by strip: FASTSIM.

J. J. Kalker, Vehicle System Dynamics 11 (1982) 1-13, doi:10.1080/00423118208968684. Three flexibilities, one each for
longitudinal and lateral creepage and for spin, from the coefficients of the ellipse with the patch's second moments;
tractions are bounded by friction times a parabola along each strip with the strip's normal force: Kalker's paraboloid
has the patch's, so that strips at its sides slide with less than friction times their load, those in its middle with
more. Integration in the slip zone is of second order: 16 cells are as accurate as 64 are with steps of first order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing


class ElasticFoundation(NamedTuple):
    """Flexibilities m/Pa: displacement by traction, of pure longitudinal and lateral creepage and of spin."""

    along: float
    across: float
    spin: float


@borrowing
def foundation(a: float, b: float, G: float, kalker: tuple[float, float, float]) -> ElasticFoundation:
    """Flexibilities of an elliptic patch (Kalker 1990, eq. 2.79).

    Parameters:
        a, b: semi-axes, m.
        G: shear modulus, Pa.
        kalker: coefficients C11, C22, C23.
    """
    return ElasticFoundation(
        8.0 * a / (3.0 * G * kalker[0]),
        8.0 * a / (3.0 * G * kalker[1]),
        np.pi * a * np.sqrt(a / b) / (4.0 * G * kalker[2]),
    )


@borrowing
def next_traction(qx: float, qy: float, dx: float, dy: float, bound: float) -> tuple[float, float, float]:
    """Traction Pa after increments of displacement over flexibility dx, dy Pa, and the excess of the elastic one over
    the bound Pa: 0 where the surfaces stick.
    """
    square = (qx - dx) * (qx - dx) + (qy - dy) * (qy - dy)
    if square <= bound * bound:
        return qx - dx, qy - dy, 0.0
    before, size = np.sqrt(qx * qx + qy * qy), np.sqrt(square)
    # the previous traction is reduced so that its direction is of second order in the step
    factor = max(1.0 + 0.5 * (bound - size) / before, 0.5) if before > 0.0 else 1.0
    qx, qy = factor * qx - dx, factor * qy - dy
    scale = bound / np.sqrt(qx * qx + qy * qy)
    return scale * qx, scale * qy, size - bound


@borrowing
def strip_tractions(
    half: float,
    creep: tuple[float, float],
    spin: tuple[float, float, float],
    flexible: ElasticFoundation,
    bounds: Array,
    traction: Array,
    slip: Array,
) -> None:
    """Fill tractions on the faster body and slips in the middles of m uniform cells of a strip, from the trailing end.

    Parameters:
        half: half length, m.
        creep: longitudinal and lateral creepage at the centre of the patch.
        spin: increments of both in the middle of this strip, and derivative of the lateral one along x, 1/m.
        flexible: flexibilities, m/Pa.
        bounds: (m,) Pa, of the traction.
        traction: (m, 2) Pa, filled.
        slip: (m, 2) over the speed, filled.
    """
    m = len(bounds)
    h, qx, qy = 2.0 * half / m, 0.0, 0.0
    mean = 0.5 * (flexible.along + flexible.across)
    step, x = 0.5 * h, half - 0.25 * h
    for i in range(m - 1, -1, -1):
        dx = step * (creep[0] / flexible.along + spin[0] / flexible.spin)
        dy = step * (creep[1] / flexible.across + (spin[1] + spin[2] * x) / flexible.spin)
        qx, qy, beyond = next_traction(qx, qy, dx, dy, bounds[i])
        excess = beyond * mean / (step * bounds[i]) if beyond > 0.0 else 0.0
        slip[i, 0], slip[i, 1] = -excess * qx, -excess * qy
        traction[i, 0], traction[i, 1] = qx, qy
        x -= 0.75 * h if i == m - 1 else h
        step = h
