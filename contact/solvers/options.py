"""How far an iteration may go, how far it went, and that it failed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

LinearSolver = Literal["lu", "bicgstab"]


class NotConverged(RuntimeError):
    """The tractions could not be found."""


@dataclass(frozen=True)
class NewtonOptions:
    """tolerance: residual over the norm of the friction bounds; forcing: relative residual of BiCGStab, eq. (18)."""

    tolerance: float = 1e-9
    iterations: int = 60
    linear: LinearSolver = "lu"
    forcing: float = 0.01


@dataclass
class IterationCount:
    """Newton and linear iterations, last relative residual."""

    newton: int = 0
    linear: int = 0
    residual: float = 0.0
