"""Initial layout: strips over the region of penetration, with frictionless pressures on uniform cells."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout, marks
from wheelrail.contact.geometry.strip_surfaces import PenetrationProfile, StripSurfaces
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.solvers.active_set import CachedFactors, normal_contact
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

COARSE_STRIPS, COARSE_CELLS = 24, 8
GAUSS = 0.5 / np.sqrt(3.0)  # of a cell's length, from its middle

Overlap = Callable[[StripLayout], Array]  # undeformed penetration (S, M) m of the cells
NormalOperator = Callable[[StripLayout], CachedFactors]  # relative normal compliance m/Pa of cells


def mean_overlap(surfaces: StripSurfaces, pose: Pose, layout: StripLayout) -> Array:
    """Undeformed penetration (S, M) m, the mean over every cell, by Gauss's rule of 2 x 2 points."""
    across, along = gauss_places(layout.edges, layout.middle, layout.width)
    return np.asarray(surfaces.penetration(pose, across, along).mean(axis=0))


@compiled
def gauss_places(edges: Array, middle: Array, width: Array) -> tuple[Array, Array]:
    """Coordinates (4, S, M) m across and along of the Gauss points of cells with edges (S, M + 1) m, on strips with
    middles and widths (S,) m.
    """
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
    """Strips over every run of lines with positive penetration, on uniform cells, and the pressures (S, M) Pa there.

    Parameters:
        ridge: penetration profile of the rigid surfaces.
        overlap: undeformed penetration (S, M) m of the cells of a layout.
        operator: relative normal compliance m/Pa of the cells of a layout.
        count: iteration counts, increased.
    """
    inside = ridge.penetration > 0
    starts = np.flatnonzero(inside & ~np.concatenate([[False], inside[:-1]]))
    stops = np.flatnonzero(inside & ~np.concatenate([inside[1:], [False]]))
    sides, patch = [], []
    for number, (i, j) in enumerate(zip(starts.tolist(), stops.tolist(), strict=True)):
        low = _crossing(ridge, i, i - 1) if i > 0 else ridge.s[i]
        high = _crossing(ridge, j, j + 1) if j + 1 < len(ridge.s) else ridge.s[j]
        edge = np.linspace(low, high, COARSE_STRIPS + 1)
        sides.append(np.column_stack([edge[:-1], edge[1:]]))
        patch += [number] * COARSE_STRIPS
    strip_sides = np.concatenate(sides)
    middle = strip_sides.mean(axis=1)
    depth = np.maximum(np.interp(middle, ridge.s, ridge.penetration), 0.02 * ridge.penetration.max())
    x, half = np.interp(middle, ridge.s, ridge.x), np.sqrt(2 * depth / np.interp(middle, ridge.s, ridge.curvature))
    # on a steep flange strips next to the deepest one penetrate over far more than the contact's length
    longest, centre = half[np.argmax(depth)], x[np.argmax(depth)]
    half, x = np.minimum(half, longest), np.clip(x, centre - longest, centre + longest)
    layout = StripLayout(
        strip_sides, np.column_stack([x - half, x + half]), np.array(patch), marks(COARSE_CELLS, rolling=False)
    )
    depths = overlap(layout).ravel()
    pressure, _ = normal_contact(operator(layout), depths, depths > 0.4 * depths.max(), count)
    return layout, pressure.reshape(len(strip_sides), -1)


def _crossing(ridge: PenetrationProfile, inner: int, outer: int) -> float:
    """Arc length m between two lines at which the penetration vanishes."""
    a, b = ridge.penetration[inner], ridge.penetration[outer]
    fraction = a / (a - b) if np.isfinite(b) else 0.0
    return float(ridge.s[inner] + fraction * (ridge.s[outer] - ridge.s[inner]))
