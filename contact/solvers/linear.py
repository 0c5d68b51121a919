"""Linear systems of the contact solvers: BiCGStab, and LU factors that are reused."""

from __future__ import annotations

from inspect import signature

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as sla

from wheelrail.contact.solvers.options import IterationCount, NewtonOptions
from wheelrail.support.arrays import Array, Nodes

RELATIVE = "rtol" if "rtol" in signature(sla.bicgstab).parameters else "tol"  # renamed in SciPy 1.12


def iterated(matrix: Array, right: Array, options: NewtonOptions, count: IterationCount) -> Array | None:
    """Solution of Newton's linear system by BiCGStab to the forcing term, eqs. (17) and (18); None if it does not get
    there.
    """
    steps = 0

    def tick(_: Array) -> None:
        nonlocal steps
        steps += 1

    solution, info = sla.bicgstab(matrix, right, **{RELATIVE: options.forcing}, atol=0.0, maxiter=200, callback=tick)
    count.linear += steps
    return np.asarray(solution) if info == 0 else None


def factorised(matrix: Array) -> tuple[Array, Nodes]:
    """LU factors, without the checks that cost as much as the factors of a small matrix. Raises LinAlgError."""
    lu, pivots, info = la.lapack.dgetrf(matrix, overwrite_a=1)
    if info:
        raise np.linalg.LinAlgError(f"the Jacobian of friction is singular (LAPACK's dgetrf: {info})")
    return lu, pivots
