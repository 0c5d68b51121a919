"""Strips that enter: unloaded ones whose surfaces would still penetrate beside the loaded ones."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.lattice.influence.basis import StripBasis, equal_cells
from wheelrail.contact.models.lattice.influence.cell_compliance import cell_operator
from wheelrail.contact.models.lattice.influence.operator import StripGrid
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.solver.cold_start import state_of_cells
from wheelrail.contact.models.lattice.solver.remaining import Probes, excess, remaining
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.solvers.active_set import normal_contact
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.support.arrays import Array, Nodes

PROBES = equal_cells(12)  # along an unloaded strip
EXCESS = 1e-7  # of the approach: least penetration of a strip that enters
UNCERTAIN = 1e-5  # of the approach: penetration that a strip may leave unloaded, where it cannot stay loaded either
MARGIN = 1.5  # half length of the cells of a strip that enters over that of a parabola of its remaining penetration
WIDENINGS = 4  # of these cells until they cover the remaining penetration


def entering(
    problem: LatticeProblem, state: LatticeState, barred: set[int], least: float = EXCESS
) -> LatticeState | None:
    """Unloaded strips that penetrate by more than a least fraction of the approach; None without any.

    Raises OutsideSurface, NotConverged.
    """
    loaded = {*state.strips.tolist(), *barred}
    free = np.array([strip for strip in problem.candidates.tolist() if strip not in loaded], dtype=int)
    if not len(free):
        return None
    rest = remaining(state.values, problem.of(state.strips), _probes(problem, PROBES), problem.lines, free)
    if not rest.inside:
        raise OutsideSurface(TOO_LONG)
    enters = rest.depth > least * problem.approach
    if not enters.any():
        return None
    half = np.minimum(MARGIN * np.sqrt(2 * rest.depth[enters] / rest.curvature[enters]), rest.half[enters])
    return _pressed(problem, state, rest.strips[enters], rest.place[enters], half)


def remaining_penetration(
    problem: LatticeProblem, state: LatticeState, strips: Nodes, low: Array, high: Array, *, cells: StripBasis = PROBES
) -> Array:
    """Penetration (n, C) m of unloaded strips (n,) that the tractions of the loaded ones leave, means over equal cells
    from low to high (n,) m. Raises OutsideSurface.
    """
    inside, depth = excess(state.values, problem.of(state.strips), _probes(problem, cells), strips, low, high)
    if not inside:
        raise OutsideSurface(TOO_LONG)
    return np.where(np.isfinite(depth), depth, -problem.approach)


def _probes(problem: LatticeProblem, cells: StripBasis) -> Probes:
    return Probes(problem.middle, problem.width, problem.tables.stretch, cells)


def _pressed(
    problem: LatticeProblem, state: LatticeState, new: Nodes, middle: Array, half: Array
) -> LatticeState | None:
    """Strips new (n,) under their remaining penetration, by complementarity on cells around middles (n,) m, while the
    loaded strips do not change.
    """
    low, high = middle - half, middle + half
    for widening in range(WIDENINGS):
        depth = remaining_penetration(problem, state, new, low, high)
        cut = depth[:, [0, -1]] > 0
        if not cut.any() or widening == WIDENINGS - 1:
            break
        length = high - low
        low, high = low - 0.5 * cut[:, 0] * length, high + 0.5 * cut[:, 1] * length
    stretch = problem.tables.stretch[new]
    x = stretch[:, None] * (low[:, None] + (high - low)[:, None] * PROBES.row_marks)
    grid = StripGrid(x, stretch * (high - low), problem.width[new], stretch, new)
    inside, matrix = cell_operator(problem.pairs, grid, PROBES, False)
    if not inside:
        raise OutsideSurface(TOO_LONG)
    pressure, _ = normal_contact(matrix, depth.ravel(), depth.ravel() > 0, IterationCount())
    cells = pressure.reshape(depth.shape)
    return state_of_cells(problem, new, np.column_stack([low, high]), cells, np.zeros((2, *cells.shape)))
