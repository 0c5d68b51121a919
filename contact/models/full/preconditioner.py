"""Preconditioners of PETSc from the elastic stiffness (19), on one process and on several."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import scipy.linalg as la
from petsc4py import PETSc

from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.elasticity.solid_compliance import compliance_of
from wheelrail.contact.models.full.discrete_problem import DiscreteProblem, Linearisation
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
        compat.set_cholesky(pc)
    else:
        pc.setType(kind)
        if kind == "gamg":
            pc.setFromOptions()  # sets PETSc's defaults of multigrid


class ContactPreconditioner:
    """Cholesky factors of both bodies, corrected for the contact's tangent: the inverse of J = K - B^T D G.

    J^-1 x = K^-1 (x + B^T w),  (1 - D C) w = D G K^-1 x,  C = G K^-1 B^T

    C is condensed from the compliance of the bodies' surfaces, which is computed where the contact reaches for the
    first time and stored, for all poses; so are the factors. For the right-hand side, x = F(U) = K U - B^T T, the
    response G K^-1 x = G U - C T is known: one product with K^-1, two for another x. One below the tolerance of the
    linear solve, the remainder of the first half of an iteration of BiCGStab, is only scaled; its flexible variant
    allows that.

    Parameters:
        bodies: wheel and rail.
        tolerance: relative, of the linear solves.
    """

    NEGLIGIBLE = 0.1  # of the tolerance: leaves a margin for the update by the second half of an iteration

    def __init__(self, bodies: tuple[ElasticBody, ElasticBody], tolerance: float) -> None:
        self._bodies, self._tolerance = bodies, tolerance
        self.compliances = compliance_of(bodies[0]), compliance_of(bodies[1])
        self.solves = 0  # products with K^-1 of both bodies
        self._scale = 1.0 / max(float(body.stiffness.getDiagonal().norm(PETSc.NormType.INFINITY)) for body in bodies)
        self._problem: DiscreteProblem | None = None
        self._tangent: Array = np.empty(0)
        self._right: Array = np.empty(0)
        self._response: Array = np.empty(0)
        self._small: Any = None
        for body in bodies:
            _ = body.factor

    def correct(self, problem: DiscreteProblem, at: Linearisation, residual: Array) -> None:
        """Linearise about displacements.

        Parameters:
            problem: of one pose.
            at: contact and its tangent at the displacements.
            residual: F N, on the unknowns of this rank: the right-hand side of the linear solve.
        """
        assert problem.compliance is not None
        self._problem, self._tangent, self._right = problem, at.tangent, residual
        self._response = (at.z - problem.constant.reshape(at.z.shape[::-1]).T).T.ravel()
        self._response -= problem.compliance @ at.forces.T.ravel()
        self._negligible = self.NEGLIGIBLE * self._tolerance * problem.ranks.norm(residual)
        self._small = la.lu_factor(problem.reduced(at.tangent), overwrite_a=True, check_finite=False)

    def apply(self, _: Any, x: Any, y: Any) -> None:
        """y = P^-1 x, called by PETSc."""
        problem, ranks = self._problem, self._bodies[0].ranks
        assert problem is not None
        array = x.array_r
        if ranks.all_reduce(np.array(float(not np.array_equal(array, self._right)))) == 0:
            response = self._response
        elif ranks.norm(array) <= self._negligible:
            y.array[:] = self._scale * array
            return
        else:
            response = ranks.all_reduce(problem.gradient @ self.inverse(array))
        c = self._tangent.shape[1]
        forces = np.einsum("nij,jn->in", self._tangent, response.reshape(c, -1)).ravel()
        y.array[:] = self.inverse(array + problem.forces @ la.lu_solve(self._small, forces, check_finite=False))

    def inverse(self, force: Array) -> Array:
        """K^-1 of forces N on the unknowns of this rank, wheel before rail."""
        self.solves += 1
        wheel, rail = self._bodies
        end = 3 * wheel.owned
        return np.concatenate([wheel.solve(force[:end]), rail.solve(force[end:])])
