"""The Jacobian K - B^T D G of eq. (12) as a product with a vector, and its preconditioners' correction."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from petsc4py import PETSc

from contact.full_problem import Problem
from contact.pose import Array
from contact.preconditioner import choose
from contact.ranks import Ranks
from forms import compat

Jacobian = Literal["exact", "difference"]


class Product:
    """Product of the Jacobian with a vector: exact, K v - B^T D G v, or by a finite difference of F, eq. (20)."""

    def __init__(self, stiffness: Any) -> None:
        self._stiffness = stiffness
        self._problem: Problem | None = None
        self._tangent: sp.csr_array | None = None
        self._u: Array = np.empty(0)
        self._base: Array = self._u

    def at(self, problem: Problem, u: Array, kind: Jacobian) -> None:
        """Linearise about the displacements u."""
        self._problem, self._u = problem, u
        self._tangent = problem.tangent(u) if kind == "exact" else None
        if kind == "difference":
            self._base = problem.contact_forces(u)

    def mult(self, _: Any, v: Any, y: Any) -> None:
        """y = J v, called by PETSc."""
        assert self._problem is not None
        self._stiffness.mult(v, y)
        direction, ranks = v.array_r, self._problem.ranks
        if self._tangent is not None:
            y.array[:] -= self._problem.forces @ ranks.total(self._tangent @ direction)
            return
        length = ranks.norm(direction)
        if length > 0:
            # the elastic part is linear: only the contact forces need the difference
            eps = 1e-7 * max(ranks.norm(self._u), 1e-9) / length
            y.array[:] -= (self._problem.contact_forces(self._u + eps * direction) - self._base) / eps


class Corrected:
    """Cholesky factor of the elastic stiffness, corrected for the contact's tangent: the inverse of K - B^T D G.

    (K - B^T T)^-1 = (1 + Z (1 - T Z)^-1 T) K^-1 with T = D G and Z = K^-1 B^T, the response to unit forces at the
    contact points: found once a pose, all right-hand sides together, while BiCGStab's come one by one and are bound by
    memory. Beyond `MOST` numbers in Z on a rank only K^-1 is left.
    """

    MOST = 1.5e8

    def __init__(self, stiffness: Any, ranks: Ranks) -> None:
        pc = PETSc.PC().create(ranks.comm)
        pc.setOperators(stiffness)
        choose(pc, "cholesky", ranks)
        pc.setUp()
        compat.freed_with(self, pc)
        self._pc, self._ranks, self._rows = pc, ranks, stiffness.getSizes()[0]
        self._forces: sp.csr_array | None = None
        self._response: Array | None = None
        self._tangent: sp.csr_array | None = None
        self._small: Any = None

    def prepare(self, problem: Problem) -> None:
        """Responses Z of a pose, unless they are there."""
        self._tangent = None
        if problem.forces is self._forces:
            return
        self._forces = problem.forces
        loads = problem.forces.shape[1]
        if self._rows[1] * loads > self.MOST * self._ranks.size:
            self._response = None
            return
        right = PETSc.Mat().createDense([self._rows, [None, loads]], comm=self._ranks.comm)
        right.setUp()
        right.getDenseArray()[:] = problem.forces.toarray()
        right.assemble()
        left = right.duplicate()
        self._pc.getFactorMatrix().matSolve(right, left)
        self._response = left.getDenseArray().copy()
        right.destroy()
        left.destroy()

    def correct(self, tangent: sp.csr_array) -> None:
        """Take over the tangent T = D G of a Newton step."""
        if self._response is not None:
            self._tangent = tangent
            self._small = la.lu_factor(np.eye(tangent.shape[0]) - self._ranks.total(tangent @ self._response))

    def apply(self, _: Any, x: Any, y: Any) -> None:
        """y = P^-1 x, called by PETSc."""
        self._pc.apply(x, y)
        if self._tangent is not None and self._response is not None:
            y.array[:] += self._response @ la.lu_solve(self._small, self._ranks.total(self._tangent @ y.array_r))
