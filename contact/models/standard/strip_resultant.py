"""Resultants of FASTSIM on strips and their derivatives, without units.

With the traction over the largest bound B of the strip, places over its half length l, and displacements over B, the
resultants are functions of five increments only: those of the rigid slip over the flexibility of spin L3 in the middle
of the strip, l wx / (L3 B), l wy / (L3 B), and its slope l^2 spin / (L3 B); and those by which elastic displacements
over their own flexibilities are less, l xi (1 / L3 - 1 / L1) / B and l eta (1 / L3 - 1 / L2) / B. Bounds over B are the
same for all strips. `LANES` strips are computed side by side, without branches, in vector instructions: a strip alone
waits in every cell for roots and divisions of the cell before.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.standard.fastsim import TINY, ElasticFoundation
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing

LANES, INCREMENTS = 8, 5
# First places of the rows in the lanes: increments, tractions and sums;
ALONG, ACROSS, TURNING, APART_X, APART_Y, QX, QY, SUM = (LANES * k for k in range(8))
# rates of displacement and of rigid slip, their turn, and 1 over the sum of their squares; traction before a step, cut
# of it, and 1 where this is below its largest value; elastic traction after the step; traction before it is bounded,
# its square over that of the bound less 1, root and part of the slip along the new traction; 1 where surfaces stick;
EX, EY, WX, WY, TURN, OVER, BEFORE_X, BEFORE_Y, CUT, REDUCED = (LANES * k for k in range(10, 20))
ELASTIC_X, ELASTIC_Y, NX, NY, BEYOND, ROOT, PART, STICKS = (LANES * k for k in range(20, 28))
# derivatives of the direction of the traction by those before, by the rates and by the slips;
BY_QX, BY_QY, BY_EX, BY_EY, BY_WX, BY_WY = (LANES * k for k in range(28, 34))
# derivatives of the traction by the increments, and their sums.
BY_X, BY_Y, SLOPES = (LANES * k for k in (34, 34 + INCREMENTS, 34 + 2 * INCREMENTS))
END = LANES * (34 + 5 * INCREMENTS)


@borrowing
def strip_increments(
    flexible: ElasticFoundation,
    creep: tuple[float, float],
    own: tuple[float, float, float],
    half: float,
    bound: float,
    increments: Array,
) -> None:
    """Fill the five increments of a strip.

    Parameters:
        flexible: flexibilities, m/Pa.
        creep: mean longitudinal and lateral creepage of the patch.
        own: creepages and spin 1/m in the middle of the strip.
        half, bound: half length m, and largest bound of the traction Pa.
        increments: (5,), filled.
    """
    size = half / bound
    increments[0], increments[1] = size * own[0] / flexible.spin, size * own[1] / flexible.spin
    increments[2] = size * half * own[2] / flexible.spin
    increments[3] = size * creep[0] * (1.0 / flexible.spin - 1.0 / flexible.along)
    increments[4] = size * creep[1] * (1.0 / flexible.spin - 1.0 / flexible.across)


@borrowing
def strip_resultants(increments: Array, bounds: Array, resultants: Array, lanes: Array) -> None:
    """Fill means over the cells of both tractions and of place times lateral traction of strips.

    Parameters:
        increments: (n, 5), see `strip_increments`.
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
    """As `strip_resultants`, and derivatives (n, 3, 5) by the increments, which are filled."""
    for first in range(0, len(increments), LANES):
        load_lanes(increments, first, lanes)
        roll(lanes, bounds, True)
        for k in range(min(LANES, len(increments) - first)):
            for d in range(3):
                resultants[first + k, d] = lanes[SUM + LANES * d + k] / len(bounds)
                for j in range(INCREMENTS):
                    slopes[first + k, d, j] = lanes[SLOPES + LANES * (INCREMENTS * d + j) + k] / len(bounds)


@borrowing
def load_lanes(increments: Array, first: int, lanes: Array) -> None:
    """Increments of strips from a first one on into the lanes, zero where there are none, and zero tractions."""
    lanes[:] = 0.0
    for k in range(min(LANES, len(increments) - first)):
        for d in range(INCREMENTS):
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
            direction_slopes(lanes, step, bounds[i])
            advance_slopes(lanes, 0, (1.0, 0.0), (1.0, 0.0), step, middle)
            advance_slopes(lanes, 1, (0.0, 1.0), (0.0, 1.0), step, middle)
            advance_slopes(lanes, 2, (0.0, place), (0.0, place), step, middle)
            advance_slopes(lanes, 3, (-1.0, 0.0), (0.0, 0.0), step, middle)
            advance_slopes(lanes, 4, (0.0, -1.0), (0.0, 0.0), step, middle)
        place -= 0.75 * h if i == m - 1 else h
        step = h


