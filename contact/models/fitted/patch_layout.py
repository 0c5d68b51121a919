"""Patches, and parts of patches with strips of one width: from where strips press to a layout of strips and cells."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from wheelrail.contact.models.fitted.edge_rules import tip
from wheelrail.contact.models.fitted.layout import StripLayout
from wheelrail.contact.models.fitted.resolution import Resolution
from wheelrail.contact.models.fitted.surfaces import PenetrationProfile
from wheelrail.support.arrays import Array

VIRTUAL = 0.55  # of the approach
WIDE = 1.8  # times as wide as the guess: an overlap wider than that, 1.35 times for one hump, may touch elsewhere, too
NECK = 0.9  # of the smaller hump beside it: a load lower than that divides a patch into parts with strips of their own


@dataclass(frozen=True)
class PatchSpan:
    """A patch, or a part of one, to be: its tips low and high m, middles (n,) and ends (n, 2) m of strips known; how
    many it shall have (None: as suits it).
    """

    low: float
    high: float
    middle: Array
    ends: Array
    count: int | None = None


def patches(layout: StripLayout, pressure: Array, fineness: Resolution, cell_marks: Array) -> StripLayout | None:
    """Parts for every run of strips that carry pressure, fitted to it roughly; None without any.

    A run with several humps is divided at the necks between them, so that a patch about to part has the same strips as
    the two that it becomes.
    """
    carries = np.any(pressure > 0, axis=1)
    joined = np.concatenate([[False], carries[1:] & carries[:-1] & (layout.patch[1:] == layout.patch[:-1])])
    run = np.cumsum(carries & ~joined) - 1
    found: list[PatchSpan] = []
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
            found.append(PatchSpan(float(start), float(stop), middle[inside], ends[inside]))
    return assembled(found, fineness, cell_marks)


def single(ridge: PenetrationProfile, fineness: Resolution, cell_marks: Array) -> StripLayout | None:
    """One part where the overlap has one hump, guessed from the rigid surfaces; None where it has not.

    Bodies touch about where they would overlap after half of the approach, VIRTUAL: Kik and Piotrowski 1996.
    """
    o, top = ridge.overlap, int(ridge.overlap.argmax())
    depth = o - (1 - VIRTUAL) * o[top]
    inside, over = np.flatnonzero(depth > 0), np.flatnonzero(o > 0)
    if over[-1] - over[0] > WIDE * (inside[-1] - inside[0] + 1):
        return None
    if len(ridge.humps) > 1 or inside[-1] - inside[0] != len(inside) - 1 or inside[0] == 0 or inside[-1] == len(o) - 1:
        return None
    low, high = (
        float(np.interp(0.0, depth[[out, at]], ridge.s[[out, at]]))
        for at, out in ((inside[0], inside[0] - 1), (inside[-1], inside[-1] + 1))
    )
    half = np.sqrt(2 * depth[inside] / ridge.bend[inside])
    ends = ridge.x[inside, None] + half[:, None] * [-1.0, 1.0]
    return assembled([PatchSpan(low, high, ridge.s[inside], ends)], fineness, cell_marks)


def recounted(layout: StripLayout, fineness: Resolution) -> StripLayout:
    """The layout of one part with as many strips as suit the shape that it was fitted to."""
    low, high = float(layout.sides[0, 0]), float(layout.sides[-1, 1])
    if fineness.strips_over(high - low, float(np.diff(layout.ends).max())) == len(layout.sides):
        return layout
    return assembled([PatchSpan(low, high, layout.middle, layout.ends)], fineness, layout.marks) or layout


def _necks(load: Array) -> list[int]:
    """Strips between humps of the load (n,), lowest between them."""
    found: list[int] = []
    start = 0
    for j in range(1, len(load) - 1):
        if load[j] > min(load[j - 1], load[j + 1]) or j <= start:
            continue
        before, after = load[start:j].max(), load[j + 1 :].max()
        if load[j] < NECK * min(before, after) and load[j] <= load[start : j + 1].min():
            beyond = load[j + 1 :]
            rise = int(np.argmax(beyond > load[j] / NECK)) if (beyond > load[j] / NECK).any() else len(beyond)
            if load[j] <= beyond[:rise].min(initial=np.inf):
                found.append(j)
                start = j
    return found


def assembled(found: list[PatchSpan], fineness: Resolution, cell_marks: Array) -> StripLayout | None:
    """Layout of parts; those that meet share a side, halfway between their tips. None without any."""
    parts = sorted(found, key=lambda part: part.low)
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
        count = part.count or fineness.strips_over(float(high[number] - low[number]), length)
        edge = np.linspace(low[number], high[number], count + 1)
        sides.append(np.column_stack([edge[:-1], edge[1:]]))
        all_ends.append(_ends_at(0.5 * (edge[1:] + edge[:-1]), edge[[0, -1]], meets, part.middle, part.ends))
        patch += [number] * count
    if not sides:
        return None
    return StripLayout(np.concatenate(sides), np.concatenate(all_ends), np.array(patch), cell_marks)


def _ends_at(at: Array, tips: Array, meets: tuple[bool, bool], middle: Array, ends: Array) -> Array:
    """Ends of strips at other places: the squared half lengths of an ellipse are a parabola, zero at its tips, but not
    where it meets another part.
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
