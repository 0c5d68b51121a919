"""Factors for cells that have begun to slip or to stick: a change of the Jacobian of low rank.

Most Jacobians that are no longer close enough differ in the friction of a few cells, whose rows are linear in the slips
and in the slopes of the law: J = J0 + E W, where E picks the rows of these cells, and (Sherman, Morrison, Woodbury)

J^-1 = J0^-1 - Z (1 + W Z)^-1 W J0^-1,  Z = J0^-1 E.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.influence.basis import MODES
from wheelrail.contact.models.lattice.solver.factors import Factors, Lapack, back_substitute
from wheelrail.support.arrays import Array, Nodes, Single
from wheelrail.support.compiled import compiled

CHANGED = 0.3  # of the slopes of a cell, without dimension: with smaller changes steps contract
LARGEST = 0.2  # rank over unknowns: of higher ones, new factors take less time


@compiled
def renewed(factors: Factors, slopes: Array, rho: Array, solver: Lapack) -> tuple[bool, Factors]:
    """Factors with the present slopes of the friction residual; the flag is False where those of no cell have changed
    since the latest ones, or those of too many since the Jacobian.

    Parameters:
        factors: of an earlier state of the same strips.
        slopes: (S, M, SLOPES), at the present state.
        rho: (M,) 1/Pa, of the friction residual.
        solver: LAPACK's functions.
    """
    if not len(changed_cells(factors.present, slopes, rho)):
        return False, factors
    cells = changed_cells(factors.slopes, slopes, rho)
    n, rank = len(factors.rows), 2 * len(cells)
    if rank > LARGEST * n:
        return False, factors
    change, picked = row_changes(factors, slopes, cells)
    back_substitute(factors, solver, picked)
    spread = np.ascontiguousarray(picked.T)
    small = np.dot(change, spread)
    for k in range(rank):
        small[k, k] += np.float32(1.0)
    gather = np.ascontiguousarray(np.linalg.solve(small, change))
    return True, Factors(
        factors.lu,
        factors.pivots,
        factors.rows,
        factors.columns,
        factors.slips,
        factors.slopes,
        slopes,
        spread,
        gather,
    )


@compiled
def changed_cells(before: Array, after: Array, rho: Array) -> Nodes:
    """Numbers (k,) of the cells whose slopes (S, M, SLOPES) have changed; rho (M,) 1/Pa."""
    S, M = before.shape[0], before.shape[1]
    changed = np.zeros(S * M, dtype=np.bool_)
    for i in range(S):
        for r in range(M):
            for k in range(before.shape[2]):
                if 8 <= k < 10:  # by the speed
                    continue
                size = abs(after[i, r, k] - before[i, r, k])
                changed[i * M + r] |= (size * rho[r] if 4 <= k < 8 else size) > CHANGED
    return np.flatnonzero(changed)


@compiled
def row_changes(factors: Factors, slopes: Array, cells: Nodes) -> tuple[Single, Single]:
    """Changes (2 k, n) of the rows of some cells (k,) in the units of `Factors`, and these rows of the unit matrix."""
    S, M = slopes.shape[0], slopes.shape[1]
    n = len(factors.rows)
    block = n // S
    change = np.zeros((2 * len(cells), n), dtype=np.float32)
    picked = np.zeros((2 * len(cells), n), dtype=np.float32)
    for k in range(len(cells)):
        i, r = cells[k] // M, cells[k] % M
        x = i * block + r
        y = x + M
        along, across = factors.slips[i, r], factors.slips[i, M + r]
        for a in range(2):
            row, d = change[2 * k + a], slopes[i, r] - factors.slopes[i, r]
            scale = factors.rows[x]
            first, second = np.float32(scale * d[4 + 2 * a]), np.float32(scale * d[5 + 2 * a])
            for c in range(n):
                row[c] = first * along[c] + second * across[c]
            row[x] += scale * d[2 * a] * factors.columns[x]
            row[y] += scale * d[2 * a + 1] * factors.columns[y]
            for m in range(MODES):
                column = i * block + 2 * M + m
                row[column] += scale * d[10 + 2 * m + a] * factors.columns[column]
            picked[2 * k + a, x + a * M] = 1.0
    return change, picked
