"""Preconditioners of PETSc from the elastic stiffness (19), on one process and on several."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from petsc4py import PETSc

from wheelrail.contact.models.full.discrete_problem import DiscreteProblem
from wheelrail.forms import compat
from wheelrail.support.arrays import Array
from wheelrail.support.mpi import Ranks

Preconditioner = Literal["corrected", "cholesky", "icc", "gamg"]


PREFIX = "wheelrail_"


def choose(pc: Any, kind: Preconditioner, ranks: Ranks) -> None:
    """Set the type of a preconditioner with a matrix.

    Parameters:
        pc: PETSc's preconditioner.
        kind: "cholesky", the complete factor by CHOLMOD, on several ranks by MUMPS; "corrected", the default, the same
            corrected for the contact's tangent, see `ContactPreconditioner`; "icc", the incomplete factor, on several
            ranks of each rank's block; "gamg", algebraic multigrid: more iterations, but memory and time are nearly
            proportional to the size of the mesh.
        ranks: processes of the solve.
    """
    several = ranks.size > 1
    if kind == "icc" and several:
        pc.setOptionsPrefix(PREFIX)
        PETSc.Options(PREFIX)["sub_pc_type"] = "icc"
        pc.setType("bjacobi")
        pc.setFromOptions()
    elif kind == "cholesky":
        pc.setType("cholesky")
        pc.setFactorSolverType("mumps" if several else "cholmod")
    else:
        pc.setType(kind)
        if kind == "gamg":
            pc.setFromOptions()  # sets PETSc's defaults of multigrid


class ContactPreconditioner:
    """Cholesky factor of the elastic stiffness, corrected for the contact's tangent: the inverse of K - B^T D G.

    (K - B^T T)^-1 = (1 + Z (1 - T Z)^-1 T) K^-1 with T = D G and Z = K^-1 B^T, the response to unit forces at the
    contact points. Z is computed once per pose for all right-hand sides together, faster than the memory-bound single
    solves of BiCGStab. With more than `MOST` numbers in Z on a rank only K^-1 is applied.
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

    def prepare(self, problem: DiscreteProblem) -> None:
        """Compute the responses Z of a pose, unless stored."""
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
        """Set the tangent T = D G of a Newton step."""
        if self._response is not None:
            self._tangent = tangent
            self._small = la.lu_factor(np.eye(tangent.shape[0]) - self._ranks.all_reduce(tangent @ self._response))

    def apply(self, _: Any, x: Any, y: Any) -> None:
        """y = P^-1 x, called by PETSc."""
        self._pc.apply(x, y)
        if self._tangent is not None and self._response is not None:
            y.array[:] += self._response @ la.lu_solve(self._small, self._ranks.all_reduce(self._tangent @ y.array_r))
