"""Cells that end where the contact ends: found from the undeformed overlap by a coarse solve, then by Newton-like steps
on the ends of the strips and the tips of the patches, all from the pressures of the frictionless contact.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg as la

from contact.pose import Array, Pose
from contact.pressure import normal_contact
from contact.strip_surfaces import Ridge, StripSurfaces
from contact.strips import Layout, edge_rules, marks, tip
from contact.tractions import Count, NotConverged

log = logging.getLogger(__name__)

COARSE_STRIPS, COARSE_CELLS = 16, 8
GAUSS = 0.5 / np.sqrt(3.0)  # of a cell's length, from its middle
STEPS = 40
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
        """Strips of a patch: more when it is wider than long, so that humps side by side are seen."""
        return max(self.strips, int(np.ceil(0.75 * self.strips * width / max(length, 1e-12))))

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
    """One patch for every run of strips that carry pressure, fitted to it roughly; None without any."""
    carries = (pressure > 0).any(axis=1)
    joined = np.concatenate([[False], carries[1:] & carries[:-1] & (layout.patch[1:] == layout.patch[:-1])])
    run = np.cumsum(carries & ~joined) - 1
    found: list[Stretch] = []
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
        found.append(Stretch(float(low), float(high), layout.middle[own], ends))
    return _assembled(found, fineness, cell_marks)


@dataclass(frozen=True)
class Stretch:
    """A patch to be: its tips low and high m, middles (n,) and ends (n, 2) m of strips known; how many it shall have
    (None: as suits it).
    """

    low: float
    high: float
    middle: Array
    ends: Array
    count: int | None = None

    def joined(self, other: Stretch) -> Stretch:
        """Both as one, the other one beginning later."""
        return Stretch(
            self.low,
            max(self.high, other.high),
            np.concatenate([self.middle, other.middle]),
            np.concatenate([self.ends, other.ends]),
        )


def _assembled(found: list[Stretch], fineness: Fineness, cell_marks: Array) -> Layout | None:
    """Layout of patches; those that meet join. None without any."""
    joined: list[Stretch] = []
    for stretch in sorted(found, key=lambda item: item.low):
        meets = bool(joined) and stretch.low <= joined[-1].high
        joined.append(joined.pop().joined(stretch) if meets else stretch)
    sides, all_ends, patch = [], [], []
    for number, stretch in enumerate(joined):
        low, high, middle, ends = stretch.low, stretch.high, stretch.middle, stretch.ends
        count = stretch.count or fineness.strips_over(high - low, float(np.diff(ends).max()))
        edge = np.linspace(low, high, count + 1)
        sides.append(np.column_stack([edge[:-1], edge[1:]]))
        all_ends.append(_ends_at(0.5 * (edge[1:] + edge[:-1]), low, high, middle, ends))
        patch += [number] * count
    if not sides:
        return None
    return Layout(np.concatenate(sides), np.concatenate(all_ends), np.array(patch), cell_marks)


def _ends_at(at: Array, low: float, high: float, middle: Array, ends: Array) -> Array:
    """Ends of strips at other places: the squared half lengths of an ellipse are a parabola, zero at its tips."""
    inner = (middle > low) & (middle < high)
    s, known = middle[inner], ends[inner]
    half2 = np.interp(
        at, np.concatenate([[low], s, [high]]), np.concatenate([[0], (0.5 * np.diff(known)[:, 0]) ** 2, [0]])
    )
    x = np.interp(at, s, known.mean(axis=1))
    half = np.sqrt(half2)
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

    None when no pressure is left.
    """
    layout, stretch = start, STRETCH
    previous: Array | None = None
    pressure = np.zeros((len(start.sides), len(start.marks) - 1))
    for step in range(1, STEPS + 1):
        overlap = mean_overlap(surfaces, pose, layout)
        count.newton += 1
        pressure = la.solve(operator(layout), overlap.ravel(), check_finite=False).reshape(overlap.shape)
        if not np.isfinite(pressure).all():
            raise NotConverged("the cells of the contact cannot be told apart")
        trailing, leading = edge_rules(tuple(layout.marks.tolist()))
        beyond = np.column_stack(
            [trailing.beyond(pressure[:, 0], pressure[:, 1]), leading.beyond(pressure[:, -1], pressure[:, -2])]
        )
        load = (pressure * np.diff(layout.edges)).sum(axis=1)
        length = np.diff(layout.ends)
        moves = np.clip(np.nan_to_num(beyond), -0.12, 0.12)
        tips = _tips(layout, load)
        error = float(np.sqrt((moves**2).mean()))
        log.debug("step %d: ends move by %.1e, tips by %s widths, %d strips", step, error, tips, len(load))
        slip = max((abs(move) for pair in tips.values() for move in pair), default=0.0)
        if error <= tolerance and slip <= 10 * tolerance:
            return Fitted(layout, pressure, True, step)
        if previous is not None and previous.shape == moves.shape:
            change = moves - previous
            bottom = float((change**2).sum())
            if bottom > 0:
                stretch = float(np.clip(-stretch * (previous * change).sum() / bottom, 0.7, 2.2))
        previous = moves
        ends = layout.ends + stretch * moves * length * [-1.0, 1.0]
        moved = _retipped(replace(layout, ends=ends), load, tips, fineness)
        if moved is None:
            return None
        layout = moved
    return Fitted(layout, np.ones((len(layout.sides), len(layout.marks) - 1)), False, STEPS)


def _tips(layout: Layout, load: Array) -> dict[int, tuple[float, float]]:
    """How far each patch reaches beyond its first and its last strip, in widths."""
    found = {}
    for k in np.unique(layout.patch):
        own = load[layout.patch == k]
        found[int(k)] = tip(own), tip(own[::-1])
    return found


def _retipped(layout: Layout, load: Array, tips: dict[int, tuple[float, float]], fineness: Fineness) -> Layout | None:
    """Strips between the moved tips; patches that lost their load vanish, split where strips lost it, join where they
    meet.
    """
    found = []
    for k, (before, after) in tips.items():
        own = np.flatnonzero(layout.patch == k)
        runs = np.split(own, np.flatnonzero(np.diff((load[own] > 0).astype(int))) + 1)
        runs = [run for run in runs if load[run[0]] > 0]
        for run in runs:
            width = layout.width[run[0]]
            low, high = layout.sides[run[0], 0], layout.sides[run[-1], 1]
            if run[0] == own[0]:
                low -= before * width
            if run[-1] == own[-1]:
                high += after * width
            middle = layout.middle[run]
            if ((middle > low) & (middle < high)).any():
                count = len(own) if len(run) == len(own) else None
                found.append(Stretch(float(low), float(high), middle, layout.ends[run], count))
    return _assembled(found, fineness, layout.marks)
