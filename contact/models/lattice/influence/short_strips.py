"""Compiled: displacement of short strips by the pressure of near, longer ones, whose cells are split for this.

Pressure that is constant in cells of length h bends the surface beside them by a staircase, which decays with the
distance d like exp(-2 pi d / h). A strip that is not much longer than the steps could lie in several places on it.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import StripBasis
from wheelrail.contact.models.lattice.influence.operator import StripGrid, look_up
from wheelrail.contact.models.lattice.influence.pair_grid import NN
from wheelrail.contact.models.lattice.influence.pair_tables import PairTables
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

NEAR = 1.0, 2.0  # longest cell over the distance: up to there the steps have decayed, from there on all of it counts


@borrowing
def share(length: float, loaded: float, distance: float, basis: StripBasis) -> tuple[float, float, float]:
    """Share from 0 to 1 of the split cells in the displacement of a strip, 0 if it is as long as the loaded one, and
    its derivatives 1/m by both lengths.

    Parameters:
        length, loaded: m, of the displaced and of the loaded strip.
        distance: m, between their middles.
    """
    ratio, cell = length / loaded, basis.longest * loaded / distance
    if ratio >= 1.0 or cell <= NEAR[0]:
        return 0.0, 0.0, 0.0
    short = 1.0 - ratio**4
    t = min((cell - NEAR[0]) / (NEAR[1] - NEAR[0]), 1.0)
    near, by_t = t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t)
    by_ratio = -8.0 * ratio**3 * short * near
    by_cell = short * short * by_t / (NEAR[1] - NEAR[0])
    return short * short * near, by_ratio / loaded, (by_cell * cell - by_ratio * ratio) / loaded


@compiled
def split_jumps(values: Array, width: Array, basis: StripBasis, rolls: bool) -> Array:
    """Jumps (S, N + 1) N/m of the normal force per length at the boundaries of split cells, less those of whole ones.

    Parameters:
        values: (S, block) of the strips.
        width: (S,) m.
    """
    S, N, modes = len(values), len(basis.split_marks), basis.split_edges.shape[1]
    at = 2 * (len(basis.marks) - 1) if rolls else 0
    jumps = np.zeros((S, N))
    for i in range(S):
        for c in range(N):
            for m in range(modes):
                jumps[i, c] -= width[i] * values[i, at + m] * basis.split_edges[c, m]
    return jumps


@borrowing
def split_table(
    tables: PairTables, displaced: int, loaded: int, rows: Array, columns: Array, G: Array, H: Array | None
) -> bool:
    """As `look_up` of a displaced and a loaded strip in any order; the component NN is valid."""
    turn = 1.0 if displaced < loaded else -1.0  # reciprocity: the transposed table at the opposite distance
    first, last = min(displaced, loaded), max(displaced, loaded)
    inside = look_up(tables, first, last, rows, columns, G, H, turn)
    if H is not None:
        for r in range(len(rows)):
            for c in range(len(columns)):
                H[r, c, NN] *= turn
    return inside


@borrowing
def store_boundaries(grid: StripGrid, j: int, basis: StripBasis, edges: Array) -> None:
    """Fill boundaries (N + 1,) m of the split cells of a strip."""
    for c in range(len(edges)):
        edges[c] = grid.x[j, 0] + grid.length[j] * basis.split_marks[c]


@compiled
def add_short_strips(tables: PairTables, grid: StripGrid, jumps: Array, basis: StripBasis, V: Array) -> bool:
    """Add to the antiderivative V (S, M + 3, 3) on short strips; jumps (S, N + 1) from `split_jumps`. False where
    distances exceed the tables.
    """
    M, N = len(basis.marks) - 1, len(basis.split_marks)
    return _add_short(tables, grid, jumps, basis, np.empty((M + 1, N, 8)), np.empty(N), V)


@borrowing
def _add_short(
    tables: PairTables, grid: StripGrid, jumps: Array, basis: StripBasis, G: Array, columns: Array, V: Array
) -> bool:
    """Do `add_short_strips`; G (M + 1, N + 1, 8) and columns (N + 1,): work space."""
    S, M = len(grid.x), len(basis.marks) - 1
    for i in range(S):
        for j in range(S):
            if i == j:
                continue
            part, _, _ = share(grid.length[i], grid.length[j], abs(grid.middle[i] - grid.middle[j]), basis)
            if part == 0.0:
                continue
            store_boundaries(grid, j, basis, columns)
            if not split_table(tables, grid.strip[i], grid.strip[j], grid.x[i, : M + 1], columns, G, None):
                return False
            for r in range(M + 1):
                total = 0.0
                for c in range(len(columns)):
                    total += G[r, c, NN] * jumps[j, c]
                V[i, r, 2] += part * total
    return True


@compiled
def add_short_strips_derivative(
    tables: PairTables, grid: StripGrid, jumps: Array, basis: StripBasis, rolls: bool, A: Array, V: Array
) -> bool:
    """As `add_short_strips`, and add the derivatives of the moments by modes and ends to the operator A (n, n)."""
    M, N, modes = len(basis.marks) - 1, len(basis.split_marks), basis.split_edges.shape[1]
    work = np.empty((M + 1, N, 8)), np.empty((M + 1, N, 8)), np.empty(N), np.empty((M + 1, modes + 4))
    return _add_short_derivative(tables, grid, jumps, basis, rolls, *work, A, V)


@borrowing
def _add_short_derivative(
    tables: PairTables,
    grid: StripGrid,
    jumps: Array,
    basis: StripBasis,
    rolls: bool,
    G: Array,
    H: Array,
    columns: Array,
    changes: Array,
    A: Array,
    V: Array,
) -> bool:
    """Do `add_short_strips_derivative`.

    Work space: G and H (M + 1, N + 1, 8), columns (N + 1,), and changes (M + 1, modes + 4) by modes and ends of the
    loaded strip and by the displaced strip's ends.
    """
    S, M, N = len(grid.x), len(basis.marks) - 1, len(basis.split_marks)
    moments, modes = len(basis.moment_edges), basis.split_edges.shape[1]
    at = 2 * M if rolls else 0
    block = at + moments
    for i in range(S):
        for j in range(S):
            if i == j:
                continue
            part, by_length, by_loaded = share(
                grid.length[i], grid.length[j], abs(grid.middle[i] - grid.middle[j]), basis
            )
            if part == 0.0:
                continue
            store_boundaries(grid, j, basis, columns)
            if not split_table(tables, grid.strip[i], grid.strip[j], grid.x[i, : M + 1], columns, G, H):
                return False
            over = 1.0 / grid.length[i]
            changes[:] = 0.0
            for r in range(M + 1):
                total, slope, by_high = 0.0, 0.0, 0.0
                for c in range(N):
                    total += G[r, c, NN] * jumps[j, c]
                    slope += H[r, c, NN] * jumps[j, c]
                    by_high += H[r, c, NN] * jumps[j, c] * basis.split_marks[c]
                    for m in range(modes):
                        changes[r, m] -= part * grid.width[j] * G[r, c, NN] * basis.split_edges[c, m]
                V[i, r, 2] += part * total
                mark = basis.row_marks[r]
                for end in range(2):
                    sign = 1.0 if end else -1.0
                    moved = by_high if end else slope - by_high
                    changes[r, modes + end] = grid.stretch[j] * (sign * by_loaded * total - part * moved)
                    own = part * slope * (mark if end else 1.0 - mark) + sign * (by_length - part * over) * total
                    changes[r, modes + 2 + end] = grid.stretch[i] * own
            for k in range(moments):
                row = i * block + at + k
                for r in range(M + 1):
                    weight = over * basis.moment_edges[k, r]
                    for m in range(modes + 2):
                        A[row, j * block + at + m] += weight * changes[r, m]
                    for end in range(2):
                        A[row, i * block + at + modes + end] += weight * changes[r, modes + 2 + end]
    return True
