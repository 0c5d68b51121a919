"""Tractions of rolling contact by Kalker's simplified theory, strip by strip: FASTSIM.

J. J. Kalker, Vehicle System Dynamics 11 (1982) 1-13, doi:10.1080/00423118208968684. Three flexibilities, one each for
longitudinal and lateral creepage and for spin, from the coefficients of the ellipse with the patch's second moments.

Where surfaces stick, tractions q fall along the strip by e, the rate of displacements over their flexibilities: a
complex number, as q is. The rigid slip w has another direction. With e = w / L at every place, L a complex flexibility,
slip against q gives q' = -e - k (e / w) q, k >= 0: where all slides, q is opposite to w, not to e. Of e / w only the
angle counts; instead of its tangent the sums take `turn_of`, which is smooth where e or w vanishes.

Tractions are bounded by friction times a parabola along each strip with the strip's normal force: Kalker's paraboloid
has the patch's, so that strips at its sides slide with less than friction times their load, those in its middle with
more. Integration in the slip zone is of second order: 16 cells are as accurate as 64 are with steps of first order.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing

TINY = 1e-300


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
def turn_of(ex: float, ey: float, wx: float, wy: float) -> float:
    """Sine of the angle between rate of displacements over flexibilities and rigid slip over that of spin, less where
    their sizes differ: smooth where one is zero.
    """
    return 2.0 * (ey * (wx - ex) - ex * (wy - ey)) / (ex * ex + ey * ey + wx * wx + wy * wy + TINY)


@borrowing
def next_traction(qx: float, qy: float, dx: float, dy: float, turn: float, bound: float) -> tuple[float, float, float]:
    """Traction Pa after increments of displacement over flexibility, and the excess of the elastic one over the bound
    Pa: 0 where the surfaces stick.

    Parameters:
        qx, qy: Pa, traction before.
        dx, dy: Pa, increments.
        turn: imaginary over real part of the increments over the rigid slip.
        bound: Pa.
    """
    square = (qx - dx) * (qx - dx) + (qy - dy) * (qy - dy)
    if square <= bound * bound:
        return qx - dx, qy - dy, 0.0
    before, size = np.sqrt(qx * qx + qy * qy), np.sqrt(square)
    # half of the slip along the previous traction, half along the new one: directions are of second order in the step
    cut = min(0.5 * (size - bound) / before, 0.5) if before > 0.0 else 0.0
    nx, ny = qx - cut * (qx - turn * qy) - dx, qy - cut * (qy + turn * qx) - dy
    beyond = (nx * nx + ny * ny) / (bound * bound) - 1.0
    part = beyond / (1.0 + np.sqrt(1.0 + (1.0 + turn * turn) * beyond))
    real, imaginary = (1.0 + part) / (1.0 + beyond), part * turn / (1.0 + beyond)
    return real * nx + imaginary * ny, real * ny - imaginary * nx, size - bound


@borrowing
def strip_tractions(
    half: float,
    creep: tuple[float, float],
    own: tuple[float, float, float],
    flexible: ElasticFoundation,
    bounds: Array,
    traction: Array,
    slip: Array,
) -> None:
    """Fill tractions on the faster body and slips in the middles of m uniform cells of a strip, from the trailing end.

    Parameters:
        half: half length, m.
        creep: mean longitudinal and lateral creepage of the patch.
        own: both in the middle of this strip, and spin 1/m.
        flexible: flexibilities, m/Pa.
        bounds: (m,) Pa, of the traction.
        traction: (m, 2) Pa, filled.
        slip: (m, 2) over the speed, filled: means of both halves of the cells, with which tractions lose the power of
            the rigid slip.
    """
    m = len(bounds)
    h, qx, qy, before = 2.0 * half / m, 0.0, 0.0, 0.0
    apart_x = creep[0] * (1.0 / flexible.spin - 1.0 / flexible.along)
    apart_y = creep[1] * (1.0 / flexible.spin - 1.0 / flexible.across)
    softest, stiffest = max(flexible), min(flexible)
    step, x = 0.5 * h, half - 0.25 * h
    for i in range(m - 1, -2, -1):
        wx, wy = own[0] / flexible.spin, (own[1] + own[2] * x) / flexible.spin
        ex, ey = wx - apart_x, wy - apart_y
        after = np.sqrt((qx - step * ex) ** 2 + (qy - step * ey) ** 2)  # to no traction at the trailing end
        if i >= 0:
            qx, qy, after = next_traction(qx, qy, step * ex, step * ey, turn_of(ex, ey, wx, wy), bounds[i])
            traction[i, 0], traction[i, 1] = qx, qy
        rate, rigid = np.sqrt(ex * ex + ey * ey), flexible.spin * np.sqrt(wx * wx + wy * wy)
        after *= min(max(rigid / max(rate, TINY), stiffest), softest) / step
        if i < m - 1:
            mean = -0.5 * (before + after) / bounds[i + 1] if before > 0.0 else 0.0
            slip[i + 1, 0], slip[i + 1, 1] = mean * traction[i + 1, 0], mean * traction[i + 1, 1]
            if before == 0.0:  # slip that begins behind the middle of a cell is that of the next one
                after *= 2.0
        before = after
        x -= 0.75 * h if i == m - 1 or i == 0 else h
        step = h if i > 0 else 0.5 * h
