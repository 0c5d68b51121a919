"""Strips that enter: unloaded ones whose surfaces would still penetrate beside the loaded ones."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.fitted.operators import TOO_LONG
from wheelrail.contact.models.lattice.cold_start import state_of_cells
from wheelrail.contact.models.lattice.equations import GAUSS, force_jumps, strip_grid
from wheelrail.contact.models.lattice.influence.basis import equal_cells
from wheelrail.contact.models.lattice.influence.cell_compliance import cell_operator, normal_displacements
from wheelrail.contact.models.lattice.influence.operator import StripGrid
from wheelrail.contact.models.lattice.problem import LatticeProblem
from wheelrail.contact.models.lattice.state import LatticeState
from wheelrail.contact.solvers.active_set import normal_contact
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.support.arrays import Array, Mask, Nodes

PROBES = 12  # cells along an unloaded strip
RANGE = 1.2  # half length of the probed range over that of the next loaded strip
NEXT_TO = 2  # strips: those nearer to a loaded one are probed around its middle
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
    free = np.setdiff1d(problem.candidates, state.strips)
    free = free[[int(strip) not in barred for strip in free]] if len(free) else free
    if not len(free):
        return None
    middle, half = _ranges(problem, state, free)
    top, place, curvature, close = _excess(problem, state, free, middle, half)
    if not close.any():
        return None
    # once more around the maximum: the penetration beside a loaded strip is flatter than a parabola
    free, middle, half = free[close], place[close], half[close]
    top, place, curvature, _ = _excess(problem, state, free, middle, 2 * half / PROBES)
    chosen = top > least * problem.approach
    if not chosen.any():
        return None
    extent = np.minimum(MARGIN * np.sqrt(2 * top[chosen] / curvature[chosen]), half[chosen])
    return _pressed(problem, state, free[chosen], place[chosen], extent)


def _pressed(
    problem: LatticeProblem, state: LatticeState, new: Nodes, middle: Array, half: Array
) -> LatticeState | None:
    """Strips new (n,) under their remaining penetration, by complementarity on cells around middles (n,) m, while the
    loaded strips do not change.
    """
    ends = np.column_stack([middle - half, middle + half])
    for _ in range(WIDENINGS):
        edges = ends[:, :1] + np.diff(ends) * np.linspace(0.0, 1.0, PROBES + 1)
        excess = remaining_penetration(problem, state, new, edges)
        cut = excess[:, [0, -1]] > 0
        if not cut.any():
            break
        ends = ends + np.where(cut, 0.5 * np.diff(ends), 0.0) * [-1.0, 1.0]
    ends, stretch = edges[:, [0, -1]], problem.tables.stretch[new]
    basis = equal_cells(PROBES)
    x = stretch[:, None] * (ends[:, :1] + np.diff(ends) * basis.row_marks)
    grid = StripGrid(x, stretch * np.diff(ends)[:, 0], problem.width[new], stretch)
    inside, matrix = cell_operator(problem.pairs(new), grid, basis, False)
    if not inside:
        raise OutsideSurface(TOO_LONG)
    pressure, _ = normal_contact(matrix, excess.ravel(), excess.ravel() > 0, IterationCount())
    cells = pressure.reshape(len(new), PROBES)
    return state_of_cells(problem, new, ends, cells, np.zeros((2, *cells.shape)))


def _ranges(problem: LatticeProblem, state: LatticeState, free: Nodes) -> tuple[Array, Array]:
    """Middles and half lengths (n,) m of the probed ranges."""
    x, bend = (values[free] for values in problem.crest)
    near = np.abs(free[:, None] - state.strips).argmin(axis=1)
    beside = np.abs(free - state.strips[near]) <= NEXT_TO
    own = np.sqrt(2 * problem.depth[free] / bend)
    middle = np.where(beside, state.ends.mean(axis=1)[near], x)
    return middle, np.where(beside, RANGE * np.maximum(state.half[near], 0.1 * state.half.max()), own)


def _excess(
    problem: LatticeProblem, state: LatticeState, free: Nodes, middle: Array, half: Array
) -> tuple[Array, Array, Array, Mask]:
    """Largest remaining penetration (n,) m in ranges along unloaded strips, its place m and curvature 1/m.

    The last value (n,) is whether it may be positive.
    """
    edges = middle[:, None] + half[:, None] * np.linspace(-1.0, 1.0, PROBES + 1)
    at = 0.5 * (edges[:, 1:] + edges[:, :-1])
    excess = remaining_penetration(problem, state, free, edges)
    top, place, curvature = _crest(excess, at)
    return top, place, curvature, top + 2 * (top - excess.max(axis=1)) > 0


def remaining_penetration(problem: LatticeProblem, state: LatticeState, strips: Nodes, edges: Array) -> Array:
    """Penetration (n, C) m of unloaded strips (n,) that the tractions of the loaded ones leave.

    edges: (n, C + 1) m, boundaries of cells along the strips. Raises OutsideSurface.
    """
    at = 0.5 * (edges[:, 1:] + edges[:, :-1])
    depth = np.zeros(at.shape)
    for line in (-GAUSS, GAUSS):
        s = np.repeat(problem.middle[strips] + line * problem.width[strips], at.shape[1])
        depth += 0.5 * problem.penetration(s, at.ravel()).depth.reshape(at.shape)
    return np.where(np.isfinite(depth), depth, -problem.approach) + _displacement(problem, state, strips, edges)


def _displacement(problem: LatticeProblem, state: LatticeState, free: Nodes, edges: Array) -> Array:
    """Relative normal displacement (n, C) m of cells by the loaded strips."""
    stretch = problem.tables.stretch[free]
    i, j = (index.ravel() for index in np.meshgrid(free, state.strips, indexing="ij"))
    feet = problem.at_crests.foot if problem.tables.moves else None
    tables = problem.tables.of(np.minimum(i, j), np.maximum(i, j), feet, problem.reach)
    places = problem.of(state.strips).places
    grid = strip_grid(state.values, places, problem.basis)
    jumps = force_jumps(state.values, places, problem.basis, problem.rolls)
    before = (free[:, None] < state.strips).ravel()
    inside, displacement = normal_displacements(tables, before, stretch[:, None] * edges, grid, jumps)
    if not inside:
        raise OutsideSurface(TOO_LONG)
    return displacement


def _crest(excess: Array, at: Array) -> tuple[Array, Array, Array]:
    """Maximum (n,) m, its place (n,) m and curvature (n,) 1/m by parabolas through the largest value and its
    neighbours.
    """
    n, step = len(at), at[:, 1] - at[:, 0]
    k = np.clip(excess.argmax(axis=1), 1, at.shape[1] - 2)
    row = np.arange(n)
    left, middle, right = excess[row, k - 1], excess[row, k], excess[row, k + 1]
    bend = np.maximum((2 * middle - left - right) / step**2, 1e-2)
    slope = (right - left) / (2 * step)
    offset = np.clip(slope / bend, -step, step)
    return middle + slope * offset - 0.5 * bend * offset**2, at[row, k] + offset, bend
