"""Cells that end where the contact ends: found from the undeformed overlap by a coarse solve, then by Newton-like steps
on the ends of the strips and the tips of the patches, all from the pressures of the frictionless contact.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import scipy.linalg as la

from contact.pose import Array, Mask, Nodes, Pose
from contact.pressure import normal_contact
from contact.strip_surfaces import Ridge, StripSurfaces
from contact.strips import Layout, edge_rules, marks, tip
from contact.tractions import Count, NotConverged

log = logging.getLogger(__name__)

COARSE_STRIPS, COARSE_CELLS = 24, 8
NECK = 0.9  # of the smaller hump beside it: a load lower than that divides a patch into parts with strips of their own
GAUSS = 0.5 / np.sqrt(3.0)  # of a cell's length, from its middle
STEPS = 40
MOST = 4  # times as many strips as a round patch has
FARTHEST = 0.12  # that an end moves in a step, of the strip's length, before it is stretched
STRETCH = 1.6  # of the first step: between 1, of a line contact, and 2, of a point contact


@dataclass(frozen=True)
class Fineness:
    """Strips over a patch's width, and cells along a strip. Raises ValueError for fewer than 4 of either."""

    strips: int = 12
    cells: int = 16

    def __post_init__(self) -> None:
        if min(self.strips, self.cells) < 4:
            raise ValueError(f"a patch needs at least 4 strips of 4 cells, got {self.strips} of {self.cells}")

    def strips_over(self, width: float, length: float) -> int:
        """Strips of a patch: more when it is wider than long, so that humps side by side are seen, up to a limit."""
        wanted = 0.75 * self.strips * width / max(length, 1e-12)
        return int(np.ceil(min(max(self.strips, wanted), MOST * self.strips)))

    def halved(self) -> Fineness:
        """Half as fine."""
        return Fineness(max(self.strips // 2, 4), max(self.cells // 2, 4))


@dataclass(frozen=True)
class Fitted:
    """Cells, the frictionless pressures (S, M) Pa on them, and whether their ends have settled."""

    layout: Layout
    pressure: Array
    settled: bool
    steps: int


NormalOperator = Callable[[Layout], Array]  # relative normal compliance (n, n) m/Pa between cells


def mean_overlap(surfaces: StripSurfaces, pose: Pose, layout: Layout) -> Array:
    """Undeformed overlap (S, M) m, the mean over every cell, by Gauss's rule of two points each way."""
    edges = layout.edges
    x, length = 0.5 * (edges[:, 1:] + edges[:, :-1]), np.diff(edges)
    s, width = layout.middle[:, None], layout.width[:, None]
    at = [(s + i * GAUSS * width, x + j * GAUSS * length) for i in (-1, 1) for j in (-1, 1)]
    across, along = (np.stack([np.broadcast_to(p[k], x.shape) for p in at]) for k in (0, 1))
    return np.asarray(surfaces.overlap(pose, across, along).mean(axis=0))


def coarse(
    surfaces: StripSurfaces, pose: Pose, ridge: Ridge, operator: NormalOperator, count: Count
) -> tuple[Layout, Array]:
    """Strips over every run of lines that overlap, equal cells over their overlap, and pressures (S, M) Pa there."""
    inside = ridge.overlap > 0
    starts = np.flatnonzero(inside & ~np.concatenate([[False], inside[:-1]]))
    stops = np.flatnonzero(inside & ~np.concatenate([inside[1:], [False]]))
    sides, patch = [], []
    for number, (i, j) in enumerate(zip(starts, stops, strict=True)):
        low = _crossing(ridge, i, i - 1) if i > 0 else ridge.s[i]
        high = _crossing(ridge, j, j + 1) if j + 1 < len(ridge.s) else ridge.s[j]
        edge = np.linspace(low, high, COARSE_STRIPS + 1)
        sides.append(np.column_stack([edge[:-1], edge[1:]]))
        patch += [number] * COARSE_STRIPS
    both = np.concatenate(sides)
    middle = both.mean(axis=1)
    depth = np.maximum(np.interp(middle, ridge.s, ridge.overlap), 0.02 * ridge.overlap.max())
    x, half = np.interp(middle, ridge.s, ridge.x), np.sqrt(2 * depth / np.interp(middle, ridge.s, ridge.bend))
    # on a steep flange strips beside the deepest one overlap over far more than the contact's length
    longest, centre = half[np.argmax(depth)], x[np.argmax(depth)]
    half, x = np.minimum(half, longest), np.clip(x, centre - longest, centre + longest)
    layout = Layout(both, np.column_stack([x - half, x + half]), np.array(patch), marks(COARSE_CELLS, rolling=False))
    overlap = mean_overlap(surfaces, pose, layout).ravel()
    pressure, _ = normal_contact(operator(layout), overlap, overlap > 0.4 * overlap.max(), count)
    return layout, pressure.reshape(len(both), -1)


def _crossing(ridge: Ridge, inner: int, outer: int) -> float:
    """Arc length between two lines where the overlap vanishes."""
    a, b = ridge.overlap[inner], ridge.overlap[outer]
    share = a / (a - b) if np.isfinite(b) else 0.0
    return float(ridge.s[inner] + share * (ridge.s[outer] - ridge.s[inner]))


def patches(layout: Layout, pressure: Array, fineness: Fineness, cell_marks: Array) -> Layout | None:
    """Parts for every run of strips that carry pressure, fitted to it roughly; None without any.

    A run with several humps is divided at the necks between them, so that a patch about to part has the same strips as
    the two that it becomes.
    """
    carries = (pressure > 0).any(axis=1)
    joined = np.concatenate([[False], carries[1:] & carries[:-1] & (layout.patch[1:] == layout.patch[:-1])])
    run = np.cumsum(carries & ~joined) - 1
    found: list[Part] = []
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
            found.append(Part(float(start), float(stop), middle[inside], ends[inside]))
    return _assembled(found, fineness, cell_marks)


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


@dataclass(frozen=True)
class Part:
    """A patch, or a part of one, to be: its tips low and high m, middles (n,) and ends (n, 2) m of strips known; how
    many it shall have (None: as suits it).
    """

    low: float
    high: float
    middle: Array
    ends: Array
    count: int | None = None


def _assembled(found: list[Part], fineness: Fineness, cell_marks: Array) -> Layout | None:
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
    return Layout(np.concatenate(sides), np.concatenate(all_ends), np.array(patch), cell_marks)


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


def fit(
    surfaces: StripSurfaces,
    pose: Pose,
    operator: NormalOperator,
    start: Layout,
    fineness: Fineness,
    *,
    tolerance: float,
    count: Count,
) -> Fitted | None:
    """Move ends and tips until their steps, as parts of the strips' length and width, are below the tolerance (RMS).

    Strips inside a patch that would pull are left out until they touch again. None when no pressure is left.
    """
    layout, stretch = start, STRETCH
    previous: Array | None = None
    held = np.ones(len(start.sides), dtype=bool)
    last, damping = np.zeros((0, 2)), np.ones((0, 2))
    for step in range(1, STEPS + 1):
        overlap, matrix = mean_overlap(surfaces, pose, layout), operator(layout)
        count.newton += 1
        pressure, touches = _pressed(matrix, overlap, held)
        load = (pressure * np.diff(layout.edges)).sum(axis=1)
        moves = np.clip(np.nan_to_num(_beyond(layout, pressure)), -FARTHEST, FARTHEST) * held[:, None]
        tips = _tips(layout, load)
        if tips.shape != last.shape:
            last, damping = np.zeros(tips.shape), np.ones(tips.shape)
        # a tip that swings is moved less and less, one that creeps gets its full step back
        damping = np.where(tips * last < 0, 0.5 * damping, np.minimum(1.0, 1.5 * damping))
        last = tips
        error = float(np.sqrt((moves[held] ** 2).mean()))
        log.debug(
            "step %d: ends move by %.1e, tips by %s widths, %d of %d strips",
            step,
            error,
            tips.round(4).tolist(),
            held.sum(),
            len(load),
        )
        slip = float(np.abs(damping * tips).max())
        holds = touches & ((load > 0) | _outermost(layout) | ~held)
        if error <= tolerance and slip <= 10 * tolerance and (holds == held).all():
            return Fitted(layout, pressure, True, step)
        if previous is not None and previous.shape == moves.shape:
            change = moves - previous
            bottom = float((change**2).sum())
            if bottom > 0:
                stretch = float(np.clip(-stretch * (previous * change).sum() / bottom, 0.7, 2.2))
        previous = moves
        ends = layout.ends + stretch * moves * np.diff(layout.ends) * [-1.0, 1.0]
        moved = _retipped(replace(layout, ends=ends), load, damping * tips, fineness)
        if moved is None:
            return None
        held = holds if len(moved.sides) == len(held) else np.ones(len(moved.sides), dtype=bool)
        layout = moved
    return Fitted(layout, np.ones((len(layout.sides), len(layout.marks) - 1)), False, STEPS)


def _pressed(matrix: Array, overlap: Array, held: Mask) -> tuple[Array, Mask]:
    """Pressures (S, M) Pa of the strips that are held, signed; and which strips (S,) touch, as all of these do.

    Raises NotConverged when the cells cannot be told apart.
    """
    own = np.repeat(held, overlap.shape[1])
    found = np.zeros(own.size)
    found[own] = la.solve(matrix[np.ix_(own, own)], overlap.ravel()[own], check_finite=False)
    if not np.isfinite(found).all():
        raise NotConverged("the cells of the contact cannot be told apart")
    left = (overlap.ravel() - matrix @ found).reshape(overlap.shape)
    return found.reshape(overlap.shape), held | (left.max(axis=1) > 0)


def _beyond(layout: Layout, pressure: Array) -> Array:
    """How far every strip reaches beyond its trailing and its leading end (S, 2), as part of its length."""
    trailing, leading = edge_rules(tuple(layout.marks.tolist()))
    return np.column_stack(
        [trailing.beyond(pressure[:, 0], pressure[:, 1]), leading.beyond(pressure[:, -1], pressure[:, -2])]
    )


def _outermost(layout: Layout) -> Mask:
    """First and last strips of the patches, which the tips' steps move."""
    found = np.zeros(len(layout.patch), dtype=bool)
    found[np.concatenate(_bounds(layout))] = True
    return found


def _tips(layout: Layout, load: Array) -> Array:
    """How far each part reaches beyond its first and its last strip (parts, 2), in widths; nothing where it meets the
    next one as long as both press there.
    """
    first, last = _bounds(layout)
    found = np.array([(tip(load[i : j + 1]), tip(load[i : j + 1][::-1])) for i, j in zip(first, last, strict=True)])
    for k in range(len(first) - 1):
        i, j = last[k], first[k + 1]
        if layout.sides[i, 1] == layout.sides[j, 0] and load[i] > 0 and load[j] > 0:
            found[k, 1] = found[k + 1, 0] = 0.0
    return found


def _bounds(layout: Layout) -> tuple[Nodes, Nodes]:
    """First and last strip of every part."""
    new = np.flatnonzero(np.diff(layout.patch)) + 1
    return np.concatenate([[0], new]), np.concatenate([new - 1, [len(layout.patch) - 1]])


def _retipped(layout: Layout, load: Array, tips: Array, fineness: Fineness) -> Layout | None:
    """Strips between the moved tips; parts that lost their load vanish, those that meet share a side."""
    found = []
    for i, j, (before, after) in zip(*_bounds(layout), tips, strict=True):
        own = slice(i, j + 1)
        width = layout.width[i]
        low, high = layout.sides[i, 0] - before * width, layout.sides[j, 1] + after * width
        middle = layout.middle[own]
        if (load[own] > 0).any() and ((middle > low) & (middle < high)).any():
            found.append(Part(float(low), float(high), middle, layout.ends[own], j + 1 - i))
    return _assembled(found, fineness, layout.marks)
