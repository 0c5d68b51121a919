"""LU factors of the Jacobian of a contact on a lattice, in single precision.

With scaled unknowns and equations the Jacobian's condition is some 1e3, so that steps err by some 1e-6 of themselves.
Residuals are exact: steps converge to the same solution, and factors take half of the time and memory.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numba.extending import get_cython_function_address
from numpy.typing import NDArray

from wheelrail.contact.models.lattice.influence.basis import MOMENTS
from wheelrail.contact.models.lattice.system.equations import SLOPES, Linearisation
from wheelrail.support.arrays import Array, Single
from wheelrail.support.compiled import borrowing, call, compiled

Integers = NDArray[np.int32]
Bytes = NDArray[np.uint8]
SINGULAR = "the Jacobian of the contact is singular"
REFINEMENTS = 2  # of a solution to double precision
REFINED = 1e-6  # of the solution: largest error left
STRESS, LENGTH, GAP = 1e9, 1e-3, 1e-6  # Pa, m, m: scales of the unknowns and of the moments


class Factors(NamedTuple):
    """Factors of the Jacobian (n, n) of a state with values (S, block), in units of `STRESS`, `LENGTH` and `GAP`.

    Parameters:
        lu: (n, n), of the transpose, column by column.
        pivots: (n,) of LAPACK, from 1.
        rows, columns: (n,) factors from the equations' and to the unknowns' units.
        slips: (S, 2 M, n), derivatives of the slips by the unknowns, in the units of these.
        slopes: (S, M, SLOPES), those of the friction residual in the Jacobian.
        present: (S, M, SLOPES), those with which the factors are corrected, see
            `wheelrail.contact.models.lattice.solver.renewal`.
        spread, gather: (n, r) and (r, n), the correction: steps z become z - spread (gather z).
    """

    lu: Single
    pivots: Integers
    rows: Array
    columns: Array
    slips: Single
    slopes: Array
    present: Array
    spread: Single
    gather: Single

    @property
    def single(self) -> bool:
        """Whether they are in single precision, also where they are read from a file."""
        return self.lu.dtype == self.slips.dtype == self.spread.dtype == self.gather.dtype == np.float32

    def step(self, residual: Array) -> Array:
        """Step (S, block) that cancels the linearised residual (S, block)."""
        return newton_step(self, lapack(), residual)


class Lapack(NamedTuple):
    """Addresses of functions of LAPACK: LU factors in single precision, and solution with them."""

    sgetrf: int
    sgetrs: int


@cache
def lapack() -> Lapack:
    """Those of SciPy's library."""
    return Lapack(*(int(get_cython_function_address("scipy.linalg.cython_lapack", name)) for name in Lapack._fields))


@borrowing
def fit(factors: Factors, strips: int, cells: int, block: int) -> bool:
    """Whether factors are those of a number of strips with some cells and unknowns each, also where they are read from
    a file.
    """
    n, rank = strips * block, factors.spread.shape[1]
    for vector in (factors.rows, factors.columns):
        if len(vector) != n:
            return False
    for slopes in (factors.slopes, factors.present):
        if slopes.shape != (strips, cells, SLOPES):
            return False
    if factors.slips.shape != (strips, 2 * cells, n) or factors.lu.shape != (n, n) or len(factors.pivots) != n:
        return False
    if factors.spread.shape != (n, rank) or factors.gather.shape != (rank, n):
        return False
    valid = True
    for k in range(n):
        valid = valid and 1 <= factors.pivots[k] <= n
    return valid


@compiled
def factorised(at: Linearisation, solver: Lapack) -> tuple[bool, Factors]:
    """Factors of a Jacobian, and whether it is regular."""
    S, n = len(at.slips), len(at.jacobian)
    block = n // S
    rows, columns = np.full(n, 1 / STRESS), np.full(n, STRESS)
    for i in range(S):
        rows[(i + 1) * block - MOMENTS : (i + 1) * block] = 1 / GAP
        columns[(i + 1) * block - 2 : (i + 1) * block] = LENGTH
    lu = np.empty((n, n), dtype=np.float32)  # LAPACK sees the transpose
    for i in range(n):
        for k in range(n):
            lu[i, k] = rows[i] * at.jacobian[i, k] * columns[k]
    slips = np.empty_like(at.slips)
    for i in range(slips.shape[0]):
        for r in range(slips.shape[1]):
            for c in range(n):
                slips[i, r, c] = at.slips[i, r, c] * np.float32(columns[c])
    pivots, sizes = np.empty(n, dtype=np.int32), np.array([n, n, n, 0], dtype=np.int32)  # rows, columns, of lu, flag
    _factorise(solver.sgetrf, lu, pivots, sizes)
    spread, gather = np.zeros((n, 0), dtype=np.float32), np.zeros((0, n), dtype=np.float32)
    factors = Factors(lu, pivots, rows, columns, slips, at.slopes, at.slopes, spread, gather)
    return sizes[3] == 0, factors


