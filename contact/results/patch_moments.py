"""Semi-axes, area and stick area of a patch from the means of its cells, to second order."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.results.patch_area import LEAST_STRIPS, lateral_ends, patch_area
from wheelrail.contact.results.patch_sums import PatchSums
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

HALF_ELLIPSE = 32 / (3 * np.pi**2)  # length times integral of the square over square of the integral


class StripMeans(NamedTuple):
    """S adjacent strips of M cells.

    Parameters:
        middle, width: (S,) m, across.
        edges: (S, M + 1) m, cell boundaries along the rolling circle.
        length: (S,) m, on the surface.
        touching: (S,) squared length, continued beyond the end of the contact, over that of the strip.
        pressure: (S, M) Pa, means over the cells.
        margin: (S, M) Pa, from the traction to the largest possible one, zero under slip.
    """

    middle: Array
    width: Array
    edges: Array
    length: Array
    touching: Array
    pressure: Array
    margin: Array


@compiled
def sharpened(sums: PatchSums, strips: StripMeans, marks: Array) -> PatchSums:
    """Sums of a patch with lateral ends, semi-axes, area and stick area interpolated within cells.

    Parameters:
        sums: over the cells.
        strips: of the patch.
        marks: (M + 1,) cell boundaries from 0 to 1.
    """
    S, M = strips.pressure.shape
    lengths = strips.edges[:, 1:] - strips.edges[:, :-1]
    load, square, bounds, sticks = np.zeros(S), np.empty(S), np.empty(S + 1), stick_lengths(strips.margin, lengths)
    for i in range(S):
        for r in range(M):
            load[i] += strips.pressure[i, r] * lengths[i, r] * strips.width[i]
        square[i] = strips.length[i] * strips.length[i] * (strips.touching[i] if S >= LEAST_STRIPS else 1.0)
        sticks[i] = square[i] * (sticks[i] / (strips.edges[i, M] - strips.edges[i, 0])) ** 2
        bounds[i] = strips.middle[i] - 0.5 * strips.width[i]
        bounds[i + 1] = strips.middle[i] + 0.5 * strips.width[i]
    across = lateral_spread(load, strips.middle, strips.width)
    area, (low, high) = patch_area(square, bounds), lateral_ends(square, bounds)
    bands, level = sums.bands.copy(), abs(sums.axes[2, 2])
    for c in range(0, 4, 2):  # from the sides of the outer strips, on the wheel and on the rail
        bands[c] += (low - bounds[0]) * level
        bands[c + 1] += (high - bounds[S]) * level
    return PatchSums(
        area,
        min(stick_area(sticks, bounds), area),
        sums.peak,
        sums.force,
        sums.axes,
        sums.slope,
        sums.point,
        sums.wheel,
        sums.rail,
        bands,
        np.array([spread(strips.pressure, strips.edges, marks), across]),
        sums.creepage,
        sums.power,
        S,
    )


@compiled
def stick_lengths(margin: Array, length: Array) -> Array:
    """Lengths (S,) m of the stick zones of strips, from the margins (S, M) Pa of the tractions to their bounds, zero
    under slip, and the lengths (S, M) m of the cells.

    Over the stick zone the margin is half an ellipse (Carter, Cattaneo), whose length follows from the integrals of the
    margin and of its square: cells that barely stick count little, so that the length does not jump with their number.
    """
    S, M = margin.shape
    lengths = np.zeros(S)
    for i in range(S):
        first, second, whole = 0.0, 0.0, 0.0
        for r in range(M):
            first += margin[i, r] * length[i, r]
            second += margin[i, r] * margin[i, r] * length[i, r]
            whole += length[i, r]
        if second > 0.0:
            lengths[i] = min(HALF_ELLIPSE * first * first / second, whole)
    return lengths


@compiled
def stick_area(square: Array, bounds: Array) -> float:
    """Area m2 of stick zones from the squares (S,) m2 of their lengths in adjacent strips, zero where they slip, with
    lateral bounds (S + 1,) m.
    """
    total, first = 0.0, 0
    for i in range(len(square) + 1):
        if i == len(square) or square[i] == 0.0:
            total += patch_area(square[first:i], bounds[first : i + 1])
            first = i + 1
    return total


@borrowing
def spread(p: Array, edges: Array, marks: Array) -> float:
    """Semi-axis m of the ellipse whose Hertz pressure has the same second moment along x.

    Parameters:
        p: (S, M) Pa, means over the cells.
        edges: (S, M + 1) m, their boundaries.
        marks: (M + 1,) the same from 0 to 1.

    With a pressure gradient p' the second moment of a cell is p (x^2 + l^2/12) + 2 x p' l^2/12.
    """
    S, M = p.shape
    total, centre, moment = 0.0, 0.0, 0.0
    for i in range(S):
        for r in range(M):
            load = p[i, r] * (edges[i, r + 1] - edges[i, r])
            total += load
            centre += 0.5 * load * (edges[i, r] + edges[i, r + 1])
    centre /= total
    for i in range(S):
        per_mark = (marks[1] - marks[0]) / (edges[i, 1] - edges[i, 0])
        for r in range(M):
            length, x = edges[i, r + 1] - edges[i, r], 0.5 * (edges[i, r] + edges[i, r + 1]) - centre
            part = length * length / 12.0
            moment += p[i, r] * length * (x * x + part)
            if p[i, r] > 0.0:
                moment += length * 2.0 * x * part * per_mark * _slope(p[i], marks, r)
    return float(np.sqrt(5.0 * max(moment / total, 0.0)))


@borrowing
def _slope(values: Array, marks: Array, r: int) -> float:
    """Derivative at the middle of a cell of means (M,) between marks (M + 1,), of second order within the strip."""
    last = len(values) - 1
    before = (values[r] - values[r - 1]) / (0.5 * (marks[r + 1] - marks[r - 1])) if r > 0 else 0.0
    after = (values[r + 1] - values[r]) / (0.5 * (marks[r + 2] - marks[r])) if r < last else before
    if r == 0:
        return float(after)
    if r == last:
        return float(before)
    low, high = marks[r + 1] - marks[r - 1], marks[r + 2] - marks[r]
    return float((low * after + high * before) / (low + high))


@borrowing
def lateral_spread(load: Array, middle: Array, width: Array) -> float:
    """The same across, of strips with loads (S,) N, middles and widths (S,) m: the load of outer strips, reduced where
    they are wider than the contact, makes up for their variation across.
    """
    total, centre, moment = 0.0, 0.0, 0.0
    for i in range(len(load)):
        total += load[i]
        centre += load[i] * middle[i]
    centre /= total
    for i in range(len(load)):
        moment += load[i] * ((middle[i] - centre) ** 2 + width[i] ** 2 / 12.0)
    return float(np.sqrt(5.0 * moment / total))
