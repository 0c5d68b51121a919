"""Compiled: displacement, slip and their derivatives on strips of a lattice, from tables of pairs of strips.

With V the antiderivative along x of the displacement of strip i, a sum of the table values G times the jumps of the
traction at the cell boundaries of all strips, means over cells are differences of V, and moments of the gap and slips
are weights of V at the cell boundaries.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import MODES, MOMENTS, StripBasis
from wheelrail.contact.models.lattice.influence.body_correction import START as SMOOTH_START
from wheelrail.contact.models.lattice.influence.body_correction import pair_row
from wheelrail.contact.models.lattice.influence.pair_grid import NN, ROLL, TN, TN_TURN, TT, XN, XT, XX
from wheelrail.contact.models.lattice.influence.pair_tables import PairTables
from wheelrail.contact.models.lattice.influence.vectors import (
    bits,
    double,
    polynomials,
    products,
)
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled

SHIFT = 49  # bits of a double below the three leading ones of its fraction: eight cells an octave
BIAS = 1023 << 3
VECTOR, BLOCK = 64, 384  # bytes of a vector, and of the coefficients of a table's cell
ONE, THREE, ALL_MODES, ALL_MOMENTS = (0,), (0,) * 3, (0,) * MODES, (0,) * MOMENTS  # numbers of sums of `products`


class StripGrid(NamedTuple):
    """Cells of S strips.

    Parameters:
        x: (S, M + 3) m, cell boundaries and those of two more cells ahead, by length on the surface.
        length, width: (S,) m.
        stretch: (S,) length on the surface over length on the rolling circle.
        strip: (S,) numbers on the lattice.
        middle: (S,) m, across.
    """

    x: Array
    length: Array
    width: Array
    stretch: Array
    strip: Nodes
    middle: Array


@borrowing
def table_cell(z: float) -> tuple[int, float]:
    """Cell of a table at z = 1 + |x| / start, and z less its lower bound."""
    top = bits(z) >> SHIFT
    return top - BIAS, z - double(top << SHIFT)


@borrowing
def look_up(
    tables: PairTables, i: int, j: int, rows: Array, columns: Array, G: Array, H: Array | None, turn: float = 1.0
) -> bool:
    """Write G (R, C, 8), and its slope H unless None, at the distances of boundaries rows (R,) on strip i and columns
    (C,) on j >= i, with turn = -1 at the opposite distances.

    False where they are farther apart than the table reaches.
    """
    whole = len(tables.smooth.values) == 0
    farthest = max(abs(rows[0] - columns[-1]), abs(rows[-1] - columns[0]))
    far = table_cell(farthest / SMOOTH_START + 1.0)[0] + 1  # cells up to there
    row = 0 if whole else pair_row(tables.smooth, tables.place[i], tables.place[j], far)
    smooth = tables.values if whole else tables.smooth.values[row]
    pair = tables.pair[i, j]
    start, last, inverse = (
        tables.values.ctypes.data + BLOCK * tables.first[pair],
        tables.cells[pair],
        tables.inverse[pair],
    )
    smooth_start, smooth_last, smooth_inverse = smooth.ctypes.data, len(smooth), 1.0 / SMOOTH_START
    to, wide = G.ctypes.data, G.shape[1]
    for r in range(len(rows)):
        for c in range(len(columns)):
            x = rows[r] - columns[c]
            sign, away = turn * np.copysign(1.0, x), abs(x)
            cell, u = table_cell(away * inverse + 1.0)
            if cell >= last:
                return False
            at = VECTOR * (r * wide + c)
            own = start + BLOCK * cell, u, inverse
            if whole:
                if H is None:
                    polynomials((own,), sign, to + at, None)
                else:
                    polynomials((own,), sign, to + at, H.ctypes.data + at)
                continue
            cell, u = table_cell(away * smooth_inverse + 1.0)
            if cell >= smooth_last:
                return False
            other = smooth_start + BLOCK * cell, u, smooth_inverse
            if H is None:
                polynomials((own, other), sign, to + at, None)
            else:
                polynomials((own, other), sign, to + at, H.ctypes.data + at)
    return True


@borrowing
def _displaced(sums: Array, turn: float) -> tuple[float, float, float]:
    """Components from sums (3, 8) of table values times loads along, across and normal.

    turn: 1, or -1 for the pair in the other order: by reciprocity the antisymmetric components change their sign.
    """
    return (
        sums[0, XX] + sums[1, XT] + turn * (sums[2, XN] + sums[2, ROLL]),
        sums[0, XT] + sums[1, TT] + sums[2, TN] + turn * sums[2, TN_TURN],
        sums[1, TN] + sums[2, NN] - turn * (sums[0, XN] + sums[1, TN_TURN]),
    )


@borrowing
def add_antiderivative(G: Array, jumps: Array, turn: float, sign: float, sums: Array, V: Array) -> None:
    """Add to V (R, 3) of a strip the effect of jumps (M + 1, 3) of the force per length on another one.

    Parameters:
        G: (R, C, 8), rows of the displaced strip; with turn = -1, of the loaded one.
        sign: factor, -1 for slopes in the other order.
        sums: (3, 8), work space.
    """
    count, start, wide = len(jumps), G.ctypes.data, G.shape[1]
    loads, out = jumps.ctypes.data, sums.ctypes.data
    for r in range(len(V)):
        if turn > 0.0:
            products(start + VECTOR * r * wide, VECTOR, loads, count, out, VECTOR, THREE)
        else:
            products(start + VECTOR * r, VECTOR * wide, loads, count, out, VECTOR, THREE)
        along, across, normal = _displaced(sums, turn)
        V[r, 0] += sign * along
        V[r, 1] += sign * across
        V[r, 2] += sign * normal


@compiled
def antiderivatives(tables: PairTables, grid: StripGrid, jumps: Array) -> tuple[bool, Array]:
    """Whether all distances lie in the tables, and V (S, M + 3, 3) by jumps (S, M + 1, 3) of traction times width."""
    S, R = grid.x.shape
    V = np.zeros((S, R, 3))
    return _store_antiderivatives(tables, grid, jumps, np.empty((R, R, 8)), np.empty((3, 8)), V), V


@borrowing
def _store_antiderivatives(tables: PairTables, grid: StripGrid, jumps: Array, G: Array, sums: Array, V: Array) -> bool:
    """Fill V of `antiderivatives`, which is zero; G (R, R, 8) and sums (3, 8): work space."""
    S = len(grid.x)
    for i in range(S):
        for j in range(i, S):
            if not look_up(tables, grid.strip[i], grid.strip[j], grid.x[i], grid.x[j], G, None):
                return False
            add_antiderivative(G, jumps[j], 1.0, 1.0, sums, V[i])
            if i != j:
                add_antiderivative(G, jumps[i], -1.0, 1.0, sums, V[j])
    return True


class WorkSpace(NamedTuple):
    """Work space of blocks.

    Parameters:
        G, H: (R, R, 8), table values of a pair and their slopes.
        edges: (MOMENTS, M + 1, 8) weighted table values at the cell boundaries of the loaded strip.
        modes: (MODES, 8) the same, weighted by the jumps of the loads of the pressure modes.
        sums: (3, 8) table values times loads along, across and normal.
        jumps: (M + 1, 3) N/m, times the change of the boundaries by one end.
        end: (R, 3) antiderivative by that end.
    """

    G: Array
    H: Array
    edges: Array
    modes: Array
    sums: Array
    jumps: Array
    end: Array


@borrowing
def _add_loads(
    G: Array, width: float, length: float, basis: StripBasis, turn: float, rolls: bool, work: WorkSpace, A: Array
) -> None:
    """Add slips and moments of a strip by tractions and pressure modes on another one.

    Parameters:
        G: (R, C, 8), rows of the displaced strip; with turn = -1, of the loaded one.
        width, length: m, of the loaded and of the displaced strip.
        A: block of the strips.
    """
    M, wide = len(basis.marks) - 1, G.shape[1]
    row, column = (VECTOR * wide, VECTOR) if turn > 0.0 else (VECTOR, VECTOR * wide)
    at, line = 2 * M if rolls else 0, VECTOR * (M + 1)
    start, edges, s = G.ctypes.data, work.edges.ctypes.data, work.modes
    loads, sums = basis.load_edges.ctypes.data, work.modes.ctypes.data
    moment, slip = basis.edge_moments.ctypes.data, basis.slip_edges.ctypes.data
    factor = width / length
    for c in range(M + 1):
        products(start + c * column, row, moment, M + 1, edges + VECTOR * c, line, ALL_MOMENTS)
    for k in range(MOMENTS):
        products(edges + k * line, VECTOR, loads, M + 1, sums, VECTOR, ALL_MODES)
        for m in range(MODES):  # pressure acts against the outward normal
            A[at + k, at + m] -= factor * s[m, NN]
        e = work.edges[k]
        for c in range(M if rolls else 0):
            A[at + k, c] -= factor * turn * (e[c, XN] - e[c + 1, XN])
            A[at + k, M + c] += factor * (e[c, TN] - e[c + 1, TN] - turn * (e[c, TN_TURN] - e[c + 1, TN_TURN]))
    if not rolls:
        return
    factor = width / length**basis.slip_power
    e = work.edges[0]
    for r in range(M):
        for c in range(M + 1):
            products(start + r * row + c * column, row, slip + 32 * r, 4, edges + VECTOR * c, VECTOR, ONE)
        products(edges, VECTOR, loads, M + 1, sums, VECTOR, ALL_MODES)
        for m in range(MODES):
            A[r, at + m] -= factor * turn * (s[m, XN] + s[m, ROLL])
            A[M + r, at + m] -= factor * (s[m, TN] + turn * s[m, TN_TURN])
        for c in range(M):
            both = factor * (e[c, XT] - e[c + 1, XT])
            A[r, c] += factor * (e[c, XX] - e[c + 1, XX])
            A[r, M + c] += both
            A[M + r, c] += both
            A[M + r, M + c] += factor * (e[c, TT] - e[c + 1, TT])


@borrowing
def _add_ends(
    H: Array,
    jumps: Array,
    stretch: float,
    length: float,
    basis: StripBasis,
    turn: float,
    rolls: bool,
    work: WorkSpace,
    A: Array,
) -> None:
    """Add slips and moments of a strip by the ends of another one, whose boundaries they move.

    Parameters:
        H: slope of G, see `_add_loads`.
        jumps: (M + 1, 3) N/m, of the loaded strip.
        stretch, length: of the loaded strip, and m of the displaced one.
        A: block of the strips.
    """
    M, moments, modes = len(basis.marks) - 1, len(basis.moment_edges), basis.mean.shape[1]
    at = 2 * M if rolls else 0
    over, per_slip = 1.0 / length, 1.0 / length**basis.slip_power
    for end in range(2):
        for c in range(M + 1):
            moved = -stretch * (basis.marks[c] if end else 1.0 - basis.marks[c])
            for k in range(3):
                work.jumps[c, k] = moved * jumps[c, k]
        work.end[:] = 0.0
        add_antiderivative(H, work.jumps, turn, turn, work.sums, work.end)
        column = at + modes + end
        for k in range(moments):
            total = 0.0
            for c in range(M + 1):
                total += basis.moment_edges[k, c] * work.end[c, 2]
            A[at + k, column] += over * total
        for r in range(M if rolls else 0):
            along, across = 0.0, 0.0
            for k in range(4):
                along += basis.slip_edges[r, k] * work.end[r + k, 0]
                across += basis.slip_edges[r, k] * work.end[r + k, 1]
            A[r, column] += per_slip * along
            A[M + r, column] += per_slip * across


@borrowing
def _own_ends(V: Array, slope: Array, grid: StripGrid, i: int, basis: StripBasis, rolls: bool, A: Array) -> None:
    """Add the derivatives by the ends of the displaced strip: boundaries move and lengths change.

    Parameters:
        V, slope: (R, 3) antiderivative, and its derivative by the places of its boundaries.
        A: block of the strip's rows and own columns.
    """
    M, stretch = len(basis.marks) - 1, grid.stretch[i]
    at = 2 * M if rolls else 0
    modes = basis.mean.shape[1]
    over = 1.0 / grid.length[i]
    per_slip = over**basis.slip_power
    for end in range(2):
        column = at + modes + end
        longer = (stretch if end else -stretch) * over
        for k in range(len(basis.moment_edges)):
            total = 0.0
            for e in range(M + 1):
                moved = stretch * (basis.row_marks[e] if end else 1.0 - basis.row_marks[e])
                total += basis.moment_edges[k, e] * (slope[e, 2] * moved - V[e, 2] * longer)
            A[at + k, column] += over * total
        if rolls:
            for a in range(2):
                for r in range(M):
                    total = 0.0
                    for k in range(4):
                        mark = basis.row_marks[r + k]
                        moved = stretch * (mark if end else 1.0 - mark)
                        change = slope[r + k, a] * moved - basis.slip_power * V[r + k, a] * longer
                        total += basis.slip_edges[r, k] * change
                    A[a * M + r, column] += per_slip * total


@compiled
def operator(
    tables: PairTables, grid: StripGrid, jumps: Array, basis: StripBasis, rolls: bool
) -> tuple[bool, Array, Array]:
    """Derivative (n, n) of slips and moments by tractions, modes and ends, and V (S, M + 3, 3).

    Rows and columns strip by strip: slips along and across by tractions along and across (if rolling), moments by modes
    and ends. The flag is False where distances exceed the tables.
    """
    S, R = grid.x.shape
    M = R - 3
    block = (2 * M if rolls else 0) + len(basis.moment_edges)
    A = np.zeros((S * block, S * block))
    V, slopes = np.zeros((S, R, 3)), np.zeros((S, R, 3))
    tables_at = np.empty((R, R, 8)), np.empty((R, R, 8))
    edges, ends = (np.empty((MOMENTS, M + 1, 8)), np.empty((MODES, 8))), (np.empty((M + 1, 3)), np.empty((R, 3)))
    work = WorkSpace(*tables_at, *edges, np.empty((3, 8)), *ends)
    inside = _store_operator(tables, grid, jumps, basis, rolls, work, A, V, slopes)
    return inside, A, V


@borrowing
def _store_operator(
    tables: PairTables,
    grid: StripGrid,
    jumps: Array,
    basis: StripBasis,
    rolls: bool,
    work: WorkSpace,
    A: Array,
    V: Array,
    slopes: Array,
) -> bool:
    """Fill A and V of `operator`, and slopes (S, M + 3, 3) of V, which are zero."""
    S = len(grid.x)
    block, G, H, sums = len(A) // S, work.G, work.H, work.sums
    for i in range(S):
        own = slice(i * block, (i + 1) * block)
        for j in range(i, S):
            if not look_up(tables, grid.strip[i], grid.strip[j], grid.x[i], grid.x[j], G, H):
                return False
            other = slice(j * block, (j + 1) * block)
            _add_loads(G, grid.width[j], grid.length[i], basis, 1.0, rolls, work, A[own, other])
            _add_ends(H, jumps[j], grid.stretch[j], grid.length[i], basis, 1.0, rolls, work, A[own, other])
            add_antiderivative(G, jumps[j], 1.0, 1.0, sums, V[i])
            add_antiderivative(H, jumps[j], 1.0, 1.0, sums, slopes[i])
            if i != j:
                _add_loads(G, grid.width[i], grid.length[j], basis, -1.0, rolls, work, A[other, own])
                _add_ends(H, jumps[i], grid.stretch[i], grid.length[j], basis, -1.0, rolls, work, A[other, own])
                add_antiderivative(G, jumps[i], -1.0, 1.0, sums, V[j])
                add_antiderivative(H, jumps[i], -1.0, -1.0, sums, slopes[j])
    for i in range(S):
        own = slice(i * block, (i + 1) * block)
        _own_ends(V[i], slopes[i], grid, i, basis, rolls, A[own, own])
    return True


@compiled
def slips_and_moments(V: Array, grid: StripGrid, basis: StripBasis) -> tuple[Array, Array]:
    """Elastic slips (S, 2, M) and moments (S, MOMENTS) m of the normal displacement, from V (S, M + 3, 3)."""
    S, M = len(V), len(basis.marks) - 1
    slips, moments = np.zeros((S, 2, M)), np.zeros((S, len(basis.moment_edges)))
    store_slips(V, grid, basis, slips, moments)
    return slips, moments


@borrowing
def store_slips(V: Array, grid: StripGrid, basis: StripBasis, slips: Array, moments: Array) -> None:
    """Fill `slips_and_moments`, which are zero."""
    S, M = len(V), len(basis.marks) - 1
    for i in range(S):
        over = 1.0 / grid.length[i]
        per_slip = over**basis.slip_power
        for k in range(moments.shape[1]):
            for e in range(M + 1):
                moments[i, k] += over * basis.moment_edges[k, e] * V[i, e, 2]
        for a in range(2):
            for r in range(M):
                for k in range(4):
                    slips[i, a, r] += per_slip * basis.slip_edges[r, k] * V[i, r + k, a]
