"""Start without an earlier result: complementarity, with friction, on equal cells of all strips that penetrate."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from wheelrail.bindings._contact import GAUSS, MODES, StripBasis, StripGrid, cell_operator, frames, rigid_shift
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.lattice.influence.basis import equal_cells
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions, NotConverged
from wheelrail.contact.solvers.tractions import Tractions, solve_tractions
from wheelrail.support.arrays import Array, Nodes

WIDENINGS = 4  # of the cells until no pressure is left at their ends
OPTIONS = NewtonOptions(tolerance=1e-3)  # of a start


def cold_start(
    problem: LatticeProblem,
    laws: ContactLaws,
    cells: int,
    count: IterationCount,
    more: tuple[Nodes, Array] | None = None,
) -> LatticeState:
    """First strips and ends, from cells along every strip that penetrates, and along more strips (n,) between ends
    (n, 2) m. Raises OutsideSurface, NotConverged.
    """
    strips = problem.candidates
    ends = first_ends(problem, strips)
    if more is not None:
        strips, ends = np.append(strips, more[0]), np.vstack([ends, more[1]])
        order = np.argsort(strips)
        strips, ends = strips[order], ends[order]
    basis = equal_cells(cells, problem.tangential)
    for _ in range(WIDENINGS):
        pressure, tractions = _solved(problem, basis, strips, ends, laws, count)
        state = state_of_cells(problem, strips, ends, pressure, tractions)
        cut = pressure[:, [0, -1]] > 0
        if not cut.any():
            break
        low, high = problem.lines.window
        ends = np.clip(ends + np.where(cut, 0.5 * np.diff(ends), 0.0) * [-1.0, 1.0], low, high)
    if state is None:
        raise NotConverged("the cells of the first strips carry no pressure")
    return state


def _solved(
    problem: LatticeProblem, basis: StripBasis, strips: Nodes, ends: Array, laws: ContactLaws, count: IterationCount
) -> tuple[Array, Array]:
    """Pressure (S, N) and tractions (2, S, N) Pa of the N equal cells of a basis between ends (S, 2) m."""
    N = len(basis.marks) - 1
    stretch = problem.tables.stretch[strips]
    length = np.diff(ends)
    x = stretch[:, None] * (ends[:, :1] + length * basis.row_marks)
    grid = StripGrid(x, stretch * length[:, 0], problem.width[strips], stretch, strips, problem.middle[strips])
    inside, matrix = cell_operator(problem.pairs(strips), grid, basis, problem.rolls)
    if not inside:
        raise OutsideSurface(TOO_LONG)
    place = (ends[:, :1] + length * 0.5 * (basis.marks[1:] + basis.marks[:-1])).ravel()
    middle, width = np.repeat(problem.middle[strips], N), np.repeat(problem.width[strips], N)
    depth = 0.5 * sum(problem.penetration(middle + k * width, place).depth for k in (-GAUSS, GAUSS))
    depth = np.where(np.isfinite(depth), depth, -problem.approach)
    rigid = None
    if problem.rolls:
        level = np.repeat(problem.places(strips).level, N, axis=0)
        motion = problem.data
        at = frames(problem.surface, motion.origin, motion.rotation, middle, place)
        shift = rigid_shift(at, level, motion)[0]
        rigid = shift.T.ravel() / problem.speed
    tractions = _tractions(matrix, depth, rigid, laws, problem.speed, count)
    shape = len(strips), N
    return tractions.pressure.reshape(shape), tractions.tangential.T.reshape(2, *shape)


def _tractions(
    matrix: Array, depth: Array, rigid: Array | None, laws: ContactLaws, speed: float, count: IterationCount
) -> Tractions:
    """Tractions of the cells, see `solve_tractions`. Where they do not converge, those of friction that is not coupled
    to the pressure, and where these do not either, the pressure alone.
    """
    try:
        return solve_tractions(matrix, depth, rigid, laws=laws, speed=speed, options=OPTIONS, count=count)
    except NotConverged:
        if rigid is None:
            raise
    n = len(depth)
    uncoupled = matrix.copy()
    uncoupled[-n:, :-n] = 0.0
    with suppress(NotConverged):
        return solve_tractions(uncoupled, depth, rigid, laws=laws, speed=speed, options=OPTIONS, count=count)
    normal = np.ascontiguousarray(matrix[-n:, -n:])
    return solve_tractions(normal, depth, None, laws=ContactLaws(friction=0.0), speed=speed, count=count)


def first_ends(problem: LatticeProblem, strips: Nodes) -> Array:
    """Ends (S, 2) m of the region of penetration, no longer than that of the deepest strip: strips next to it on a
    steep flange penetrate over far more than the contact's length.
    """
    x, bend = (values[strips] for values in problem.crest)
    half = np.sqrt(2 * problem.depth[strips] / bend)
    half = np.minimum(half, half[np.argmax(problem.depth[strips])])
    return np.column_stack([x - half, x + half])


def state_of_cells(
    problem: LatticeProblem, strips: Nodes, ends: Array, pressure: Array, tractions: Array
) -> LatticeState | None:
    """Strips with pressure, their ends where its square falls to zero, and modes of equal load; None without any.

    Parameters:
        strips: (S,).
        ends: (S, 2) m, of the equal cells.
        pressure: (S, N) Pa.
        tractions: (2, S, N) Pa.
    """
    M, N = problem.cells if problem.rolls else 0, pressure.shape[1]
    chosen, rows = [], []
    for i, p in enumerate(pressure):
        loaded = np.flatnonzero(p > 0)
        if not len(loaded):
            continue
        cell = (ends[i, 1] - ends[i, 0]) / N
        low, high = _extent(p, loaded, float(ends[i, 0]), float(cell))
        values = np.zeros(2 * M + MODES + 2)
        values[-2:] = low, high
        values[2 * M] = 4 * p.sum() * cell / (np.pi * (high - low))
        if M:
            ratio = tractions[:, i] / np.maximum(p, 1e-3 * p.max())
            at = low + (high - low) * problem.cell_middles
            middles = ends[i, 0] + cell * (np.arange(N) + 0.5)
            new = values[2 * M] * problem.basis.mean[:, 0]
            for k in range(2):
                values[k * M : (k + 1) * M] = new * np.interp(at, middles[loaded], ratio[k][loaded])
        chosen.append(strips[i])
        rows.append(values)
    return LatticeState(np.array(chosen), np.array(rows)) if chosen else None


def _extent(p: Array, loaded: Nodes, start: float, cell: float) -> tuple[float, float]:
    """Ends m of the pressure (N,) on cells, extrapolated by its square where there are three loaded cells."""
    a, b = loaded[0], loaded[-1]
    low, high = start + a * cell, start + (b + 1) * cell
    if len(loaded) >= 3:
        low += cell * (0.5 - _beyond(p[a], p[a + 1]))
        high -= cell * (0.5 - _beyond(p[b], p[b - 1]))
    return low, high


def _beyond(outer: float, inner: float) -> float:
    """Distance from the middle of the outer cell to the end, in cells, 0 to 1."""
    rise = inner**2 - outer**2
    return float(np.clip(outer**2 / rise, 0.0, 1.0)) if rise > 0 else 1.0
