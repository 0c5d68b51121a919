"""Resultants of FASTSIM on a strip and their derivatives, without units.

With the traction over the largest bound B of the strip, places over its half length l, and displacements over B, the
resultants are functions of three increments only: l (xi / L1 + ..) / B, l (eta / L2 + ..) / B and l^2 phi / (L3 B).
"""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import unchecked

Increments = tuple[float, float, float]


@unchecked
def strip_resultant(increments: Increments, bounds: Array, resultant: Array, slopes: Array, scratch: Array) -> None:
    """Fill means over the cells of both tractions and of place times lateral traction (3,), and derivatives (3, 3).

    Parameters:
        increments: of longitudinal and lateral displacement per half length in the middle of the strip, and slope of
            the lateral one along the strip.
        bounds: (m,), of the traction on cells from the trailing end.
        resultant: (3,) filled.
        slopes: (3, 3) filled, by the increments.
        scratch: (4, 3).

    The recursion is that of `wheelrail.contact.models.standard.fastsim.strip_tractions`.
    """
    m, (along, across, turning) = len(bounds), increments
    qx, qy, h = 0.0, 0.0, 2.0 / m
    by_x, by_y, new_x, new_y = scratch[0], scratch[1], scratch[2], scratch[3]
    resultant[:], slopes[:], scratch[:] = 0.0, 0.0, 0.0
    step, place = 0.5 * h, 1.0 - 0.25 * h
    for i in range(m - 1, -1, -1):
        ex, ey, bound = qx - step * along, qy - step * (across + turning * place), bounds[i]
        for k in range(3):
            new_x[k], new_y[k] = by_x[k], by_y[k]
        new_x[0] -= step
        new_y[1] -= step
        new_y[2] -= step * place
        square = ex * ex + ey * ey
        if square <= bound * bound:
            qx, qy = ex, ey
            for k in range(3):
                by_x[k], by_y[k] = new_x[k], new_y[k]
        else:
            size, before = np.sqrt(square), np.sqrt(qx * qx + qy * qy)
            factor = 1.0 + 0.5 * (bound - size) / before if before > 0.0 else 1.0
            reduced = before > 0.0 and factor > 0.5
            factor = max(factor, 0.5)
            nx, ny = ex + (factor - 1.0) * qx, ey + (factor - 1.0) * qy
            norm = np.sqrt(nx * nx + ny * ny)
            ux, uy, shorter = nx / norm, ny / norm, bound / norm
            for k in range(3):
                by_nx, by_ny = new_x[k] + (factor - 1.0) * by_x[k], new_y[k] + (factor - 1.0) * by_y[k]
                if reduced:
                    by_size = (ex * new_x[k] + ey * new_y[k]) / size
                    by_before = (qx * by_x[k] + qy * by_y[k]) / before
                    by_factor = -(0.5 * by_size + (factor - 1.0) * by_before) / before
                    by_nx, by_ny = by_nx + by_factor * qx, by_ny + by_factor * qy
                across_n = (ux * by_ny - uy * by_nx) * shorter
                by_x[k], by_y[k] = -uy * across_n, ux * across_n
            qx, qy = bound * ux, bound * uy
        middle = (2.0 * i + 1.0) / m - 1.0
        resultant[0] += qx
        resultant[1] += qy
        resultant[2] += middle * qy
        for k in range(3):
            slopes[0, k] += by_x[k]
            slopes[1, k] += by_y[k]
            slopes[2, k] += middle * by_y[k]
        place -= 0.75 * h if i == m - 1 else h
        step = h
    for d in range(3):
        resultant[d] /= m
        for k in range(3):
            slopes[d, k] /= m
