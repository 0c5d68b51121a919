"""LU factors of the Jacobian of a contact on a lattice, in single precision.

With scaled unknowns and equations the Jacobian's condition is some 1e3, so that steps err by some 1e-6 of themselves.
Residuals are exact: steps converge to the same solution, and factors take half of the time and memory.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import scipy.linalg as la
from numba.extending import get_cython_function_address
from numpy.typing import NDArray

from wheelrail.contact.models.lattice.influence.basis import MOMENTS
from wheelrail.contact.models.lattice.system.problem import Linearisation
from wheelrail.contact.solvers.options import NotConverged
from wheelrail.support.arrays import Array, Single
from wheelrail.support.compiled import call, compiled, inner

Integers = NDArray[np.int32]
Bytes = NDArray[np.uint8]
REFINEMENTS = 2  # of a solution to double precision
REFINED = 1e-6  # of the solution: largest second correction
STRESS, LENGTH, GAP = 1e9, 1e-3, 1e-6  # Pa, m, m: scales of the unknowns and of the moments


class Factors(NamedTuple):
    """Factors of the Jacobian (n, n) of a state with values (S, block), in units of `STRESS`, `LENGTH` and `GAP`.

    Parameters:
        lu: (n, n), of the transpose, column by column.
        pivots: (n,) of LAPACK, from 1.
        rows, columns: (n,) factors from the equations' and to the unknowns' units.
        rho: (S, M) 1/Pa of the friction residual.
        slips: (S, 2 M, n), derivatives of the slips by the unknowns, in the units of these.
        slopes: (S, M, 12), those of the friction residual in the Jacobian.
        present: (S, M, 12), those with which the factors are corrected, see
            `wheelrail.contact.models.lattice.solver.renewal`.
        spread, gather: (n, r) and (r, n), the correction: steps z become z - spread (gather z).
    """

    lu: Single
    pivots: Integers
    rows: Array
    columns: Array
    rho: Array
    slips: Single
    slopes: Array
    present: Array
    spread: Single
    gather: Single

    @classmethod
    def of(cls, linearisation: Linearisation) -> Factors:
        """Factors of a Jacobian. Raises NotConverged if it is singular."""
        jacobian, rho, slopes = linearisation.jacobian, linearisation.rho, linearisation.slopes
        S, n = len(rho), len(jacobian)
        block = n // S
        rows, columns = np.full((S, block), 1 / STRESS), np.full((S, block), STRESS)
        rows[:, block - MOMENTS :], columns[:, block - 2 :] = 1 / GAP, LENGTH
        rows, columns = rows.ravel(), columns.ravel()
        # of the transpose: no copy
        lu, pivots, info = la.lapack.sgetrf(_scaled(jacobian, rows, columns).T, overwrite_a=1)
        if info:
            raise NotConverged("the Jacobian of the contact is singular")
        slips = linearisation.slips * columns.astype(np.float32)
        none = np.zeros((n, 0), dtype=np.float32), np.zeros((0, n), dtype=np.float32)
        return cls(lu.T, (pivots + 1).astype(np.int32), rows, columns, rho, slips, slopes, slopes, *none)

    def fit(self, values: Array, block: int, cells: int) -> bool:
        """Whether they are those of a state with values (S, block) of strips with cells, also where they are read from
        a file.
        """
        n = len(values) * block
        vectors = (self.pivots, self.rows, self.columns)
        return (
            values.shape == (len(values), block)
            and self.lu.shape == (n, n)
            and all(vector.shape == (n,) for vector in vectors)
            and self.rho.shape == (len(values), cells)
            and self.slopes.shape == self.present.shape == (len(values), (block - MOMENTS) // 2, 12)
            and self.slips.shape == (len(values), block - MOMENTS, n)
            and self.spread.shape == self.gather.T.shape == (n, self.spread.shape[1])
            and all(part.dtype == np.float32 for part in (self.lu, self.slips, self.spread, self.gather))
            and n > 0
            and bool(self.pivots.min() >= 1 and self.pivots.max() <= n)
        )

    def step(self, residual: Array) -> Array:
        """Step (S, block) that cancels the linearised residual (S, block)."""
        return newton_step(self, back_substitution(), residual)

    def solve(self, jacobian: Array, right: Array) -> Array:
        """Solution (n, k) in double precision for right-hand sides (n, k), with the Jacobian (n, n) of these factors,
        which are not corrected.

        Iterative refinement: N. Higham, Accuracy and Stability of Numerical Algorithms, 2002, chapter 12.
        """
        solution = self._solution(right)
        for _ in range(REFINEMENTS):
            change = self._solution(right - jacobian @ solution)
            solution += change
        if (np.abs(change).max(axis=0) <= REFINED * np.abs(solution).max(axis=0)).all():
            return solution
        return np.linalg.solve(jacobian, right)

    def _solution(self, right: Array) -> Array:
        """Solution (n, k) in single precision."""
        scaled = (self.rows[:, None] * right).astype(np.float32)
        solution, _ = la.lapack.sgetrs(self.lu.T, self.pivots - 1, scaled, trans=1, overwrite_b=1)
        return np.asarray(self.columns[:, None] * solution)


@compiled
def _scaled(jacobian: Array, rows: Array, columns: Array) -> Single:
    """The Jacobian (n, n) in the units of `Factors`."""
    n = len(jacobian)
    scaled = np.empty((n, n), dtype=np.float32)
    for i in range(n):
        for k in range(n):
            scaled[i, k] = rows[i] * jacobian[i, k] * columns[k]
    return scaled


@cache
def back_substitution() -> int:
    """Address of LAPACK's sgetrs."""
    return int(get_cython_function_address("scipy.linalg.cython_lapack", "sgetrs"))


@compiled
def newton_step(factors: Factors, solver: int, residual: Array) -> Array:
    """Step (S, block) that cancels the linearised residual (S, block); solver: `back_substitution`."""
    n, rank = len(factors.rows), len(factors.gather)
    scaled, values = np.empty(n, dtype=np.float32), residual.ravel()
    for k in range(n):
        scaled[k] = -factors.rows[k] * values[k]
    sizes = np.array([n, 1, n, n, 0], dtype=np.int32)  # n, right-hand sides, leading dimensions, flag
    _back_substitute(solver, factors.lu, factors.pivots, scaled, sizes, np.array([84], dtype=np.uint8))
    if rank:
        scaled -= np.dot(factors.spread, np.dot(factors.gather, scaled))
    step = np.empty(residual.shape)
    flat = step.ravel()
    for k in range(n):
        flat[k] = factors.columns[k] * scaled[k]
    return step


@inner
def _back_substitute(
    solver: int, lu: Single, pivots: Integers, right: Single, sizes: Integers, transposed: Bytes
) -> None:
    """Solve in place; as parameters of a function, the arrays outlive the call."""
    at = sizes.ctypes.data
    call(
        solver,
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
