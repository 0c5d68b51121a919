"""Compiled: compliance between single cells, for starts, and displacements beside the loaded strips."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import StripBasis
from wheelrail.contact.models.lattice.influence.operator import THREE, VECTOR, StripGrid, look_up
from wheelrail.contact.models.lattice.influence.pair_grid import NN, ROLL, TN, TN_TURN, TT, XN, XT, XX
from wheelrail.contact.models.lattice.influence.pair_tables import PairTables
from wheelrail.contact.models.lattice.influence.short_strips import (
    SplitSpace,
    normal_table,
    shares,
    split_space,
    store_split,
)
from wheelrail.contact.models.lattice.influence.vectors import products
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled


@borrowing
def _matrix(G: Array, turn: float, K: Array) -> None:
    """Displacement (row) by force (column) K (R, C, 3, 3) from table values (R, C, 8); turned: (C, R, ..)."""
    for r in range(G.shape[0]):
        for c in range(G.shape[1]):
            g = G[r, c]
            k = K[r, c] if turn > 0.0 else K[c, r]
            k[0, 0], k[0, 1], k[0, 2] = g[XX], g[XT], turn * (g[XN] + g[ROLL])
            k[1, 0], k[1, 1], k[1, 2] = g[XT], g[TT], g[TN] + turn * g[TN_TURN]
            k[2, 0], k[2, 1], k[2, 2] = -turn * g[XN], g[TN] - turn * g[TN_TURN], g[NN]


@borrowing
def _add_cells(K: Array, width: float, place: tuple[int, int], length: float, basis: StripBasis, A: Array) -> None:
    """Slips and displacements of the cells of a strip by unit tractions on those of another, into A (3, n, 3, n).

    place: numbers of both strips; width and length m: of the loaded and of the displaced one.
    """
    M = len(basis.marks) - 1
    over = 1.0 / length
    per_slip = over**basis.slip_power
    for c in range(M):
        for r in range(M):
            m, n = place[0] * M + r, place[1] * M + c
            for b in range(3):
                first = K[r, c, 2, b] - K[r, c + 1, 2, b]
                second = K[r + 1, c, 2, b] - K[r + 1, c + 1, 2, b]
                A[2, m, b, n] = width * (second - first) * over / (basis.marks[r + 1] - basis.marks[r])
                for a in range(2):
                    total = 0.0
                    for k in range(4):
                        total += basis.slip_edges[r, k] * (K[r + k, c, a, b] - K[r + k, c + 1, a, b])
                    A[a, m, b, n] = width * per_slip * total


@compiled
def cell_operator(tables: PairTables, grid: StripGrid, basis: StripBasis, rolls: bool) -> tuple[bool, Array]:
    """Slips along and across and relative normal displacement of all n cells by unit tractions on them (along, across,
    and pressure): (3 n, 3 n), or without rolling displacement by pressure alone (n, n); rows and columns component by
    component. The flag is False where distances exceed the tables.
    """
    S, R = grid.x.shape
    n = S * (R - 3)
    A = np.zeros((3, n, 3, n))
    G, K = np.empty((R, R, 8)), np.empty((R, R, 3, 3))
    inside = True
    for i in range(S):
        for j in range(i, S):
            inside = inside and look_up(tables, grid.strip[i], grid.strip[j], grid.x[i], grid.x[j], G, None)
            _matrix(G, 1.0, K)
            _add_cells(K, grid.width[j], (i, j), grid.length[i], basis, A)
            if i != j:
                _matrix(G, -1.0, K)
                _add_cells(K, grid.width[i], (j, i), grid.length[j], basis, A)
    if rolls:
        return inside, A.copy().reshape(3 * n, 3 * n)
    return inside, np.ascontiguousarray(A[2, :, 2, :])


@compiled
def normal_displacements(
    tables: PairTables,
    strips: Nodes,
    middle: Array,
    edges: Array,
    grid: StripGrid,
    values: Array,
    jumps: Array,
    basis: StripBasis,
    rolls: bool,
) -> tuple[bool, Array]:
    """Relative normal displacement (n, C) m of cells with boundaries (n, C + 1) m on n unloaded strips.

    Parameters:
        tables: of the pairs of strips.
        strips, middle: (n,) numbers of the unloaded ones, and m.
        edges: (n, C + 1) m, by length on the surface.
        grid, values, jumps, basis: of the loaded strips.

    The flag is False where distances exceed the tables.
    """
    n, C, M = edges.shape[0], edges.shape[1] - 1, jumps.shape[1] - 1
    displacement = np.zeros((n, C))
    work = np.empty((C + 1, M + 1, 8)), np.empty((3, 8)), split_space(C + 1, basis)
    places = strips, middle, edges
    return _store_displacements(tables, places, grid, values, jumps, basis, rolls, work, displacement), displacement


@borrowing
def _store_displacements(
    tables: PairTables,
    places: tuple[Nodes, Array, Array],
    grid: StripGrid,
    values: Array,
    jumps: Array,
    basis: StripBasis,
    rolls: bool,
    work: tuple[Array, Array, SplitSpace],
    displacement: Array,
) -> bool:
    """Fill `normal_displacements`, which are zero; work: (C + 1, M + 1, 8), (3, 8) and that of C + 1 rows."""
    strips, middle, edges = places
    G, sums, split = work
    n, C = edges.shape[0], edges.shape[1] - 1
    S, M = jumps.shape[0], jumps.shape[1] - 1
    for i in range(n):
        for j in range(S):
            first, last = min(strips[i], grid.strip[j]), max(strips[i], grid.strip[j])
            turn = 1.0 if strips[i] == first else -1.0  # reciprocity: the transposed table at the opposite distance
            if not look_up(tables, first, last, edges[i], grid.x[j, : M + 1], G, None, turn):
                return False
            start, loads, out, before = G.ctypes.data, jumps[j].ctypes.data, sums.ctypes.data, 0.0
            for r in range(C + 1):
                products(start + VECTOR * r * (M + 1), VECTOR, loads, M + 1, out, VECTOR, THREE)
                total = sums[2, NN] + sums[1, TN] - turn * (sums[0, XN] + sums[1, TN_TURN])
                if r > 0:
                    displacement[i, r - 1] += (total - before) / (edges[i, r] - edges[i, r - 1])
                before = total
            count = shares(0.0, grid.length[j], abs(middle[i] - grid.middle[j]), basis, split.shares)
            if count == 0:
                continue
            N, _ = store_split(values, grid, j, basis, count, 1, rolls, split)
            if not normal_table(tables, strips[i], grid.strip[j], edges[i], split.boundaries[:N], split.G, None):
                return False
            for r in range(C + 1):
                total = 0.0
                for c in range(N):
                    total += split.G[r, c] * split.jumps[0, c]
                if r > 0:
                    displacement[i, r - 1] += (total - before) / (edges[i, r] - edges[i, r - 1])
                before = total
    return True
