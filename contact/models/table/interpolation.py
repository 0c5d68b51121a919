"""Interpolation on tensor products of unequally spaced nodes, with derivatives, compiled.

Along each axis the interpolant is a cubic Hermite polynomial in every interval, with the slopes of parabolas through
three nodes: continuous in value and slope, exact for quadratic functions. Two nodes are joined by a line; one node
stands for a constant.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled, fma

Four = tuple[float, float, float, float]
Coordinates = tuple[float, ...]
fast = partial(compiled, error_model="numpy")


class Grid(NamedTuple):
    """Values on a tensor product of nodes, for compiled code.

    Parameters:
        nodes: of all axes, one after the other, each increasing.
        counts: number of nodes of each axis, the first one changing slowest.
        values: (nodes * columns,).
        columns: numbers at a node.
    """

    nodes: Array
    counts: tuple[int, ...]
    values: Array
    columns: int


@fast
def interval(nodes: Array, x: float) -> int:
    """Number of the interval of increasing nodes (n,), n > 1, that an argument is in; the nearest one outside."""
    i = 0
    while i < len(nodes) - 2 and x >= nodes[i + 1]:
        i += 1
    return i


@fast
def stencil(nodes: Array, x: float) -> tuple[int, int, Four, Four]:
    """Weights of the values at up to four nodes around an argument.

    Parameters:
        nodes: (n,), increasing.
        x: argument, in the range of the nodes.

    Returns number of the first node, number of nodes, weights (zero beyond these), and their derivatives.
    """
    n = len(nodes)
    if n == 1:
        return 0, 1, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)
    i = interval(nodes, x)
    h = nodes[i + 1] - nodes[i]
    start, end = i == 0, i == n - 2  # no interval before, none after
    step_before = h if start else nodes[i] - nodes[i - 1]
    step_after = h if end else nodes[i + 2] - nodes[i + 1]
    bend_before = 0.0 if start else 1.0 / (step_before * (step_before + h))
    bend_after = 0.0 if end else 1.0 / (step_after * (step_after + h))
    scales = bend_before, step_before, bend_after, step_after
    t = (x - nodes[i]) / h
    left, right, rise = h * t * (1.0 - t) ** 2, h * t * t * (t - 1.0), t * t * (3.0 - 2.0 * t)
    values = _weights(left, right, rise, h, start, end, scales)
    left, right, rise = (1.0 - t) * (1.0 - 3.0 * t), t * (3.0 * t - 2.0), 6.0 * t * (1.0 - t) / h
    slopes = _weights(left, right, rise, h, start, end, scales)
    a, b, c, d = values
    values = a, 1.0 + b, c, d
    count = min(n, 4)
    first = min(max(i - 1, 0), n - count)
    if first == i:
        return first, count, (values[1], values[2], values[3], 0.0), (slopes[1], slopes[2], slopes[3], 0.0)
    if first == i - 2:
        return first, count, (0.0, values[0], values[1], values[2]), (0.0, slopes[0], slopes[1], slopes[2])
    return first, count, values, slopes


@fast
def _weights(left: float, right: float, rise: float, h: float, start: bool, end: bool, scales: Four) -> Four:
    """Weights of the four values around an interval, less 1 at its beginning.

    Parameters:
        left, right, rise: Hermite polynomials of the slopes at both ends and of the step between them.
        h: length of the interval.
        start, end: whether it is the first, the last one.
        scales: h (quotient here - quotient beside) / (h + step beside) is how far a parabola bends, before and after:
            its divisor, step * (step + h), inverted, and step.
    """
    bend_before, step_before, bend_after, step_after = scales
    before = h * bend_before * ((right if end else 0.0) - left)
    after = h * bend_after * ((left if start else 0.0) - right)
    here = rise + (left + right + before * step_before + after * step_after) / h
    return before, -here - before, here + after, -after


@fast
def nodes_of(grid: Grid, axis: int) -> Array:
    """Nodes of an axis."""
    start = 0
    for k in range(axis):
        start += grid.counts[k]
    return grid.nodes[start : start + grid.counts[axis]]


@fast
def inner_terms(grid: Grid, at: Coordinates, slopes: bool) -> tuple[NDArray[np.int64], Array]:
    """Numbers (n,), from that of the first, of the nodes around a point on all axes between the first and the last of a
    grid, and their weights (1, n); with slopes (len(at), n), then their derivatives.

    Parameters:
        grid: of nodes.
        at: coordinates of all axes but the last; the first is not read.
        slopes: whether derivatives are computed.
    """
    axes, size = len(at), 1
    for axis in range(1, axes):
        size *= min(grid.counts[axis], 4)
    numbers, weights = np.empty(size, np.int64), np.empty((axes if slopes else 1, size))
    numbers[0], weights[0, 0], done = 0, 1.0, 1
    for axis in range(1, axes):
        nodes = nodes_of(grid, axis)
        first, count, values, changes = stencil(nodes, at[axis])
        for n in range(done - 1, -1, -1):
            number, weight = numbers[n] * len(nodes) + first, weights[0, n]
            for k in range(count - 1, -1, -1):
                term = n * count + k
                numbers[term] = number + k
                if slopes:
                    for row in range(1, axis):
                        weights[row, term] = weights[row, n] * values[k]
                    weights[axis, term] = weight * changes[k]
                weights[0, term] = weight * values[k]
        done *= count
    return numbers, weights


@fast
def add(total: Array, values: Array, starts: NDArray[np.int64], factors: Array, step: int, count: int, w: Four) -> None:
    """Add up to four parts of values from every start, times weights.

    Parameters:
        total: (width,).
        values: (size,).
        starts, factors: (n,) of the first part, and of its weights.
        step: from one part to the next.
        count: of parts; further weights are zero.
        w: weights of the parts.

    The loop over the width, without arithmetic in its indices, becomes SIMD instructions.
    """
    last = (count - 1) * step
    second, third = min(step, last), min(2 * step, last)
    for n in range(len(starts)):
        start, factor = starts[n], factors[n]
        a, b, c, d = values[start:], values[start + second :], values[start + third :], values[start + last :]
        p, q, r, s = factor * w[0], factor * w[1], factor * w[2], factor * w[3]
        for k in range(len(total)):
            total[k] = fma(p, a[k], fma(q, b[k], fma(r, c[k], fma(s, d[k], total[k]))))


@fast
def between(grid: Grid, at: Coordinates, first: int, count: int, slopes: bool) -> Array:
    """Values (1, count * columns) at nodes of the last axis, between nodes of all others; with slopes
    (1 + len(at), count * columns), then their derivatives by the coordinates.

    Parameters:
        grid: of values.
        at: coordinates of all axes but the last.
        first, count: nodes of the last axis.
        slopes: whether derivatives are computed.
    """
    numbers, weights = inner_terms(grid, at, slopes)
    own, parts, values, changes = stencil(nodes_of(grid, 0), at[0])
    size = grid.counts[len(at)] * grid.columns
    step = len(grid.values) // grid.counts[0]
    for n in range(len(numbers)):
        numbers[n] = own * step + numbers[n] * size + first * grid.columns
    out = np.zeros((1 + len(at) if slopes else 1, count * grid.columns))
    add(out[0], grid.values, numbers, weights[0], step, parts, values)
    if slopes:
        add(out[1], grid.values, numbers, weights[0], step, parts, changes)
        for row in range(1, len(at)):
            add(out[row + 1], grid.values, numbers, weights[row], step, parts, values)
    return out


@fast
def along(blocks: Array, first: int, count: int, weights: Four, slopes: Four, columns: int) -> Array:
    """Values (1, columns) between nodes in blocks (1, size); from m > 1 rows (m + 1, columns), the last their slope.

    Parameters:
        blocks: of `between`.
        first, count, weights, slopes: of `stencil`.
        columns: numbers at a node.
    """
    rows = len(blocks)
    out = np.zeros((rows if rows == 1 else rows + 1, columns))
    for k in range(count):
        start = (first + k) * columns
        for row in range(rows):
            for column in range(columns):
                out[row, column] += weights[k] * blocks[row, start + column]
        if rows > 1:
            for column in range(columns):
                out[rows, column] += slopes[k] * blocks[0, start + column]
    return out
