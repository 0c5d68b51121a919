"""Strips that enter: unloaded ones whose surfaces would still penetrate at an edge beside the loaded ones."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.bindings._contact import (
    OPENING,
    Probes,
    Remaining,
    StripBasis,
    StripGrid,
    cell_operator,
    excess,
    pressed,
    search,
)
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.lattice.influence.basis import equal_cells
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.solver.cold_start import state_of_cells
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.solvers.active_set import normal_contact
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.support.arrays import Array, Nodes

FIRST = equal_cells(6)  # along an unloaded strip, to find where its maximum is
PROBES = equal_cells(12)  # around the maximum
MARGIN = 1.5  # half length of the cells of a strip that enters over that of a parabola of its remaining penetration
WIDENINGS = 4  # of these cells until they cover the remaining penetration


class Excess(NamedTuple):
    """Penetration that unloaded strips may have at an edge, the sum of fractions of the approach and of their onset."""

    approach: float
    onset: float


LEAST = Excess(1e-7, 1e-3)  # the load is 2e-7 of that on the whole width
UNCERTAIN = Excess(1e-5, 0.1)  # where a strip cannot stay loaded either: 2e-3


class Overlaps(NamedTuple):
    """Unloaded strips (n,) whose surfaces penetrate, and the middles and half lengths (n,) m of where they do."""

    strips: Nodes
    middle: Array
    half: Array

    @property
    def ends(self) -> Array:
        """Ends (n, 2) m."""
        return np.column_stack([self.middle - self.half, self.middle + self.half])


NO_OVERLAPS = Overlaps(np.empty(0, dtype=int), np.empty(0), np.empty(0))


def entering(
    problem: LatticeProblem, state: LatticeState, barred: set[int], least: Excess = LEAST
) -> LatticeState | None:
    """Unloaded strips that penetrate by more than a least penetration; None without any.

    Raises OutsideSurface, NotConverged.
    """
    return entered(problem, state, penetrating(problem, state, barred, least))


def penetrating(problem: LatticeProblem, state: LatticeState, barred: set[int], least: Excess = LEAST) -> Overlaps:
    """Unloaded strips that penetrate by more than a least penetration. Raises OutsideSurface."""
    return overlaps(problem, _remaining(problem, state, barred), least)


def overlaps(problem: LatticeProblem, rest: Remaining, least: Excess = LEAST) -> Overlaps:
    """Strips whose remaining penetration exceeds a least one. Raises OutsideSurface."""
    if not rest.inside:
        raise OutsideSurface(TOO_LONG)
    if not len(rest.strips):
        return NO_OVERLAPS
    enters = rest.depth > least.approach * problem.approach + least.onset * problem.lines.onset[rest.strips]
    if not enters.any():
        return NO_OVERLAPS
    half = np.minimum(MARGIN * np.sqrt(2 * rest.depth[enters] / rest.curvature[enters]), rest.half[enters])
    return Overlaps(rest.strips[enters], rest.place[enters], half)


def _remaining(problem: LatticeProblem, state: LatticeState, barred: set[int]) -> Remaining:
    """`search` of the strips that may enter."""
    places = probes_of(problem), problem.lines, np.array(sorted(barred), dtype=int)
    while True:
        complete, rest, known = search(state.values, problem.of(state.strips), *places)
        if complete:
            return rest
        problem.add_pairs(known)


def remaining_penetration(
    problem: LatticeProblem, state: LatticeState, strips: Nodes, low: Array, high: Array, *, cells: StripBasis = PROBES
) -> Array:
    """Penetration (n, C) m of unloaded strips (n,) that the tractions of the loaded ones leave, means over equal cells
    from low to high (n,) m. Raises OutsideSurface.
    """
    problem.add_pairs(np.union1d(state.strips, strips))
    lattice, onset = problem.tables.lattice, problem.lines.onset
    inside, depth = excess(state.values, problem.of(state.strips), lattice, onset, cells, strips, low, high)
    if not inside:
        raise OutsideSurface(TOO_LONG)
    return np.where(np.isfinite(depth), depth, -problem.approach)


def probes_of(problem: LatticeProblem) -> Probes:
    """Cells on which `search` evaluates the remaining penetration."""
    return Probes(problem.tables.lattice, FIRST, PROBES)


def entered(problem: LatticeProblem, state: LatticeState, found: Overlaps) -> LatticeState | None:
    """Strips under their remaining penetration, by complementarity on cells, while the loaded strips do not change.

    None without any. Raises OutsideSurface, NotConverged.
    """
    if not len(found.strips):
        return None
    new, (low, high) = found.strips, np.ascontiguousarray(found.ends.T)
    for widening in range(WIDENINGS):
        depth = remaining_penetration(problem, state, new, low, high)
        cut = depth[:, [0, -1]] > 0
        if not cut.any() or widening == WIDENINGS - 1:
            break
        length = high - low
        low = np.maximum(low - 0.5 * cut[:, 0] * length, problem.lines.window[0])
        high = np.minimum(high + 0.5 * cut[:, 1] * length, problem.lines.window[1])
    stretch = problem.tables.stretch[new]
    x = stretch[:, None] * (low[:, None] + (high - low)[:, None] * PROBES.row_marks)
    grid = StripGrid(x, stretch * (high - low), problem.width[new], stretch, new, problem.middle[new])
    inside, matrix = cell_operator(problem.pairs(new), grid, PROBES, False)
    if not inside:
        raise OutsideSurface(TOO_LONG)
    pressure = _pressed(matrix, depth)
    places = problem.places(new)
    cell = (high - low) / depth.shape[1]
    whole = 2.0 / np.pi * cell * pressure.sum(axis=1)  # load under this penetration of the whole width
    varies, deepest = places.whole > 0, depth.max(axis=1)
    compliance = deepest * np.divide(places.whole, whole, out=np.ones(len(new)), where=varies & (whole > 0))
    part = np.minimum(pressed(deepest, compliance, places.onset), 1.0)
    lifted = np.where(varies, places.onset * (1.0 - (1.0 - part) ** OPENING), 0.0)
    pressure = _pressed(matrix, depth - lifted[:, None])
    return state_of_cells(problem, new, np.column_stack([low, high]), pressure, np.zeros((2, *pressure.shape)))


def _pressed(matrix: Array, depth: Array) -> Array:
    """Pressure (n, C) Pa of cells under a penetration (n, C) m, by complementarity."""
    pressure, _ = normal_contact(matrix, depth.ravel(), depth.ravel() > 0, IterationCount())
    return pressure.reshape(depth.shape)
