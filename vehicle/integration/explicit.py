"""Embedded explicit Runge-Kutta pairs with the FSAL property (last stage = first stage of the next step)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Generic

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Damping, E, RightHandSide, require_finite
from wheelrail.vehicle.integration.step_control import StepStatistics


@dataclass(frozen=True)
class Tableau:
    """Coefficients of an embedded pair of s stages.

    Parameters:
        name: of the method.
        order, error_order: of the solution and of the embedded companion.
        rows: weights of stages 2 to s; the last row is the solution.
        error: (s,) weights of solution minus companion.

    Raises ValueError unless the weights of the solution sum to one and those of the error to zero.
    """

    name: str
    order: int
    error_order: int
    rows: tuple[tuple[float, ...], ...]
    error: tuple[float, ...]

    def __post_init__(self) -> None:
        if [len(row) for row in self.rows] != list(range(1, self.stages)):
            raise ValueError(f"{self.name}: rows must have 1 to {self.stages - 1} weights")
        if abs(sum(self.rows[-1]) - 1.0) > 1e-12 or abs(sum(self.error)) > 1e-12:
            raise ValueError(f"{self.name}: the weights of the solution must sum to 1, those of the error to 0")

    @property
    def stages(self) -> int:
        return len(self.error)

    @cached_property
    def nodes(self) -> tuple[float, ...]:
        """Times of stages 2 to s within the step."""
        return tuple(sum(row) for row in self.rows)


# P. Bogacki, L. F. Shampine, Applied Mathematics Letters 2 (1989) 321-325, DOI 10.1016/0893-9659(89)90079-7
ODE23 = Tableau(
    name="ode23",
    order=3,
    error_order=2,
    rows=((1 / 2,), (0.0, 3 / 4), (2 / 9, 1 / 3, 4 / 9)),
    error=(-5 / 72, 1 / 12, 1 / 9, -1 / 8),
)


# J. R. Dormand, P. J. Prince, J. Computational and Applied Mathematics 6 (1980) 19-26, DOI 10.1016/0771-050X(80)90013-3
ODE45 = Tableau(
    name="ode45",
    order=5,
    error_order=4,
    rows=(
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
        (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    ),
    error=(71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40),
)


METHODS = {t.name: t for t in (ODE23, ODE45)}


@dataclass(frozen=True)
class ExplicitRungeKutta(Generic[E]):
    """`StepMethod` of an explicit pair; the last stage is evaluated at the new state.

    Parameters:
        rhs: right-hand side.
        tableau: coefficients.
        counts: statistics to which evaluations are added.
    """

    rhs: RightHandSide[E]
    tableau: Tableau
    counts: StepStatistics

    def __call__(self, t: float, x: Array, start: E, h: float) -> tuple[Array, Array, E]:
        rates, new, evaluation = [start.rate], x, start
        for row, node in zip(self.tableau.rows, self.tableau.nodes, strict=True):
            new = x + h * np.dot(row, rates)
            self.counts.evaluations += 1
            evaluation = self.rhs(t + node * h, new, evaluation)
            rates.append(evaluation.rate)
        difference = h * np.dot(self.tableau.error, rates)
        require_finite(new, difference)
        return new, difference, evaluation

    def end(self, t: float, x: Array, last: E) -> tuple[E, Array | None]:
        return last, None

    @property
    def outputs(self) -> Array | None:
        return None

    @property
    def damping(self) -> Damping | None:
        return None
