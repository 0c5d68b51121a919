"""Compiled: displacement of short strips by the pressure of near, longer ones, whose cells are split for this.

Pressure that is constant in cells of length h bends the surface beside them by a staircase, which decays with the
distance d like exp(-2 pi d / h). A strip that is not much longer than the steps could lie in several places on it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import MODES, PARTS, StripBasis
from wheelrail.contact.models.lattice.influence.body_correction import START as SMOOTH_START
from wheelrail.contact.models.lattice.influence.body_correction import pair_row
from wheelrail.contact.models.lattice.influence.operator import StripGrid, table_cell
from wheelrail.contact.models.lattice.influence.pair_grid import DEGREE, NN
from wheelrail.contact.models.lattice.influence.pair_tables import PairTables
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled, fma

NEAR = 1.0, 2.0  # longest cell over the distance: up to there the steps have decayed, from there on all of it counts


@borrowing
def shares(length: float, loaded: float, distance: float, basis: StripBasis, to: Array) -> int:
    """Number of `PARTS` in which the cells of a loaded strip are split for the displacement of another one.

    Parameters:
        length, loaded: m, of the displaced and of the loaded strip.
        distance: m, between their middles.
        to: (3, len(PARTS)), written up to that number: shares from 0 to 1 of these parts in the displacement, instead
            of the fewer ones before, and their derivatives 1/m by both lengths. There is none for a strip as long as
            the loaded one, or where the cells are shorter than the distance.
    """
    ratio, cell = length / loaded, basis.longest * loaded / distance
    if ratio >= 1.0:
        return 0
    short = 1.0 - ratio**4
    for k in range(len(PARTS)):
        if cell <= NEAR[0]:
            return k
        t = min((cell - NEAR[0]) / (NEAR[1] - NEAR[0]), 1.0)
        near, by_t = t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t)
        by_ratio = -8.0 * ratio**3 * short * near
        by_cell = short * short * by_t / (NEAR[1] - NEAR[0])
        to[0, k] = short * short * near
        to[1, k] = by_ratio / loaded
        to[2, k] = (by_cell * cell - by_ratio * ratio) / loaded
        cell *= 0.5
    return len(PARTS)


@borrowing
def store_split_edges(share: Array, count: int, apart: int, basis: StripBasis, edges: Array) -> None:
    """Fill jumps (N + 1, MODES) of the loads at the boundaries of split cells, less those of whole ones.

    Parameters:
        share: (len(PARTS),), of which the first count are used.
        apart: boundaries of the finest parts, from one to the next.
    """
    for c in range(len(edges)):
        for m in range(edges.shape[1]):
            edges[c, m] = 0.0
            for k in range(count):
                edges[c, m] += share[k] * basis.split_edges[k, apart * c, m]


@borrowing
def store_split_jumps(edges: Array, pressure: Array, width: float, jumps: Array) -> None:
    """Fill jumps (N + 1,) N/m of the normal force per length for edges (N + 1, MODES), a pressure (MODES,) Pa and a
    width m.
    """
    for c in range(len(jumps)):
        jumps[c] = 0.0
        for m in range(edges.shape[1]):
            jumps[c] -= width * pressure[m] * edges[c, m]


@borrowing
def normal_table(
    tables: PairTables, displaced: int, loaded: int, rows: Array, columns: Array, G: Array, H: Array | None
) -> bool:
    """Write the component NN of `look_up`, G (R, C), and its slope H unless None, for two strips in any order.

    The component is even in x, and the same in either order.
    """
    whole = len(tables.smooth.values) == 0
    first, last = min(displaced, loaded), max(displaced, loaded)
    farthest = max(abs(rows[0] - columns[-1]), abs(rows[-1] - columns[0]))
    smooth = tables.values
    if not whole:
        far = table_cell(farthest / SMOOTH_START + 1.0)[0] + 1  # cells up to there
        smooth = tables.smooth.values[pair_row(tables.smooth, tables.place[first], tables.place[last], far)]
    pair = tables.pair[first, last]
    start, count, inverse = tables.first[pair], tables.cells[pair], tables.inverse[pair]
    for r in range(len(rows)):
        for c in range(len(columns)):
            x = rows[r] - columns[c]
            cell, u = table_cell(abs(x) * inverse + 1.0)
            if cell >= count:
                return False
            value, slope = _polynomial(tables.values[start + cell], u)
            slope *= inverse
            if not whole:
                cell, u = table_cell(abs(x) / SMOOTH_START + 1.0)
                if cell >= len(smooth):
                    return False
                deviation, change = _polynomial(smooth[cell], u)
                value += deviation
                slope += change / SMOOTH_START
            G[r, c] = value
            if H is not None:
                H[r, c] = np.copysign(1.0, x) * slope
    return True


@borrowing
def _polynomial(coefficients: Array, u: float) -> tuple[float, float]:
    """Value and slope of the component NN of coefficients (DEGREE + 1, COMPONENTS)."""
    value, slope = coefficients[DEGREE, NN], 0.0
    for k in range(DEGREE - 1, -1, -1):
        slope = fma(slope, u, value)
        value = fma(value, u, coefficients[k, NN])
    return value, slope


class SplitSpace(NamedTuple):
    """Work space for split cells.

    Parameters:
        G, H: (R, N + 1), table values of a pair and their slopes, see `normal_table`.
        boundaries: (N + 1,) m.
        shares: (3, len(PARTS)), see `shares`.
        edges: (3, N + 1, MODES), see `store_split_edges`, with their derivatives by both lengths.
        jumps: (3, N + 1) N/m, the same of the force.
    """

    G: Array
    H: Array
    boundaries: Array
    shares: Array
    edges: Array
    jumps: Array


@compiled
def split_space(rows: int, basis: StripBasis) -> SplitSpace:
    """Work space for a number of rows."""
    N = len(basis.split_marks)
    table, share = (np.empty((rows, N)), np.empty((rows, N))), np.empty((3, len(PARTS)))
    return SplitSpace(*table, np.empty(N), share, np.empty((3, N, MODES)), np.empty((3, N)))


@borrowing
def store_split(
    values: Array, grid: StripGrid, j: int, basis: StripBasis, count: int, kinds: int, rolls: bool, work: SplitSpace
) -> tuple[int, int]:
    """Fill boundaries, edges and jumps of a loaded strip, and of the first kinds of derivatives.

    Parameters:
        values: (S, block), of the loaded strips.
        count: of `PARTS`.

    Returns the number of boundaries, and how many of the finest parts lie from one to the next.
    """
    M = len(basis.marks) - 1
    N, apart, at = M * PARTS[count - 1] + 1, PARTS[-1] // PARTS[count - 1], 2 * M if rolls else 0
    for c in range(N):
        work.boundaries[c] = grid.x[j, 0] + grid.length[j] * basis.split_marks[apart * c]
    for kind in range(kinds):
        store_split_edges(work.shares[kind], count, apart, basis, work.edges[kind, :N])
        store_split_jumps(work.edges[kind, :N], values[j, at : at + MODES], grid.width[j], work.jumps[kind, :N])
    return N, apart


@compiled
def add_short_strips(
    tables: PairTables, grid: StripGrid, values: Array, basis: StripBasis, rolls: bool, V: Array
) -> bool:
    """Add to the antiderivative V (S, M + 3, 3) on short strips, by the pressure in values (S, block). False where
    distances exceed the tables.
    """
    return _add_short(tables, grid, values, basis, rolls, split_space(len(basis.marks), basis), V)


@borrowing
def _add_short(
    tables: PairTables, grid: StripGrid, values: Array, basis: StripBasis, rolls: bool, work: SplitSpace, V: Array
) -> bool:
    """Do `add_short_strips`."""
    S, M = len(grid.x), len(basis.marks) - 1
    for i in range(S):
        for j in range(S):
            if i == j:
                continue
            distance = abs(grid.middle[i] - grid.middle[j])
            count = shares(grid.length[i], grid.length[j], distance, basis, work.shares)
            if count == 0:
                continue
            N, _ = store_split(values, grid, j, basis, count, 1, rolls, work)
            rows, columns = grid.x[i, : M + 1], work.boundaries[:N]
            if not normal_table(tables, grid.strip[i], grid.strip[j], rows, columns, work.G, None):
                return False
            for r in range(M + 1):
                for c in range(N):
                    V[i, r, 2] += work.G[r, c] * work.jumps[0, c]
    return True


@compiled
def add_short_strips_derivative(
    tables: PairTables, grid: StripGrid, values: Array, basis: StripBasis, rolls: bool, A: Array, V: Array
) -> bool:
    """As `add_short_strips`, and add the derivatives of the moments by modes and ends to the operator A (n, n)."""
    work, changes = split_space(len(basis.marks), basis), np.empty((len(basis.marks), MODES + 4))
    return _add_short_derivative(tables, grid, values, basis, rolls, work, changes, A, V)


@borrowing
def _add_short_derivative(
    tables: PairTables,
    grid: StripGrid,
    values: Array,
    basis: StripBasis,
    rolls: bool,
    work: SplitSpace,
    changes: Array,
    A: Array,
    V: Array,
) -> bool:
    """Do `add_short_strips_derivative`; changes (M + 1, MODES + 4) by modes and ends of the loaded strip and by the
    displaced strip's ends: work space.
    """
    S, M, moments = len(grid.x), len(basis.marks) - 1, len(basis.moment_edges)
    at = 2 * M if rolls else 0
    block, G, H, jumps = at + moments, work.G, work.H, work.jumps
    for i in range(S):
        for j in range(S):
            if i == j:
                continue
            distance = abs(grid.middle[i] - grid.middle[j])
            count = shares(grid.length[i], grid.length[j], distance, basis, work.shares)
            if count == 0:
                continue
            N, apart = store_split(values, grid, j, basis, count, 3, rolls, work)
            rows, columns = grid.x[i, : M + 1], work.boundaries[:N]
            if not normal_table(tables, grid.strip[i], grid.strip[j], rows, columns, G, H):
                return False
            over = 1.0 / grid.length[i]
            changes[:] = 0.0
            for r in range(M + 1):
                total, by_length, by_loaded, slope, by_high = 0.0, 0.0, 0.0, 0.0, 0.0
                for c in range(N):
                    total += G[r, c] * jumps[0, c]
                    by_length += G[r, c] * jumps[1, c]
                    by_loaded += G[r, c] * jumps[2, c]
                    slope += H[r, c] * jumps[0, c]
                    by_high += H[r, c] * jumps[0, c] * basis.split_marks[apart * c]
                    for m in range(MODES):
                        changes[r, m] -= grid.width[j] * G[r, c] * work.edges[0, c, m]
                V[i, r, 2] += total
                mark = basis.row_marks[r]
                for end in range(2):
                    sign = 1.0 if end else -1.0
                    moved = by_high if end else slope - by_high
                    changes[r, MODES + end] = grid.stretch[j] * (sign * by_loaded - moved)
                    own = slope * (mark if end else 1.0 - mark) + sign * (by_length - over * total)
                    changes[r, MODES + 2 + end] = grid.stretch[i] * own
            for k in range(moments):
                row = i * block + at + k
                for r in range(M + 1):
                    weight = over * basis.moment_edges[k, r]
                    for m in range(MODES + 2):
                        A[row, j * block + at + m] += weight * changes[r, m]
                    for end in range(2):
                        A[row, i * block + at + MODES + end] += weight * changes[r, MODES + 2 + end]
    return True