@borrowing
def advance(lanes: Array, step: float, place: float, bound: float) -> None:
    """Tractions one cell further, see `wheelrail.contact.models.standard.fastsim.next_traction`."""
    for k in range(LANES):
        qx, qy, wx, wy = lanes[QX + k], lanes[QY + k], lanes[ALONG + k], lanes[ACROSS + k] + lanes[TURNING + k] * place
        apart_x, apart_y = lanes[APART_X + k], lanes[APART_Y + k]
        ex, ey = wx - apart_x, wy - apart_y
        over = 1.0 / (ex * ex + ey * ey + wx * wx + wy * wy + TINY)
        turn = 2.0 * (ey * apart_x - ex * apart_y) * over
        elastic_x, elastic_y = qx - step * ex, qy - step * ey
        square = elastic_x * elastic_x + elastic_y * elastic_y
        cut = 0.5 * (np.sqrt(square) - bound) / np.sqrt(qx * qx + qy * qy)  # inf where there is no traction before
        reduced = cut < 0.5
        cut = cut if reduced else 0.5
        nx, ny = elastic_x - cut * (qx - turn * qy), elastic_y - cut * (qy + turn * qx)
        beyond = (nx * nx + ny * ny) / (bound * bound) - 1.0
        root = np.sqrt(1.0 + (1.0 + turn * turn) * beyond)
        part = beyond / (1.0 + root)
        real, imaginary = (1.0 + part) / (1.0 + beyond), part * turn / (1.0 + beyond)
        sticks = square <= bound * bound
        lanes[EX + k], lanes[EY + k], lanes[WX + k], lanes[WY + k] = ex, ey, wx, wy
        lanes[TURN + k], lanes[OVER + k], lanes[BEFORE_X + k], lanes[BEFORE_Y + k] = turn, over, qx, qy
        lanes[CUT + k], lanes[REDUCED + k] = cut, 1.0 if reduced else 0.0
        lanes[ELASTIC_X + k], lanes[ELASTIC_Y + k], lanes[NX + k], lanes[NY + k] = elastic_x, elastic_y, nx, ny
        lanes[BEYOND + k], lanes[ROOT + k], lanes[PART + k] = beyond, root, part
        lanes[STICKS + k] = 1.0 if sticks else 0.0
        lanes[QX + k] = elastic_x if sticks else real * nx + imaginary * ny
        lanes[QY + k] = elastic_y if sticks else real * ny - imaginary * nx


@borrowing
def direction_slopes(lanes: Array, step: float, bound: float) -> None:
    """Derivatives of the angle of the bounded traction, after `advance`.

    The traction before it is bounded, n = q - cut (1 + i turn) q - step e, is divided by 1 + part (1 + i turn).
    """
    for k in range(LANES):
        qx, qy, nx, ny = lanes[BEFORE_X + k], lanes[BEFORE_Y + k], lanes[NX + k], lanes[NY + k]
        ex, ey, wx, wy = lanes[EX + k], lanes[EY + k], lanes[WX + k], lanes[WY + k]
        turn, over, cut = lanes[TURN + k], lanes[OVER + k], lanes[CUT + k]
        beyond, root, part = lanes[BEYOND + k], lanes[ROOT + k], lanes[PART + k]
        square = 1.0 + beyond  # of n over that of the bound
        even = 1.0 + turn * turn
        by_n, by_square = 1.0 / (square * bound * bound), turn / (square * root * bound * bound)
        by_nx, by_ny = -ny * by_n - by_square * nx, nx * by_n - by_square * ny
        by_part = turn * (turn * beyond / root - 2.0 * turn * part) / even
        by_turn = -((1.0 + part) * part + by_part) / square
        by_turn += cut * (by_nx * qy - by_ny * qx)
        by_cut = by_ny * (-qy - turn * qx) + by_nx * (turn * qy - qx)
        along_x, along_y = lanes[ELASTIC_X + k], lanes[ELASTIC_Y + k]
        size = np.sqrt(along_x * along_x + along_y * along_y)
        before = 1.0 / np.sqrt(qx * qx + qy * qy) if lanes[REDUCED + k] > 0.0 else 0.0
        by_cut *= before
        by_size_x, by_size_y = 0.5 * by_cut * along_x / size, 0.5 * by_cut * along_y / size
        less = by_cut * cut * before
        lanes[BY_QX + k] = (1.0 - cut) * by_nx - cut * turn * by_ny + by_size_x - less * qx
        lanes[BY_QY + k] = (1.0 - cut) * by_ny + cut * turn * by_nx + by_size_y - less * qy
        by_turn *= 2.0 * over
        lanes[BY_EX + k] = -step * (by_nx + by_size_x) - by_turn * (wy + turn * ex)
        lanes[BY_EY + k] = -step * (by_ny + by_size_y) + by_turn * (wx - turn * ey)
        lanes[BY_WX + k], lanes[BY_WY + k] = by_turn * (ey - turn * wx), -by_turn * (ex + turn * wy)


@borrowing
def advance_slopes(
    lanes: Array, j: int, rate: tuple[float, float], slip: tuple[float, float], step: float, middle: float
) -> None:
    """Derivatives of the tractions by increment j one cell further, after `direction_slopes`, and their sums.

    Parameters:
        lanes: all rows.
        j: number of the increment.
        rate, slip: derivatives of rates of displacement and of rigid slip by the increment.
        step, middle: length and place of the cell.
    """
    x, y, sums = BY_X + LANES * j, BY_Y + LANES * j, SLOPES + LANES * j
    (rate_x, rate_y), (slip_x, slip_y) = rate, slip
    for k in range(LANES):
        by_x, by_y = lanes[x + k], lanes[y + k]
        angle = lanes[BY_QX + k] * by_x + lanes[BY_QY + k] * by_y
        angle += lanes[BY_EX + k] * rate_x + lanes[BY_EY + k] * rate_y
        angle += lanes[BY_WX + k] * slip_x + lanes[BY_WY + k] * slip_y
        sticks = lanes[STICKS + k] > 0.0
        by_x = by_x - step * rate_x if sticks else -lanes[QY + k] * angle
        by_y = by_y - step * rate_y if sticks else lanes[QX + k] * angle
        lanes[x + k], lanes[y + k] = by_x, by_y
        lanes[sums + k] += by_x
        lanes[sums + INCREMENTS * LANES + k] += by_y
        lanes[sums + 2 * INCREMENTS * LANES + k] += middle * by_y
