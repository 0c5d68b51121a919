"""Compiled: where the strips of a lattice touch at a pose, and which of them may come into contact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.influence.pair_tables import Lattice
from wheelrail.contact.models.lattice.system.partial_width import partial_widths
from wheelrail.contact.models.lattice.system.surface import (
    GAUSS,
    Motion,
    SurfaceData,
    crests,
    frames,
    penetration,
    rigid_shift,
)
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import borrowing, compiled

APART = 2 / 7  # of a usual patch's width: distance of the strips at which the penetration is estimated first
MOST_APART = 4  # strips
MARGIN = 3e-4  # m, by which it may be larger in between, and largest gap that displacements may close: ordinary strips


class ContactLines(NamedTuple):
    """Where K strips touch: on their middles, the points of largest penetration along x.

    Parameters:
        depth: (K,) m, penetration at their x, the mean over the width; -inf far from contact.
        onset, whole: (K,) m, see `wheelrail.contact.models.lattice.system.partial_width.partial_widths`.
        x: (K,) m, its place along x.
        curvature: (K,) 1/m, relative curvature along x there.
        foot: (K,) m, arc length of the closest points on the lower body; NaN where the gap exceeds the margin.
        level: (K, 3) longitudinal axis.
        covered: (K,) strips that the lines of both bodies carry.
        near: (K,) these and strips that penetrate: displacements may bring them into contact, for friction on a tread
            can close the gap of a flange.
        probed: (K,) strips near to contact to look at first, see `smallest_gaps`.
        approach: m, the largest penetration.
        window: m, ends of the range of x in which there may be contact, twice the region of penetration.
        speed: m/s at which both materials flow backwards, the mean weighted by the squared penetration; 0 without
            penetration.
    """

    depth: Array
    onset: Array
    whole: Array
    x: Array
    curvature: Array
    foot: Array
    level: Array
    covered: Mask
    near: Mask
    probed: Mask
    approach: float
    window: tuple[float, float]
    speed: float


def strips_apart(strips: int) -> int:
    """Distance, in strips, of those at which the penetration is estimated first; strips: over a usual patch."""
    return min(max(round(APART * strips), 1), MOST_APART)


@compiled
def contact_lines(surface: SurfaceData, motion: Motion, lattice: Lattice, margin: float, apart: int) -> ContactLines:
    """`ContactLines` of the strips of a lattice.

    Parameters:
        surface, motion, lattice: of both bodies.
        margin: m, largest gap between strips that matter.
        apart: see `strips_apart`.
    """
    middle, width = lattice.middle, lattice.width
    K = len(middle)
    depth, x, curvature = np.full(K, -np.inf), np.zeros(K), np.ones(K)
    count = (K + apart - 2) // apart + 1
    probes = np.empty(count, dtype=np.int64)
    for k in range(count):
        probes[k] = min(k * apart, K - 1)
    close = crests(surface, motion.origin, motion.rotation, middle[probes])[0].depth > -margin
    own = np.zeros(K, dtype=np.bool_)
    for k in range(count):
        if close[k]:
            own[max(probes[k] - apart, 0) : probes[k] + apart + 1] = True
    inside = np.flatnonzero(own)
    closest, crest, bend = crests(surface, motion.origin, motion.rotation, middle[inside])
    s, along = np.empty(2 * len(inside)), np.empty(2 * len(inside))
    for k in range(len(inside)):
        for g in range(2):
            s[2 * k + g] = middle[inside[k]] + (2 * g - 1) * GAUSS * width[inside[k]]
            along[2 * k + g] = crest[k]
    sides = penetration(surface, motion.origin, motion.rotation, s, along).depth
    for k in range(len(inside)):
        depth[inside[k]] = 0.5 * (sides[2 * k] + sides[2 * k + 1])
        x[inside[k]], curvature[inside[k]] = crest[k], bend[k]
    foot, level = np.full(K, np.nan), np.zeros((K, 3))
    for k in range(len(inside)):
        if depth[inside[k]] > -margin:
            foot[inside[k]] = closest.foot[k]
    touching = np.flatnonzero(depth > -margin)
    s, along = middle[touching], x[touching]
    places = frames(surface, motion.origin, motion.rotation, s, along)
    flow = rigid_shift(places, np.ascontiguousarray(places.axes[:, 0]), motion)[2]
    total, weights = 0.0, 0.0
    for k in range(len(touching)):
        i = touching[k]
        level[i] = places.axes[k, 0]
        weight = max(depth[i], 0.0) ** 2 * width[i]
        total, weights = total - weight * flow[k], weights + weight
    onset, whole = partial_widths(depth, curvature, middle, width)
    covered = np.zeros(K, dtype=np.bool_)
    _store_covered(lattice, foot, covered)
    near = covered | (depth > 0.0)
    probed = smallest_gaps(depth, near)
    speed = total / weights if weights > 0.0 else 0.0
    window = _window(depth, x, curvature, probed)
    return ContactLines(
        depth, onset, whole, x, curvature, foot, level, covered, near, probed, depth.max(), window, speed
    )


@borrowing
def _store_covered(lattice: Lattice, foot: Array, covered: Mask) -> None:
    """Mark the strips (K,) that the lines of both bodies carry; foot (K,) m, NaN where there is none."""
    low, high = lattice.bounds[0], lattice.bounds[1]
    for k in range(len(foot)):
        half = 0.5 * lattice.width[k]
        covered[k] = lattice.carried[k] and foot[k] - half >= low and foot[k] + half <= high


@borrowing
def _window(depth: Array, x: Array, curvature: Array, probed: Mask) -> tuple[float, float]:
    """Range m of x of `ContactLines`; (0, 0) where no strip is probed."""
    low, high = np.inf, -np.inf
    for k in range(len(depth)):
        if probed[k]:
            half = np.sqrt(2.0 * max(depth[k], 0.0) / curvature[k])
            low, high = min(low, x[k] - half), max(high, x[k] + half)
    if not low < np.inf:
        return 0.0, 0.0
    return 1.5 * low - 0.5 * high, 1.5 * high - 0.5 * low


@compiled
def smallest_gaps(depth: Array, near: Mask) -> Mask:
    """Strips (K,) that penetrate or, of those near to contact, lie where the gap is smallest, and the next ones.

    Parameters:
        depth: (K,) m, penetration.
        near: (K,) strips near to contact.
    """
    K = len(depth)
    chosen = np.zeros(K, dtype=np.bool_)
    for k in range(K):
        smallest = near[k] and depth[k] >= depth[max(k - 1, 0)] and depth[k] >= depth[min(k + 1, K - 1)]
        if smallest or depth[k] > 0.0:
            for m in range(max(k - 1, 0), min(k + 2, K)):
                chosen[m] = chosen[m] or near[m]
    return chosen
