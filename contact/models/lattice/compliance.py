"""Compiled: displacement, slip and their derivatives on strips of a lattice, from tables of pairs of strips.

With V the antiderivative along x of the displacement of strip i, a sum of the table values G times the jumps of the
traction at the cell boundaries of all strips, means over cells are differences of V, and moments of the gap and slips
are weights of V at the cell boundaries.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.extending import intrinsic

from wheelrail.contact.models.lattice.basis import StripBasis
from wheelrail.contact.models.lattice.pair_tables import PairTables
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

SHIFT = 49  # bits of a double below the three leading ones of its fraction: eight cells an octave
BIAS = 1023 << 3


class StripGrid(NamedTuple):
    """Cells of S strips.

    Parameters:
        x: (S, M + 3) m, cell boundaries and those of two more cells ahead, by length on the surface.
        length, width: (S,) m.
        stretch: (S,) length on the surface over length on the rolling circle.
    """

    x: Array
    length: Array
    width: Array
    stretch: Array


@intrinsic  # type: ignore[misc]
def _bits(context: Any, x: Any) -> Any:
    """The bits of a double as an integer."""

    def generate(_: Any, builder: Any, __: Any, arguments: Any) -> Any:
        from llvmlite import ir

        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), generate


@intrinsic  # type: ignore[misc]
def _double(context: Any, x: Any) -> Any:
    """The double with the bits of an integer."""

    def generate(_: Any, builder: Any, __: Any, arguments: Any) -> Any:
        from llvmlite import ir

        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), generate


@compiled
def look_up(tables: PairTables, pair: int, rows: Array, columns: Array, G: Array, H: Array) -> bool:
    """Write G (R, C, 9) and its slope H at the distances of boundaries rows (R,) and columns (C,) of a pair of strips.

    False where they are farther apart than the table reaches.
    """
    first, inverse = tables.first[pair], tables.inverse[pair]
    last = first + tables.count[pair]
    for r in range(len(rows)):
        for c in range(len(columns)):
            x = rows[r] - columns[c]
            z = abs(x) * inverse + 1.0
            top = _bits(z) >> SHIFT
            u = z - _double(top << SHIFT)
            cell = first + (top - BIAS)
            if cell >= last:
                return False
            v, g, h = tables.values[cell], G[r, c], H[r, c]
            sign = 1.0 if x >= 0.0 else -1.0
            for k in range(9):
                a = v[5, k]
                b = a
                a = a * u + v[4, k]
                b = b * u + a
                a = a * u + v[3, k]
                b = b * u + a
                a = a * u + v[2, k]
                b = b * u + a
                a = a * u + v[1, k]
                b = b * u + a
                g[k] = a * u + v[0, k]
                h[k] = b * inverse
            for k in range(4, 9, 4):
                h[k] *= sign
            h[0], h[5], h[7] = h[0] * sign, h[5] * sign, h[7] * sign
            g[1], g[2], g[3], g[6] = g[1] * sign, g[2] * sign, g[3] * sign, g[6] * sign
    return True


@compiled
def _transpose(G: Array, H: Array, back: Array, slope: Array) -> None:
    """Values and slopes of the pair in the other order, by reciprocity."""
    for r in range(G.shape[0]):
        for c in range(G.shape[1]):
            for a in range(3):
                for b in range(3):
                    back[c, r, 3 * b + a] = G[r, c, 3 * a + b]
                    slope[c, r, 3 * b + a] = -H[r, c, 3 * a + b]


@compiled
def _antiderivative(G: Array, jumps: Array, V: Array) -> None:
    """Add to V (R, 3) of a strip the effect of jumps (M + 1, 3) of the force per area on another one."""
    for r in range(len(V)):
        for e in range(len(jumps)):
            x, y, z = jumps[e, 0], jumps[e, 1], jumps[e, 2]
            g = G[r, e]
            V[r, 0] += g[0] * x + g[1] * y + g[2] * z
            V[r, 1] += g[3] * x + g[4] * y + g[5] * z
            V[r, 2] += g[6] * x + g[7] * y + g[8] * z


@compiled
def antiderivatives(tables: PairTables, grid: StripGrid, jumps: Array) -> tuple[bool, Array]:
    """Whether all distances lie in the tables, and V (S, M + 3, 3) by jumps (S, M + 1, 3) of the traction times width."""
    S, R = grid.x.shape
    V = np.zeros((S, R, 3))
    G, H, back, slope = np.empty((R, R, 9)), np.empty((R, R, 9)), np.empty((R, R, 9)), np.empty((R, R, 9))
    pair = -1
    for i in range(S):
        for j in range(i, S):
            pair += 1
            if not look_up(tables, pair, grid.x[i], grid.x[j], G, H):
                return False, V
            _antiderivative(G, jumps[j], V[i])
            if i != j:
                _transpose(G, H, back, slope)
                _antiderivative(back, jumps[i], V[j])
    return True, V


@compiled
def _columns(
    G: Array, H: Array, jumps: Array, grid: StripGrid, j: int, basis: StripBasis, rolls: bool, E: Array
) -> None:
    """Antiderivative E (3, R, block) by the unknowns of a loaded strip j: tractions, modes of the pressure, and ends."""
    R, M = G.shape[0], len(basis.marks) - 1
    width, at = grid.width[j], 2 * M if rolls else 0
    modes = basis.mean.shape[1]
    E[:] = 0.0
    for r in range(R):
        for c in range(M):
            for a in range(3):
                if rolls:
                    E[a, r, c] = width * (G[r, c, 3 * a] - G[r, c + 1, 3 * a])
                    E[a, r, M + c] = width * (G[r, c, 3 * a + 1] - G[r, c + 1, 3 * a + 1])
                pressed = width * (G[r, c + 1, 3 * a + 2] - G[r, c, 3 * a + 2])
                for m in range(modes):
                    E[a, r, at + m] += pressed * basis.mean[c, m]
        for e in range(M + 1):
            x, y, z = jumps[e, 0], jumps[e, 1], jumps[e, 2]
            back, ahead = grid.stretch[j] * (1.0 - basis.marks[e]), grid.stretch[j] * basis.marks[e]
            h = H[r, e]
            for a in range(3):
                change = h[3 * a] * x + h[3 * a + 1] * y + h[3 * a + 2] * z
                E[a, r, at + modes] -= back * change
                E[a, r, at + modes + 1] -= ahead * change


@compiled
def _rows(E: Array, length: float, basis: StripBasis, rolls: bool, A: Array) -> None:
    """Add to the block A of a strip: slips along and across of its cells, and moments of its gap, from E (3, R, block)."""
    M, count = len(basis.marks) - 1, E.shape[2]
    at = 2 * M if rolls else 0
    over = 1.0 / length
    for k in range(len(basis.moment_edges)):
        row = A[at + k]
        for e in range(M + 1):
            weight = over * basis.moment_edges[k, e]
            for c in range(count):
                row[c] += weight * E[2, e, c]
    if rolls:
        for a in range(2):
            for r in range(M):
                row = A[a * M + r]
                for k in range(4):
                    weight = over * over * basis.slip_edges[r, k]
                    for c in range(count):
                        row[c] += weight * E[a, r + k, c]


@compiled
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
                        total += basis.slip_edges[r, k] * (slope[r + k, a] * moved - 2.0 * V[r + k, a] * longer)
                    A[a * M + r, column] += over * over * total


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
    G, H, back, slope = np.empty((R, R, 9)), np.empty((R, R, 9)), np.empty((R, R, 9)), np.empty((R, R, 9))
    E = np.empty((3, R, block))
    pair = -1
    for i in range(S):
        for j in range(i, S):
            pair += 1
            if not look_up(tables, pair, grid.x[i], grid.x[j], G, H):
                return False, A, V
            _columns(G, H, jumps[j], grid, j, basis, rolls, E)
            _rows(E, grid.length[i], basis, rolls, A[i * block : (i + 1) * block, j * block : (j + 1) * block])
            _antiderivative(G, jumps[j], V[i])
            _antiderivative(H, jumps[j], slopes[i])
            if i != j:
                _transpose(G, H, back, slope)
                _columns(back, slope, jumps[i], grid, i, basis, rolls, E)
                _rows(E, grid.length[j], basis, rolls, A[j * block : (j + 1) * block, i * block : (i + 1) * block])
                _antiderivative(back, jumps[i], V[j])
                _antiderivative(slope, jumps[i], slopes[j])
    for i in range(S):
        own = A[i * block : (i + 1) * block, i * block : (i + 1) * block]
        _own_ends(V[i], slopes[i], grid, i, basis, rolls, own)
    return True, A, V


@compiled
def slips_and_moments(V: Array, grid: StripGrid, basis: StripBasis) -> tuple[Array, Array]:
    """Elastic slips (S, 2, M) and moments (S, MOMENTS) m of the normal displacement, from V (S, M + 3, 3)."""
    S, M = len(V), len(basis.marks) - 1
    slips, moments = np.zeros((S, 2, M)), np.zeros((S, len(basis.moment_edges)))
    for i in range(S):
        over = 1.0 / grid.length[i]
        for k in range(moments.shape[1]):
            for e in range(M + 1):
                moments[i, k] += over * basis.moment_edges[k, e] * V[i, e, 2]
        for a in range(2):
            for r in range(M):
                for k in range(4):
                    slips[i, a, r] += over * over * basis.slip_edges[r, k] * V[i, r + k, a]
    return slips, moments


@compiled
def _cell_columns(G: Array, width: float, i: int, j: int, grid: StripGrid, basis: StripBasis, A: Array) -> None:
    """Slips and displacements of the cells of strip i by unit tractions on those of strip j, into A (3, n, 3, n)."""
    M = len(basis.marks) - 1
    over = 1.0 / grid.length[i]
    for b in range(3):
        for c in range(M):
            for r in range(M):
                m, n = i * M + r, j * M + c
                first = G[r, c, 6 + b] - G[r, c + 1, 6 + b]
                second = G[r + 1, c, 6 + b] - G[r + 1, c + 1, 6 + b]
                A[2, m, b, n] = width * (second - first) * over / (basis.marks[r + 1] - basis.marks[r])
                for a in range(2):
                    total = 0.0
                    for k in range(4):
                        part = G[r + k, c, 3 * a + b] - G[r + k, c + 1, 3 * a + b]
                        total += basis.slip_edges[r, k] * part
                    A[a, m, b, n] = width * over * over * total


@compiled
def cell_operator(tables: PairTables, grid: StripGrid, basis: StripBasis, rolls: bool) -> tuple[bool, Array]:
    """Slips along and across and relative normal displacement of all n cells by unit tractions on them (along, across,
    and pressure): (3 n, 3 n), or without rolling displacement by pressure alone (n, n); rows and columns component by
    component. The flag is False where distances exceed the tables.
    """
    S, R = grid.x.shape
    n = S * (R - 3)
    A = np.zeros((3, n, 3, n))
    G, H, back, slope = np.empty((R, R, 9)), np.empty((R, R, 9)), np.empty((R, R, 9)), np.empty((R, R, 9))
    pair, inside = -1, True
    for i in range(S):
        for j in range(i, S):
            pair += 1
            inside = inside and look_up(tables, pair, grid.x[i], grid.x[j], G, H)
            _cell_columns(G, grid.width[j], i, j, grid, basis, A)
            if i != j:
                _transpose(G, H, back, slope)
                _cell_columns(back, grid.width[i], j, i, grid, basis, A)
    if rolls:
        return inside, A.copy().reshape(3 * n, 3 * n)
    return inside, np.ascontiguousarray(A[2, :, 2, :])


@compiled
def normal_displacements(
    tables: PairTables, before: Array, edges: Array, grid: StripGrid, jumps: Array
) -> tuple[bool, Array]:
    """Relative normal displacement (n, C) m of cells with boundaries (n, C + 1) m on n unloaded strips.

    Parameters:
        tables: of the pairs of unloaded and loaded strips, row by row.
        before: (pairs,) whether the unloaded strip has the lower number.
        edges: (n, C + 1) m, by length on the surface.
        grid, jumps: of the loaded strips.

    The flag is False where distances exceed the tables.
    """
    n, C = edges.shape[0], edges.shape[1] - 1
    S, M = jumps.shape[0], jumps.shape[1] - 1
    displacement = np.zeros((n, C))
    G, H = np.empty((C + 1, M + 1, 9)), np.empty((C + 1, M + 1, 9))
    pair = -1
    for i in range(n):
        for j in range(S):
            pair += 1
            ahead = before[pair]
            sign = 1.0 if ahead else -1.0  # reciprocity: the transposed table at the opposite distance
            if not look_up(tables, pair, sign * edges[i], sign * grid.x[j, : M + 1], G, H):
                return False, displacement
            step = 1 if ahead else 3
            start = 6 if ahead else 2
            last = 0.0
            for r in range(C + 1):
                total = 0.0
                for e in range(M + 1):
                    for b in range(3):
                        total += G[r, e, start + step * b] * jumps[j, e, b]
                if r > 0:
                    displacement[i, r - 1] += (total - last) / (edges[i, r] - edges[i, r - 1])
                last = total
    return True, displacement