@compiled
def solve_transposed(factors: Factors, solver: Lapack, jacobian: Array, right: Array) -> Array:
    """Solutions (k, n) in double precision of the transposed equations for right-hand sides (k, n), with the Jacobian
    (n, n) of factors that are not corrected.

    Iterative refinement: N. Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapter 12.
    """
    (k, n), rows, columns = right.shape, factors.rows, factors.columns
    solution, rest, before, finite = np.zeros((k, n)), right, 1.0, True
    change, sizes = np.empty((k, n), dtype=np.float32), np.array([n, k, n, n, 0], dtype=np.int32)
    of_transpose = np.array([78], dtype=np.uint8)  # whose factors these are, as LAPACK sees them
    for step in range(REFINEMENTS + 1):
        for i in range(k):
            for c in range(n):
                change[i, c] = columns[c] * rest[i, c]
        _solve(solver.sgetrs, factors.lu, factors.pivots, change, sizes, of_transpose)
        after = 0.0
        for i in range(k):
            largest, size = 0.0, 0.0
            for c in range(n):
                finite = finite and np.isfinite(change[i, c])
                solution[i, c] += rows[c] * change[i, c]
                largest = max(largest, abs(solution[i, c] / rows[c]))
                size = max(size, abs(change[i, c]))
            if largest > 0.0:
                after = max(after, size / largest)
        if finite and step > 0 and after * after <= REFINED * before:  # what is left is as much smaller as this change
            return solution
        before = after
        rest = right - np.dot(solution, jacobian)
    scaled = rows.reshape(-1, 1) * jacobian * columns  # pivots of unscaled equations lose several digits
    return rows * np.linalg.solve(scaled.T, (columns * right).T).T


@compiled
def newton_step(factors: Factors, solver: Lapack, residual: Array) -> Array:
    """Step (S, block) that cancels the linearised residual (S, block)."""
    n, rank = len(factors.rows), len(factors.gather)
    scaled, values = np.empty((1, n), dtype=np.float32), residual.ravel()
    for k in range(n):
        scaled[0, k] = -factors.rows[k] * values[k]
    back_substitute(factors, solver, scaled)
    solution = scaled[0]
    if rank:
        solution -= np.dot(factors.spread, np.dot(factors.gather, solution))
    step = np.empty(residual.shape)
    flat = step.ravel()
    for k in range(n):
        flat[k] = factors.columns[k] * solution[k]
    return step


@compiled
def back_substitute(factors: Factors, solver: Lapack, right: Single) -> None:
    """Replace right-hand sides (k, n) by the solutions with factors that are not corrected."""
    n = len(factors.rows)
    sizes = np.array([n, len(right), n, n, 0], dtype=np.int32)  # n, right-hand sides, leading dimensions, flag
    _solve(solver.sgetrs, factors.lu, factors.pivots, right, sizes, np.array([84], dtype=np.uint8))


@borrowing
def _factorise(function: int, lu: Single, pivots: Integers, sizes: Integers) -> None:
    """Factorise in place; as parameters of a function, the arrays outlive the call."""
    at = sizes.ctypes.data
    call(function, (at, at + 4, lu.ctypes.data, at + 8, pivots.ctypes.data, at + 12))


@borrowing
def _solve(function: int, lu: Single, pivots: Integers, right: Single, sizes: Integers, transposed: Bytes) -> None:
    """Solve in place; as parameters of a function, the arrays outlive the call."""
    at = sizes.ctypes.data
    call(
        function,
        (
            transposed.ctypes.data,
            at,
            at + 4,
            lu.ctypes.data,
            at + 8,
            pivots.ctypes.data,
            right.ctypes.data,
            at + 12,
            at + 16,
        ),
    )
