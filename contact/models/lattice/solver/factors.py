"""LU factors of the Jacobian of a contact on a lattice."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import scipy.linalg as la
from numba.extending import get_cython_function_address
from numpy.typing import NDArray

from wheelrail.contact.models.lattice.influence.basis import MOMENTS
from wheelrail.contact.solvers.options import NotConverged
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import call, compiled

Integers = NDArray[np.int32]
Bytes = NDArray[np.uint8]
STRESS, LENGTH, GAP = 1e9, 1e-3, 1e-6  # Pa, m, m: scales of the unknowns and of the moments


class Factors(NamedTuple):
    """Factors of the Jacobian (n, n) of a state with values (S, block), in units of `STRESS`, `LENGTH` and `GAP`.

    Parameters:
        lu: (n, n), of the transpose, column by column.
        pivots: (n,) of LAPACK, from 1.
        rows, columns: (n,) factors from the equations' and to the unknowns' units.
        rho: (S, M) 1/Pa of the friction residual.
    """

    lu: Array
    pivots: Integers
    rows: Array
    columns: Array
    rho: Array

    @classmethod
    def of(cls, jacobian: Array, rho: Array) -> Factors:
        """Factors of a Jacobian, which is overwritten. Raises NotConverged if it is singular."""
        S = len(rho)
        block = len(jacobian) // S
        rows, columns = np.full((S, block), 1 / STRESS), np.full((S, block), STRESS)
        rows[:, block - MOMENTS :], columns[:, block - 2 :] = 1 / GAP, LENGTH
        rows, columns = rows.ravel(), columns.ravel()
        jacobian *= rows[:, None]
        jacobian *= columns
        lu, pivots, info = la.lapack.dgetrf(jacobian.T, overwrite_a=1)  # of the transpose: no copy
        if info:
            raise NotConverged("the Jacobian of the contact is singular")
        return cls(lu.T, (pivots + 1).astype(np.int32), rows, columns, rho)

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
            and n > 0
            and bool(self.pivots.min() >= 1 and self.pivots.max() <= n)
        )

    def solve(self, right: Array) -> Array:
        """Solution of the shape of the right-hand side: (S, block), or (n, k)."""
        scaled = self.rows[:, None] * right.reshape(len(self.rows), -1)
        solution, _ = la.lapack.dgetrs(self.lu.T, self.pivots - 1, scaled, trans=1)
        return np.asarray((self.columns[:, None] * solution).reshape(right.shape))


@cache
def back_substitution() -> int:
    """Address of LAPACK's dgetrs."""
    return int(get_cython_function_address("scipy.linalg.cython_lapack", "dgetrs"))


@compiled
def newton_step(factors: Factors, solver: int, residual: Array) -> Array:
    """Step (S, block) that cancels the linearised residual (S, block); solver: `back_substitution`."""
    n = len(factors.rows)
    step = np.empty(residual.shape)
    flat, values = step.ravel(), residual.ravel()
    for k in range(n):
        flat[k] = -factors.rows[k] * values[k]
    sizes = np.array([n, 1, n, n, 0], dtype=np.int32)  # n, right-hand sides, leading dimensions, flag
    _back_substitute(solver, factors.lu, factors.pivots, flat, sizes, np.array([84], dtype=np.uint8))
    for k in range(n):
        flat[k] *= factors.columns[k]
    return step


@compiled
def _back_substitute(
    solver: int, lu: Array, pivots: Integers, right: Array, sizes: Integers, transposed: Bytes
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
