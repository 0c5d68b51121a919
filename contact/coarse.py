"""A first look at a contact: strips over all that overlaps, equal cells, the frictionless pressures on them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contact.pose import Array, Nodes, Pose
from contact.pressure import Factors, normal_contact
from contact.strip_surfaces import Ridge, StripSurfaces
from contact.strips import Layout, marks
from contact.tractions import Count

FEW, MANY = (12, 6), (24, 8)  # strips of cells: where the overlap has one hump, and where it may have more
GAUSS = 0.5 / np.sqrt(3.0)  # of a cell's length, from its middle

Overlap = Callable[[Layout], Array]  # undeformed overlap (S, M) m of the cells
NormalOperator = Callable[[Layout], Factors]  # relative normal compliance m/Pa of cells


def mean_overlap(surfaces: StripSurfaces, pose: Pose, layout: Layout) -> Array:
    """Undeformed overlap (S, M) m, the mean over every cell, by Gauss's rule of two points each way."""
    edges = layout.edges
    x, length = 0.5 * (edges[:, 1:] + edges[:, :-1]), np.diff(edges)
    s, width = layout.middle[:, None], layout.width[:, None]
    at = [(s + i * GAUSS * width, x + j * GAUSS * length) for i in (-1, 1) for j in (-1, 1)]
    across, along = (np.stack([np.broadcast_to(p[k], x.shape) for p in at]) for k in (0, 1))
    return np.asarray(surfaces.overlap(pose, across, along).mean(axis=0))


def humps(ridge: Ridge) -> Nodes:
    """Lines of the ridge where the overlap is larger than at both neighbours."""
    o = ridge.overlap
    return np.flatnonzero((o[1:-1] > 0) & (o[1:-1] > o[:-2]) & (o[1:-1] >= o[2:])) + 1


def coarse(ridge: Ridge, overlap: Overlap, operator: NormalOperator, count: Count) -> tuple[Layout, Array]:
    """Strips over every run of lines that overlap, equal cells over their overlap, and pressures (S, M) Pa there."""
    if len(humps(ridge)) == 1:
        layout, pressure = _pressed(ridge, FEW, overlap, operator, count)
        bend = np.diff((pressure * np.diff(layout.edges)).sum(axis=1))
        if not ((bend[1:] > 0) & (bend[:-1] < 0)).any():
            return layout, pressure
    return _pressed(ridge, MANY, overlap, operator, count)


def _pressed(
    ridge: Ridge, cells: tuple[int, int], overlap: Overlap, operator: NormalOperator, count: Count
) -> tuple[Layout, Array]:
    inside = ridge.overlap > 0
    starts = np.flatnonzero(inside & ~np.concatenate([[False], inside[:-1]]))
    stops = np.flatnonzero(inside & ~np.concatenate([inside[1:], [False]]))
    sides, patch = [], []
    for number, (i, j) in enumerate(zip(starts, stops, strict=True)):
        low = _crossing(ridge, i, i - 1) if i > 0 else ridge.s[i]
        high = _crossing(ridge, j, j + 1) if j + 1 < len(ridge.s) else ridge.s[j]
        edge = np.linspace(low, high, cells[0] + 1)
        sides.append(np.column_stack([edge[:-1], edge[1:]]))
        patch += [number] * cells[0]
    both = np.concatenate(sides)
    middle = both.mean(axis=1)
    depth = np.maximum(np.interp(middle, ridge.s, ridge.overlap), 0.02 * ridge.overlap.max())
    x, half = np.interp(middle, ridge.s, ridge.x), np.sqrt(2 * depth / np.interp(middle, ridge.s, ridge.bend))
    # on a steep flange strips beside the deepest one overlap over far more than the contact's length
    longest, centre = half[np.argmax(depth)], x[np.argmax(depth)]
    half, x = np.minimum(half, longest), np.clip(x, centre - longest, centre + longest)
    layout = Layout(both, np.column_stack([x - half, x + half]), np.array(patch), marks(cells[1], rolling=False))
    depths = overlap(layout).ravel()
    pressure, _ = normal_contact(operator(layout), depths, depths > 0.4 * depths.max(), count)
    return layout, pressure.reshape(len(both), -1)


def _crossing(ridge: Ridge, inner: int, outer: int) -> float:
    """Arc length between two lines where the overlap vanishes."""
    a, b = ridge.overlap[inner], ridge.overlap[outer]
    share = a / (a - b) if np.isfinite(b) else 0.0
    return float(ridge.s[inner] + share * (ridge.s[outer] - ridge.s[inner]))
