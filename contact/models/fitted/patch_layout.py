"""Layouts of strips and cells from pressures or from the rigid surfaces: patches, and parts of patches with strips of
one width.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.geometry.strip_surfaces import PenetrationProfile
from wheelrail.contact.models.fitted.edge_rules import tip
from wheelrail.contact.models.fitted.resolution import Resolution
from wheelrail.support.arrays import Array

VIRTUAL = 0.55  # of the approach
WIDE = 1.8  # times the estimated width: a wider penetration (1.35 times for one maximum) may have further contacts
NECK = 0.9  # of the smaller adjacent maximum: a local minimum of the load below that divides a patch into parts


@dataclass(frozen=True)
class PatchSpan:
    """Extent of a patch or a part of one, from which strips are laid out.

    Parameters:
        low, high: lateral ends, m.
        middle: (n,) m, middles of strips with known ends.
        ends: (n, 2) m, their trailing and leading ends.
        count: number of strips; None is that of the resolution.
    """

    low: float
    high: float
    middle: Array
    ends: Array
    count: int | None = None


def patches(layout: StripLayout, pressure: Array, resolution: Resolution, cell_marks: Array) -> StripLayout | None:
    """Parts for every run of strips with positive pressure (S, M) Pa, with estimated ends; None without any.

    A run is divided at local minima of its load, so that a patch about to split has the same strips as the two patches
    after it.
    """
    carries = np.any(pressure > 0, axis=1)
    joined = np.concatenate([[False], carries[1:] & carries[:-1] & (layout.patch[1:] == layout.patch[:-1])])
    run = np.cumsum(carries & ~joined) - 1
    parts: list[PatchSpan] = []
    for k in range(run.max(initial=-1) + 1):
        own = np.flatnonzero(carries & (run == k))
        edges, p, width = layout.edges[own], pressure[own], layout.width[own[0]]
        first = (p > 0).argmax(axis=1)
        last = p.shape[1] - (p[:, ::-1] > 0).argmax(axis=1)
        rows = np.arange(len(own))
        ends = np.column_stack([edges[rows, first], edges[rows, last]])
        load = (p * np.diff(edges)).sum(axis=1)
        low = layout.sides[own[0], 0] - tip(load) * width
        high = layout.sides[own[-1], 1] + tip(load[::-1]) * width
        cuts = [low, *(float(layout.middle[own[j]]) for j in _necks(load)), high]
        middle = layout.middle[own]
        for start, stop in pairwise(cuts):
            inside = (middle >= start - width) & (middle <= stop + width)
            parts.append(PatchSpan(float(start), float(stop), middle[inside], ends[inside]))
    return assembled(parts, resolution, cell_marks)


def single(ridge: PenetrationProfile, resolution: Resolution, cell_marks: Array) -> StripLayout | None:
    """One part, estimated from the rigid surfaces, if the penetration has a single maximum; else None.

    The patch is about the region of penetration at a fraction VIRTUAL of the approach: Kik and Piotrowski 1996.
    """
    o, top = ridge.penetration, int(ridge.penetration.argmax())
    depth = o - (1 - VIRTUAL) * o[top]
    inside, over = np.flatnonzero(depth > 0), np.flatnonzero(o > 0)
    if over[-1] - over[0] > WIDE * (inside[-1] - inside[0] + 1):
        return None
    if len(ridge.maxima) > 1 or inside[-1] - inside[0] != len(inside) - 1 or inside[0] == 0 or inside[-1] == len(o) - 1:
        return None
    low, high = (
        float(np.interp(0.0, depth[[out, at]], ridge.s[[out, at]]))
        for at, out in ((inside[0], inside[0] - 1), (inside[-1], inside[-1] + 1))
    )
    half = np.sqrt(2 * depth[inside] / ridge.curvature[inside])
    ends = ridge.x[inside, None] + half[:, None] * [-1.0, 1.0]
    return assembled([PatchSpan(low, high, ridge.s[inside], ends)], resolution, cell_marks)


def recounted(layout: StripLayout, resolution: Resolution) -> StripLayout:
    """The layout of one part with the number of strips that the resolution gives for its converged shape."""
    low, high = float(layout.sides[0, 0]), float(layout.sides[-1, 1])
    if resolution.strips_over(high - low, float(np.diff(layout.ends).max())) == len(layout.sides):
        return layout
    return assembled([PatchSpan(low, high, layout.middle, layout.ends)], resolution, layout.marks) or layout


def _necks(load: Array) -> list[int]:
    """Strips at local minima of the load (n,)."""
    minima: list[int] = []
    start = 0
    for j in range(1, len(load) - 1):
        if load[j] > min(load[j - 1], load[j + 1]) or j <= start:
            continue
        before, after = load[start:j].max(), load[j + 1 :].max()
        if load[j] < NECK * min(before, after) and load[j] <= load[start : j + 1].min():
            beyond = load[j + 1 :]
            rise = int(np.argmax(beyond > load[j] / NECK)) if (beyond > load[j] / NECK).any() else len(beyond)
            if load[j] <= beyond[:rise].min(initial=np.inf):
                minima.append(j)
                start = j
    return minima


def assembled(spans: list[PatchSpan], resolution: Resolution, cell_marks: Array) -> StripLayout | None:
    """Layout of parts; those that meet share a side, halfway between their tips. None without any."""
    parts = sorted(spans, key=lambda part: part.low)
    low = np.array([part.low for part in parts])
    high = np.array([part.high for part in parts])
    sides, all_ends, patch = [], [], []
    for number in range(len(parts) - 1):
        if low[number + 1] <= high[number]:
            high[number] = low[number + 1] = 0.5 * (high[number] + low[number + 1])
    for number, part in enumerate(parts):
        if not high[number] > low[number]:
            continue
        meets = (
            number > 0 and low[number] == high[number - 1],
            number + 1 < len(parts) and high[number] == low[number + 1],
        )
        length = float(np.diff(part.ends).max())
        count = part.count or resolution.strips_over(float(high[number] - low[number]), length)
        edge = np.linspace(low[number], high[number], count + 1)
        sides.append(np.column_stack([edge[:-1], edge[1:]]))
        all_ends.append(_ends_at(0.5 * (edge[1:] + edge[:-1]), edge[[0, -1]], meets, part.middle, part.ends))
        patch += [number] * count
    if not sides:
        return None
    return StripLayout(np.concatenate(sides), np.concatenate(all_ends), np.array(patch), cell_marks)


def _ends_at(at: Array, tips: Array, meets: tuple[bool, bool], middle: Array, ends: Array) -> Array:
    """Ends (n, 2) m of strips with other middles (n,) m, by interpolation of squared half lengths, which are a parabola
    for an ellipse: zero at the tips, except where a tip is shared with another part.
    """
    inner = (middle > tips[0]) & (middle < tips[1])
    if not inner.any():
        inner = np.abs(middle - tips.mean()) <= np.abs(middle - tips.mean()).min()
    s, known = middle[inner], ends[inner]
    squares = (0.5 * np.diff(known)[:, 0]) ** 2
    place, value = list(s), list(squares)
    for side, where in ((0, tips[0]), (1, tips[1])):
        if not meets[side] and (where < s[0] if side == 0 else where > s[-1]):
            place.insert(0 if side == 0 else len(place), float(where))
            value.insert(0 if side == 0 else len(value), 0.0)
    half = np.sqrt(np.maximum(np.interp(at, place, value), 1e-4 * squares.max()))
    x = np.interp(at, s, known.mean(axis=1))
    return np.column_stack([x - half, x + half])
