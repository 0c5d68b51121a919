"""Linear solvers of the contact problems: BiCGStab, and LU factors for repeated use."""

from __future__ import annotations

from inspect import signature

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as sla

from wheelrail.contact.solvers.options import IterationCount, NewtonOptions
from wheelrail.support.arrays import Array, Nodes

RELATIVE = "rtol" if "rtol" in signature(sla.bicgstab).parameters else "tol"  # renamed in SciPy 1.12


def iterated(matrix: Array, right: Array, options: NewtonOptions, count: IterationCount) -> Array | None:
    """Solution of Newton's linear system by BiCGStab to the forcing term, eqs. (17) and (18); None if not converged."""
    steps = 0

    def counted(_: Array) -> None:
        nonlocal steps
        steps += 1

    solution, info = sla.bicgstab(matrix, right, **{RELATIVE: options.forcing}, atol=0.0, maxiter=200, callback=counted)
    count.linear += steps
    return np.asarray(solution) if info == 0 else None


def factorised(matrix: Array) -> tuple[Array, Nodes]:
    """LU factors of a small matrix without SciPy's checks, which cost as much as the factorisation.

    Raises LinAlgError for a singular matrix.
    """
    lu, pivots, info = la.lapack.dgetrf(matrix, overwrite_a=1)
    if info:
        raise np.linalg.LinAlgError(f"the Jacobian of the friction problem is singular (LAPACK's dgetrf: {info})")
    return lu, pivots
