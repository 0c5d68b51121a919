"""A first look at a contact: strips over all that overlaps, equal cells, the frictionless pressures on them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.models.fitted.layout import StripLayout, marks
from wheelrail.contact.models.fitted.surfaces import PenetrationProfile, StripSurfaces
from wheelrail.contact.solvers.active_set import CachedFactors, normal_contact
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

COARSE_STRIPS, COARSE_CELLS = 24, 8
GAUSS = 0.5 / np.sqrt(3.0)  # of a cell's length, from its middle

Overlap = Callable[[StripLayout], Array]  # undeformed overlap (S, M) m of the cells
NormalOperator = Callable[[StripLayout], CachedFactors]  # relative normal compliance m/Pa of cells


def mean_overlap(surfaces: StripSurfaces, pose: Pose, layout: StripLayout) -> Array:
    """Undeformed overlap (S, M) m, the mean over every cell, by Gauss's rule of two points each way."""
    across, along = gauss_places(layout.edges, layout.middle, layout.width)
    return np.asarray(surfaces.overlap(pose, across, along).mean(axis=0))


@compiled
def gauss_places(edges: Array, middle: Array, width: Array) -> tuple[Array, Array]:
    """Places (4, S, M) across and along of Gauss's points in the cells of strips, edges (S, M + 1)."""
    S, M = edges.shape[0], edges.shape[1] - 1
    across, along = np.empty((4, S, M)), np.empty((4, S, M))
    for i in range(S):
        for k in range(M):
            x, length = 0.5 * (edges[i, k + 1] + edges[i, k]), edges[i, k + 1] - edges[i, k]
            for at in range(4):
                across[at, i, k] = middle[i] + (GAUSS if at < 2 else -GAUSS) * width[i]
                along[at, i, k] = x + (GAUSS if at % 2 else -GAUSS) * length
    return across, along


def initial_layout(
    ridge: PenetrationProfile, overlap: Overlap, operator: NormalOperator, count: IterationCount
) -> tuple[StripLayout, Array]:
    """Strips over every run of lines that overlap, equal cells over their overlap, and pressures (S, M) Pa there."""
    inside = ridge.overlap > 0
    starts = np.flatnonzero(inside & ~np.concatenate([[False], inside[:-1]]))
    stops = np.flatnonzero(inside & ~np.concatenate([inside[1:], [False]]))
    sides, patch = [], []
    for number, (i, j) in enumerate(zip(starts.tolist(), stops.tolist(), strict=True)):
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
    layout = StripLayout(
        both, np.column_stack([x - half, x + half]), np.array(patch), marks(COARSE_CELLS, rolling=False)
    )
    depths = overlap(layout).ravel()
    pressure, _ = normal_contact(operator(layout), depths, depths > 0.4 * depths.max(), count)
    return layout, pressure.reshape(len(both), -1)


def _crossing(ridge: PenetrationProfile, inner: int, outer: int) -> float:
    """Arc length between two lines where the overlap vanishes."""
    a, b = ridge.overlap[inner], ridge.overlap[outer]
    share = a / (a - b) if np.isfinite(b) else 0.0
    return float(ridge.s[inner] + share * (ridge.s[outer] - ridge.s[inner]))
