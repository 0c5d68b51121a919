"""Compiled: penetration that remains on unloaded strips beside the loaded ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import StripBasis
from wheelrail.contact.models.lattice.influence.cell_compliance import normal_displacements
from wheelrail.contact.models.lattice.influence.pair_tables import Lattice, PairTables
from wheelrail.contact.models.lattice.system.contact_lines import ContactLines
from wheelrail.contact.models.lattice.system.equations import EquationData, force_jumps, strip_grid
from wheelrail.contact.models.lattice.system.surface import GAUSS, penetration
from wheelrail.support.arrays import Array, Mask, Nodes
from wheelrail.support.compiled import borrowing, compiled, inlined

RANGE = 1.2  # half length of the probed range over that of the next loaded strip
NARROWINGS = 6  # of the range around a maximum, to a third of it each
NEXT_TO = 2  # strips: those nearer to a loaded one are probed around its middle, moved like their crests


class Remaining(NamedTuple):
    """Remaining penetration of n unloaded strips on which it may be positive.

    Parameters:
        inside: whether all points lie on the surfaces and in the tables.
        strips: (n,) their numbers.
        depth: (n,) m, its maximum along x.
        place: (n,) m, of the maximum.
        curvature: (n,) 1/m there.
        half: (n,) m, half length of the probed range.
        highest: (m,) m, estimated maximum on all m unloaded strips.
    """

    inside: bool
    strips: Nodes
    depth: Array
    place: Array
    curvature: Array
    half: Array
    highest: Array


class Probes(NamedTuple):
    """Where the remaining penetration is evaluated.

    Parameters:
        lattice: all strips.
        first, second: equal cells along the probed range, for an estimate, and along the part around its maximum.
    """

    lattice: Lattice
    first: StripBasis
    second: StripBasis


@compiled
def excess(
    values: Array,
    data: EquationData,
    lattice: Lattice,
    onset: Array,
    basis: StripBasis,
    strips: Nodes,
    low: Array,
    high: Array,
) -> tuple[bool, Array]:
    """Remaining penetration (n, C) m at the edge where strips (n,) that are not loaded begin to touch, means over the
    cells of a basis from low to high (n,) m along them; values (S, block) of the loaded ones, onset (K,) m of all. The
    flag is as in `Remaining`; beyond the lower body it is -inf.
    """
    motion = data.motion
    n, C, count = len(strips), len(basis.marks) - 1, len(basis.stations)
    s, x = np.empty(2 * n * count), np.empty(2 * n * count)
    for i in range(n):
        k = strips[i]
        for g in range(2):
            for m in range(count):
                at = (2 * i + g) * count + m
                s[at] = lattice.middle[k] + (2 * g - 1) * GAUSS * lattice.width[k]
                x[at] = low[i] + (high[i] - low[i]) * basis.stations[m]
    edges = np.empty((n, C + 1))
    for i in range(n):
        for r in range(C + 1):
            edges[i, r] = lattice.stretch[strips[i]] * (low[i] + (high[i] - low[i]) * basis.marks[r])
    grid, rolls = strip_grid(values, data.places, data.basis), motion.speed > 0.0
    jumps = force_jumps(values, data.places, data.basis, rolls)
    inside, total = normal_displacements(
        data.tables, strips, lattice.middle[strips], edges, grid, values, jumps, data.basis, rolls
    )
    depth = penetration(data.surface, motion.origin, motion.rotation, s, x).depth
    for i in range(n):
        for r in range(C):
            for m in range(2 * count):
                total[i, r] += 0.5 * basis.cell_penetration[r, m % count] * depth[2 * i * count + m]
            total[i, r] += onset[strips[i]]
            if not np.isfinite(total[i, r]):
                total[i, r] = -np.inf
    return inside, total


@borrowing
def _maximum(values: Array, low: float, high: float) -> tuple[float, float, float]:
    """Maximum, its place and the curvature of the parabola with the largest of means (C,) over cells and the next ones:
    at the middle of a cell it is higher than its mean by a third of what it falls within half a cell.
    """
    C = len(values)
    step = (high - low) / C
    largest = int(np.argmax(values))
    k = min(max(largest, 1), C - 2)
    left, middle, right = values[k - 1], values[k], values[k + 1]
    place = low + (k + 0.5) * step
    if not np.isfinite(left + middle + right):
        return values[largest], place, 1e-2
    curvature = max((2.0 * middle - left - right) / (step * step), 1e-2)
    slope = (right - left) / (2.0 * step)
    offset = min(max(slope / curvature, -step), step)
    top = middle + curvature * step * step / 24.0
    return top + slope * offset - 0.5 * curvature * offset * offset, place + offset, curvature


@inlined
def remaining(values: Array, data: EquationData, probes: Probes, lines: ContactLines, free: Nodes) -> Remaining:
    """`Remaining` penetration of the strips free (n,), values (S, block) of the loaded ones."""
    n, S, last = len(free), len(values), values.shape[1] - 1
    low, high, extent = np.empty(n), np.empty(n), 0.0
    for i in range(S):
        extent = max(extent, 0.5 * (values[i, last] - values[i, last - 1]))
    for k in range(n):
        strip, near = free[k], 0
        for i in range(S):
            if abs(strip - data.places.strip[i]) < abs(strip - data.places.strip[near]):
                near = i
        middle, half = lines.x[strip], max(np.sqrt(2.0 * max(lines.depth[strip], 0.0) / lines.curvature[strip]), extent)
        if abs(strip - data.places.strip[near]) <= NEXT_TO:
            along = lines.x[strip] - lines.x[data.places.strip[near]]
            middle = 0.5 * (values[near, last] + values[near, last - 1]) + along
            half = RANGE * max(0.5 * (values[near, last] - values[near, last - 1]), 0.1 * extent) + abs(along)
        low[k], high[k] = middle - half, middle + half
    inside, first = excess(values, data, probes.lattice, lines.onset, probes.first, free, low, high)
    close = np.zeros(n, dtype=np.bool_)
    place, highest = np.empty(n), np.empty(n)
    for k in range(n):
        highest[k], place[k], curvature = _maximum(first[k], low[k], high[k])
        half = 0.5 * (high[k] - low[k]) / first.shape[1]
        close[k] = highest[k] + 0.5 * curvature * half * half > 0.0  # as uncertain as what it falls within half a cell
    strips, place, probed = free[close], place[close], 0.5 * (high[close] - low[close])
    # around the maximum, again while it may be positive or not: it is flatter than a parabola, or narrow at an end of
    # the next strip
    C = first.shape[1]
    low, high = place - 2.0 * probed / C, place + 2.0 * probed / C
    deepest, bend, unsure = np.empty(len(strips)), np.empty(len(strips)), np.arange(len(strips))
    for _ in range(NARROWINGS):
        found, second = excess(values, data, probes.lattice, lines.onset, probes.second, strips[unsure], low, high)
        inside = inside and found
        doubtful = np.zeros(len(unsure), dtype=np.bool_)
        for i in range(len(unsure)):
            k, half = unsure[i], 0.5 * (high[i] - low[i]) / second.shape[1]
            deepest[k], place[k], bend[k] = _maximum(second[i], low[i], high[i])
            low[i], high[i] = place[k] - 4.0 * half, place[k] + 4.0 * half
            doubtful[i] = abs(deepest[k]) < 0.5 * bend[k] * half * half
        if not doubtful.any():
            break
        unsure, low, high = unsure[doubtful], low[doubtful], high[doubtful]
    return Remaining(inside, strips, deepest, place, bend, probed, highest)


@compiled
def search(
    values: Array, data: EquationData, probes: Probes, lines: ContactLines, barred: Nodes
) -> tuple[bool, Remaining, Nodes]:
    """Remaining penetration of the strips that may enter: of those that are probed at first or next to loaded ones, and
    of further ones as long as it grows from strip to strip.

    Parameters:
        values: (S, block) of the loaded strips.
        data: of their equations.
        probes, lines: of all strips.
        barred: (n,) numbers of strips that must not enter.

    The flag is False where tables of pairs are missing: of those between the strips in the last result.
    """
    near = lines.near
    taken = np.zeros(len(near), dtype=np.bool_)
    taken[data.places.strip] = True
    known = lines.probed | taken
    known |= next_to_loaded(data.places.strip, known, near)
    taken[barred] = True
    while True:
        free = np.flatnonzero(known & ~taken)
        if not _paired(data.tables, data.places.strip, free):
            return False, nothing_known(), np.flatnonzero(known)
        rest = remaining(values, data, probes, lines, free)
        further = next_to_deeper(free, rest.highest, known, near)
        if not further.any():
            return True, rest, free
        known |= further


@compiled
def nothing_known() -> Remaining:
    """The remaining penetration of no strip."""
    none = np.empty(0)
    return Remaining(False, np.empty(0, dtype=np.int64), none, none, none, none, none)


@borrowing
def _paired(tables: PairTables, loaded: Nodes, free: Nodes) -> bool:
    """Whether there are tables for all pairs of a loaded strip and a free one."""
    for i in loaded:
        for k in free:
            if tables.pair[min(i, k), max(i, k)] == 0:
                return False
    return True


@compiled
def next_to_loaded(loaded: Nodes, known: Mask, near: Mask) -> Mask:
    """Strips (K,) near to contact, next to loaded ones (S,), that are not known (K,)."""
    K = len(known)
    chosen = np.zeros(K, dtype=np.bool_)
    for strip in loaded:
        for k in (max(strip - 1, 0), min(strip + 1, K - 1)):
            chosen[k] = near[k] and not known[k]
    return chosen


@compiled
def next_to_deeper(free: Nodes, highest: Array, known: Mask, near: Mask) -> Mask:
    """Strips (K,) near to contact towards which the remaining penetration grows, or next to where it is positive.

    Parameters:
        free: (n,) numbers of unloaded strips.
        highest: (n,) m, their remaining penetration.
        known: (K,) strips where it is known, or that are loaded.
        near: (K,) strips near to contact.
    """
    K = len(known)
    depth, chosen = np.zeros(K), np.zeros(K, dtype=np.bool_)
    depth[free] = highest
    for i in range(len(free)):
        for side in (-1, 1):
            behind, ahead = free[i] - side, free[i] + side
            if 0 <= ahead < K and near[ahead] and not known[ahead]:
                chosen[ahead] = chosen[ahead] or highest[i] > (min(depth[behind], 0.0) if 0 <= behind < K else 0.0)
    return chosen
