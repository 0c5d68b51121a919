"""The Jacobian K - B^T D G of eq. (12) as a product with a vector."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from wheelrail.contact.models.full.discrete_problem import DiscreteProblem
from wheelrail.support.arrays import Array

Jacobian = Literal["exact", "difference"]


class JacobianOperator:
    """Product of the Jacobian with a vector: K v - B^T D G v, or by a finite difference of F, eq. (20)."""

    def __init__(self, stiffness: Any) -> None:
        self._stiffness = stiffness
        self._problem: DiscreteProblem | None = None
        self._tangent: Array | None = None
        self._u: Array = np.empty(0)
        self._base: Array = self._u

    def at(self, problem: DiscreteProblem, u: Array, tangent: Array | None) -> None:
        """Linearise about the displacements u with the tangent D (n, c, c); None: by differences."""
        self._problem, self._u, self._tangent = problem, u, tangent
        if tangent is None:
            self._base = problem.contact_forces(u)

    def mult(self, _: Any, v: Any, y: Any) -> None:
        """y = J v, called by PETSc."""
        assert self._problem is not None
        self._stiffness.mult(v, y)
        direction, ranks = v.array_r, self._problem.ranks
        if self._tangent is not None:
            y.array[:] -= self._problem.forces @ self._problem.change(self._tangent, direction).T.ravel()
            return
        length = ranks.norm(direction)
        if length > 0:
            # the elastic part is linear: only the contact forces need the difference
            eps = 1e-7 * max(ranks.norm(self._u), 1e-9) / length
            y.array[:] -= (self._problem.contact_forces(self._u + eps * direction) - self._base) / eps
