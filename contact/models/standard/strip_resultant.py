"""Resultants of FASTSIM on strips and their derivatives, without units.

With the traction over the largest bound B of the strip, places over its half length l, and displacements over B, the
resultants are functions of three increments only: l (xi / L1 + ..) / B, l (eta / L2 + ..) / B and l^2 phi / (L3 B).
Bounds over B are the same for all strips. `LANES` strips are computed side by side, without branches, in vector
instructions: a strip alone waits in every cell for roots and divisions of the cell before.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.standard.fastsim import ElasticFoundation
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing

Increments = tuple[float, float, float]

LANES = 8
# First places of the rows in the lanes: increments, tractions and sums;
ALONG, ACROSS, TURNING, QX, QY, SUM = (LANES * k for k in range(6))
# elastic traction after a step; traction before it, its size and its factor less 1, and 1 where this is above its least
# value; direction of the new one, and bound over its size before it is bounded; 1 where the surfaces stick;
EX, EY, SIZE, BEFORE_X, BEFORE_Y, BEFORE = (LANES * k for k in range(8, 14))
FACTOR, REDUCED, UX, UY, SHORTER, STICKS = (LANES * k for k in range(14, 20))
# derivatives of the traction by three increments, and their sums.
BY_X, BY_Y, SLOPES, END = (LANES * k for k in (20, 23, 26, 35))


@borrowing
def strip_increments(
    flexible: ElasticFoundation,
    creep: tuple[float, float],
    own: tuple[float, float, float],
    half: float,
    bound: float,
) -> Increments:
    """Increments of longitudinal and lateral displacement per half length in the middle of a strip, and slope of the
    lateral one along the strip.

    Parameters:
        flexible: flexibilities, m/Pa.
        creep: longitudinal and lateral creepage at the centre of the patch.
        own: creepages and spin 1/m in the middle of the strip.
        half, bound: half length m, and largest bound of the traction Pa.
    """
    (xi, eta), (wx, wy, spin) = creep, own
    return (
        half / bound * (xi / flexible.along + (wx - xi) / flexible.spin),
        half / bound * (eta / flexible.across + (wy - eta) / flexible.spin),
        half * half / bound * spin / flexible.spin,
    )


@borrowing
def strip_resultants(increments: Array, bounds: Array, resultants: Array, lanes: Array) -> None:
    """Fill means over the cells of both tractions and of place times lateral traction of strips.

    Parameters:
        increments: (n, 3), see `strip_increments`.
        bounds: (m,), of the traction on cells from the trailing end, over the largest one.
        resultants: (n, 3) filled.
        lanes: (END,), filled.

    The recursion is that of `wheelrail.contact.models.standard.fastsim.strip_tractions`.
    """
    for first in range(0, len(increments), LANES):
        load_lanes(increments, first, lanes)
        roll(lanes, bounds, False)
        for k in range(min(LANES, len(increments) - first)):
            for d in range(3):
                resultants[first + k, d] = lanes[SUM + LANES * d + k] / len(bounds)


@borrowing
def strip_slopes(increments: Array, bounds: Array, resultants: Array, slopes: Array, lanes: Array) -> None:
    """As `strip_resultants`, and derivatives (n, 3, 3) by the increments, which are filled."""
    for first in range(0, len(increments), LANES):
        load_lanes(increments, first, lanes)
        roll(lanes, bounds, True)
        for k in range(min(LANES, len(increments) - first)):
            for d in range(3):
                resultants[first + k, d] = lanes[SUM + LANES * d + k] / len(bounds)
                for j in range(3):
                    slopes[first + k, d, j] = lanes[SLOPES + LANES * (3 * d + j) + k] / len(bounds)


@borrowing
def load_lanes(increments: Array, first: int, lanes: Array) -> None:
    """Increments of strips from a first one on into the lanes, zero where there are none, and zero tractions."""
    lanes[:] = 0.0
    for k in range(min(LANES, len(increments) - first)):
        for d in range(3):
            lanes[LANES * d + k] = increments[first + k, d]


@borrowing
def roll(lanes: Array, bounds: Array, slopes: bool) -> None:
    """Tractions of all cells from the leading end, their sums and, if asked for, those of the derivatives."""
    m = len(bounds)
    h = 2.0 / m
    step, place = 0.5 * h, 1.0 - 0.25 * h
    for i in range(m - 1, -1, -1):
        advance(lanes, step, place, bounds[i])
        middle = (2.0 * i + 1.0) / m - 1.0
        for k in range(LANES):
            lanes[SUM + k] += lanes[QX + k]
            lanes[SUM + LANES + k] += lanes[QY + k]
            lanes[SUM + 2 * LANES + k] += middle * lanes[QY + k]
        if slopes:
            advance_slopes(lanes, 0, step, 0.0, middle)
            advance_slopes(lanes, 1, 0.0, step, middle)
            advance_slopes(lanes, 2, 0.0, step * place, middle)
        place -= 0.75 * h if i == m - 1 else h
        step = h


@borrowing
def advance(lanes: Array, step: float, place: float, bound: float) -> None:
    """Tractions one cell further, see `wheelrail.contact.models.standard.fastsim.next_traction`."""
    for k in range(LANES):
        qx, qy = lanes[QX + k], lanes[QY + k]
        dx, dy = step * lanes[ALONG + k], step * (lanes[ACROSS + k] + lanes[TURNING + k] * place)
        ex, ey = qx - dx, qy - dy
        square = ex * ex + ey * ey
        size, before = np.sqrt(square), np.sqrt(qx * qx + qy * qy)
        factor = 1.0 + 0.5 * (bound - size) / before  # -inf where there is no traction before
        reduced = factor > 0.5
        factor = factor if reduced else 0.5
        nx, ny = factor * qx - dx, factor * qy - dy
        shorter = bound / np.sqrt(nx * nx + ny * ny)
        sticks = square <= bound * bound
        lanes[EX + k], lanes[EY + k], lanes[BEFORE_X + k], lanes[BEFORE_Y + k] = ex, ey, qx, qy
        lanes[FACTOR + k], lanes[SIZE + k], lanes[BEFORE + k], lanes[SHORTER + k] = factor - 1.0, size, before, shorter
        lanes[UX + k], lanes[UY + k] = nx * shorter / bound, ny * shorter / bound
        lanes[REDUCED + k], lanes[STICKS + k] = 1.0 if reduced else 0.0, 1.0 if sticks else 0.0
        lanes[QX + k] = ex if sticks else shorter * nx
        lanes[QY + k] = ey if sticks else shorter * ny


@borrowing
def advance_slopes(lanes: Array, j: int, step_x: float, step_y: float, middle: float) -> None:
    """Derivatives of the tractions by increment j one cell further, after `advance`, and their sums.

    Parameters:
        lanes: all rows.
        j: number of the increment.
        step_x, step_y: derivatives of the displacements of the cell by the increment.
        middle: place of the cell.
    """
    x, y, sums = BY_X + LANES * j, BY_Y + LANES * j, SLOPES + LANES * j
    for k in range(LANES):
        by_x, by_y, qx, qy = lanes[x + k], lanes[y + k], lanes[BEFORE_X + k], lanes[BEFORE_Y + k]
        new_x, new_y, less, before = by_x - step_x, by_y - step_y, lanes[FACTOR + k], lanes[BEFORE + k]
        by_size = (lanes[EX + k] * new_x + lanes[EY + k] * new_y) / lanes[SIZE + k]
        by_before = (qx * by_x + qy * by_y) / before
        by_factor = -(0.5 * by_size + less * by_before) / before if lanes[REDUCED + k] > 0.0 else 0.0
        by_nx, by_ny = new_x + less * by_x + by_factor * qx, new_y + less * by_y + by_factor * qy
        ux, uy = lanes[UX + k], lanes[UY + k]
        across = (ux * by_ny - uy * by_nx) * lanes[SHORTER + k]
        by_x = new_x if lanes[STICKS + k] > 0.0 else -uy * across
        by_y = new_y if lanes[STICKS + k] > 0.0 else ux * across
        lanes[x + k], lanes[y + k] = by_x, by_y
        lanes[sums + k] += by_x
        lanes[sums + 3 * LANES + k] += by_y
        lanes[sums + 6 * LANES + k] += middle * by_y
