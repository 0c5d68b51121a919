"""Preconditioners of PETSc from the elastic stiffness (19), on one process and on several."""

from __future__ import annotations

from typing import Any, Literal

from petsc4py import PETSc

from contact.ranks import Ranks

Preconditioner = Literal["corrected", "cholesky", "icc", "gamg"]
PREFIX = "wheelrail_"


def choose(pc: Any, kind: Preconditioner, ranks: Ranks) -> None:
    """Set the type of a preconditioner whose matrix is known.

    "cholesky", the complete factor: by CHOLMOD, on several ranks by MUMPS; "corrected", the default, corrects the same
    for the contact's tangent, see `contact.jacobian.Corrected`. "icc", the incomplete factor, on several ranks of each
    one's own block. "gamg", algebraic multigrid: more iterations, but memory and time grow little faster than the mesh.
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
            pc.setFromOptions()  # PETSc's own defaults of multigrid come with it
