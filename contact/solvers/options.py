"""Options, iteration counts and errors of the contact solvers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

TINY = 1e-300  # keeps divisors positive
LinearSolver = Literal["lu", "bicgstab"]


class NotConverged(RuntimeError):
    """The iteration for the tractions did not converge."""


@dataclass(frozen=True)
class NewtonOptions:
    """Tolerances of the Newton iteration.

    Parameters:
        tolerance: of the residual relative to the norm of the friction bounds.
        iterations: at most.
        linear: solver of the linear systems, "lu" or "bicgstab".
        forcing: relative residual of BiCGStab, eq. (18).
    """

    tolerance: float = 1e-9
    iterations: int = 60
    linear: LinearSolver = "lu"
    forcing: float = 0.01


@dataclass
class IterationCount:
    """Number of Newton and linear iterations, and the last relative residual."""

    newton: int = 0
    linear: int = 0
    residual: float = 0.0
