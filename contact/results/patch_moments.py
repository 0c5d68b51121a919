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

RESIDUAL = 1e-6  # of the largest traction: by as much the solver may miss it where points slip


def sharpened(result: ContactResult, layout: StripLayout, bound: Array) -> ContactResult:
    """The result with semi-axes, area and stick area interpolated within cells.

    bound (n,) Pa: the largest possible traction.
    """
    assert result.fields is not None
    return replace(result, patches=LazyPatches(partial(_sharpened, result.patches, result.fields, layout, bound)))


def _sharpened(patches: Sequence[Patch], fields: Fields, layout: StripLayout, bound: Array) -> tuple[Patch, ...]:
    p, area = (values.reshape(len(layout.sides), -1) for values in (fields.pressure, fields.area))
    left = (bound - np.hypot(*fields.traction.T)).reshape(p.shape)
    left[left < RESIDUAL * bound.reshape(p.shape)] = 0.0
    labels = fields.patch.reshape(p.shape).max(axis=1)
    corrected = []
    for k, patch in enumerate(patches):
        own = labels == k
        edges, s, width = layout.edges[own], layout.middle[own], layout.width[own]
        x, length = 0.5 * (edges[:, 1:] + edges[:, :-1]), np.diff(edges)
        load = p[own] * length
        bounds = np.append(layout.sides[own, 0], layout.sides[own, 1][-1])
        axes = (spread(p[own], x, length, load, layout.marks), lateral_spread(load.sum(axis=1) * width, s, width))
        stick = stick_lengths(left[own], length) @ (area[own, 0] / length[:, 0])
        strips = area[own].sum(axis=1)
        smooth = patch_area(strips / width, bounds)
        sticks = float(stick) * smooth / float(strips.sum())
        corrected.append(replace(patch, semi_axes=axes, area=smooth, stick_area=sticks))
    return tuple(corrected)


def stick_lengths(left: Array, length: Array) -> Array:
    """Lengths (S,) m of the stick zones of strips, from the margins (S, M) Pa of the tractions to their bounds, zero
    under slip, and the lengths (S, M) m of the cells.

    The margin grows as a square root from the slip zone (Cattaneo, Carter), so its square is extrapolated to zero.
    """
    total = (length * (left > 0)).sum(axis=1)
    for values, lengths in ((left, length), (left[:, ::-1], length[:, ::-1])):
        (outer, last, inner), (beyond, own, _) = (
            (part[:, :-2], part[:, 1:-1], part[:, 2:]) for part in (values, lengths)
        )
        first = (outer == 0) & (last > 0) & (inner > last)
        ratio = np.divide(inner, last, out=np.full_like(last, 2.0), where=first)
        apart = 0.5 * (lengths[:, 1:-1] + lengths[:, 2:])
        reach = np.clip(apart / (ratio**2 - 1) - 0.5 * own, -0.5 * own, 0.5 * beyond)
        total += np.where(first, reach, 0.0).sum(axis=1)
    return np.asarray(total)


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
