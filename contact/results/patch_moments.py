"""Semi-axes, area and stick area of a patch from the means of its cells, to second order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.results.patch_area import patch_area
from wheelrail.contact.results.result import ContactResult, Fields, LazyPatches, Patch
from wheelrail.support.arrays import Array

HALF_ELLIPSE = 32 / (3 * np.pi**2)  # length times integral of the square over square of the integral


def sharpened(result: ContactResult, layout: StripLayout, margin: Array) -> ContactResult:
    """The result with semi-axes, area and stick area interpolated within cells.

    margin (n,) Pa: from the traction to the largest possible one, zero under slip.
    """
    assert result.fields is not None
    return replace(result, patches=LazyPatches(partial(_sharpened, result.patches, result.fields, layout, margin)))


def _sharpened(patches: Sequence[Patch], fields: Fields, layout: StripLayout, margin: Array) -> tuple[Patch, ...]:
    p, area, left = (values.reshape(len(layout.sides), -1) for values in (fields.pressure, fields.area, margin))
    labels = fields.patch.reshape(p.shape).max(axis=1)
    corrected = []
    for k, patch in enumerate(patches):
        own = labels == k
        edges, s, width = layout.edges[own], layout.middle[own], layout.width[own]
        x, length = 0.5 * (edges[:, 1:] + edges[:, :-1]), np.diff(edges)
        load = p[own] * length
        bounds = np.append(layout.sides[own, 0], layout.sides[own, 1][-1])
        axes = (spread(p[own], x, length, load, layout.marks), lateral_spread(load.sum(axis=1) * width, s, width))
        lengths = area[own].sum(axis=1) / width
        smooth = patch_area(lengths, bounds)
        sticks = stick_area(lengths * stick_lengths(left[own], length) / length.sum(axis=1), bounds)
        corrected.append(replace(patch, semi_axes=axes, area=smooth, stick_area=min(sticks, smooth), strips=len(width)))
    return tuple(corrected)


def stick_lengths(margin: Array, length: Array) -> Array:
    """Lengths (S,) m of the stick zones of strips, from the margins (S, M) Pa of the tractions to their bounds, zero
    under slip, and the lengths (S, M) m of the cells.

    Over the stick zone the margin is half an ellipse (Carter, Cattaneo), whose length follows from the integrals of the
    margin and of its square: cells that barely stick count little, so that the length does not jump with their number.
    """
    first, second = ((margin**k * length).sum(axis=1) for k in (1, 2))
    lengths = HALF_ELLIPSE * np.divide(first**2, second, out=np.zeros_like(first), where=second > 0)
    return np.asarray(np.minimum(lengths, length.sum(axis=1)))


def stick_area(lengths: Array, bounds: Array) -> float:
    """Area m2 of stick zones from their lengths (S,) m in adjacent strips with lateral bounds (S + 1,) m."""
    sides = np.flatnonzero(np.diff(lengths > 0, prepend=False, append=False))
    return sum(patch_area(lengths[i:j], bounds[i : j + 1]) for i, j in sides.reshape(-1, 2).tolist())


def spread(p: Array, x: Array, length: Array, weight: Array, marks: Array) -> float:
    """Semi-axis m of the ellipse whose Hertz pressure has the same second moment along x.

    Parameters:
        p: (S, M) Pa, means over the cells.
        x, length: (S, M) m, their middles and lengths.
        weight: (S, M), loads.
        marks: (M + 1,) their boundaries from 0 to 1.

    With a pressure gradient p' the second moment of a cell is p (x^2 + l^2/12) + 2 x p' l^2/12.
    """
    total = weight.sum()
    centre = (weight * x).sum() / total
    slope = np.gradient(p, 0.5 * (marks[1:] + marks[:-1]), axis=1) * (marks[1] - marks[0]) / length[:, :1]
    part = length**2 / 12
    share = np.divide(weight, p, out=np.zeros_like(weight), where=p > 0)
    moment = (weight * ((x - centre) ** 2 + part) + share * 2 * (x - centre) * slope * part).sum() / total
    return float(np.sqrt(5 * max(moment, 0.0)))


def lateral_spread(load: Array, middle: Array, width: Array) -> float:
    """The same across, of strips with loads (S,) N, middles and widths (S,) m: the load of outer strips, reduced where
    they are wider than the contact, makes up for their variation across.
    """
    total = load.sum()
    centre = load @ middle / total
    return float(np.sqrt(5 * (load @ ((middle - centre) ** 2 + width**2 / 12)) / total))
