"""Semi-axes, area and stick area of a patch from the means of its cells, to second order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.results.patch_area import LEAST_STRIPS, patch_area
from wheelrail.contact.results.result import ContactResult, Fields, LazyPatches, Patch
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

HALF_ELLIPSE = 32 / (3 * np.pi**2)  # length times integral of the square over square of the integral


def sharpened(result: ContactResult, layout: StripLayout, margin: Array, touching: Array) -> ContactResult:
    """The result with semi-axes, area and stick area interpolated within cells.

    Parameters:
        result: on strips.
        layout: of the strips.
        margin: (n,) Pa, from the traction to the largest possible one, zero under slip.
        touching: (S,) squared length, continued beyond the end of the contact, over that of the strip.
    """
    assert result.fields is not None
    return replace(
        result, patches=LazyPatches(partial(_sharpened, result.patches, result.fields, layout, margin, touching))
    )


def _sharpened(
    patches: Sequence[Patch], fields: Fields, layout: StripLayout, margin: Array, touching: Array
) -> tuple[Patch, ...]:
    p, area, left = (values.reshape(len(layout.sides), -1) for values in (fields.pressure, fields.area, margin))
    labels, edges, width = fields.patch.reshape(p.shape).max(axis=1), layout.edges, layout.width
    corrected = []
    for k, patch in enumerate(patches):
        own = np.flatnonzero(labels == k)
        sides = np.append(layout.sides[own, 0], layout.sides[own[-1], 1])
        x, lengths = edges[own], np.diff(edges[own])
        load = p[own] * lengths
        axes = (
            spread(p[own], x, layout.marks),
            lateral_spread(load.sum(axis=1) * width[own], layout.middle[own], width[own]),
        )
        square = (area[own].sum(axis=1) / width[own]) ** 2
        if len(own) >= LEAST_STRIPS:
            square *= touching[own]
        smooth = patch_area(square, sides)
        sticks = stick_area(square * (stick_lengths(left[own], lengths) / lengths.sum(axis=1)) ** 2, sides)
        corrected.append(replace(patch, semi_axes=axes, area=smooth, stick_area=min(sticks, smooth), strips=len(own)))
    return tuple(corrected)


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
