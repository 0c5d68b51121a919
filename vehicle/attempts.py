"""One try of a step, explicit or linearly implicit: the new state and its error, not yet judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from vehicle.control import Counts
from vehicle.rosenbrock import Rosenbrock
from vehicle.tableau import Tableau

Array = NDArray[np.float64]


class StepFailure(RuntimeError):
    """The right-hand side has no value here; a smaller step may avoid it."""


class HasRate(Protocol):
    @property
    def rate(self) -> Array: ...


class HasDerivatives(Protocol):
    """Derivatives of the rate by the state (n, n) and by time (n,), both allowed to be inexact."""

    @property
    def by_state(self) -> Array: ...

    @property
    def by_time(self) -> Array: ...


E = TypeVar("E", bound=HasRate)
RightHandSide = Callable[[float, Array, E | None], E]
Linearise = Callable[[float, Array, E], HasDerivatives]


class Attempt(Protocol[E]):
    """A step of length h from x at t, where `start` was evaluated: new state, its difference to the companion, the last
    evaluation on the way. Raises StepFailure. end: the evaluation at the new state, once that is accepted.
    """

    def __call__(self, t: float, x: Array, start: E, h: float) -> tuple[Array, Array, E]: ...

    def end(self, t: float, x: Array, last: E) -> E: ...


@dataclass(frozen=True)
class Explicit(Generic[E]):
    """Stages one after the other; the last one is evaluated at the new state."""

    rhs: RightHandSide[E]
    tableau: Tableau
    counts: Counts

    def __call__(self, t: float, x: Array, start: E, h: float) -> tuple[Array, Array, E]:
        rates, new, now = [start.rate], x, start
        for row, node in zip(self.tableau.rows, self.tableau.nodes, strict=True):
            new = x + h * np.dot(row, rates)
            self.counts.evaluations += 1
            now = self.rhs(t + node * h, new, now)
            rates.append(now.rate)
        difference = h * np.dot(self.tableau.error, rates)
        _finite(new, difference)
        return new, difference, now

    def end(self, t: float, x: Array, last: E) -> E:
        return last


@dataclass
class LinearlyImplicit(Generic[E]):
    """s solves with one factorised matrix 1/(h g) - A, in the unknowns u = h gamma k of Hairer and Wanner, Solving ODEs
    II, section IV.7. The Jacobian is kept while a step is tried again, the factors while its length stays, too.

    Raises ValueError without a jacobian.
    """

    rhs: RightHandSide[E]
    tableau: Rosenbrock
    counts: Counts
    jacobian: Linearise[E] | None
    linear: tuple[E, HasDerivatives] | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        if self.jacobian is None:
            raise ValueError(f"{self.tableau.name}: a linearly implicit method needs a jacobian")

    def __call__(self, t: float, x: Array, start: E, h: float) -> tuple[Array, Array, E]:
        method, now, unknowns = self.tableau, start, np.zeros((self.tableau.stages, len(x)))
        linear = self._linear(t, x, start)
        solve = self._factorised(linear.by_state, h)
        for i in range(method.stages):
            if i > 0:
                self.counts.evaluations += 1
                now = self.rhs(t + method.nodes[i] * h, x + method.shifts[i, :i] @ unknowns[:i], now)
            coupling = (method.inverse[i, :i] / h) @ unknowns[:i]
            unknowns[i] = solve(now.rate - coupling + h * method.sums[i] * linear.by_time)
        rise, difference = method.ends @ unknowns
        _finite(rise, difference)
        return x + rise, difference, now

    def end(self, t: float, x: Array, last: E) -> E:
        self.counts.evaluations += 1
        return self.rhs(t, x, last)

    def _linear(self, t: float, x: Array, start: E) -> HasDerivatives:
        assert self.jacobian is not None
        if self.linear is None or self.linear[0] is not start:
            self.linear = (start, self.jacobian(t, x, start))
        return self.linear[1]

    def _factorised(self, by_state: Array, h: float) -> Callable[[Array], Array]:
        from scipy.linalg import lu_factor, lu_solve

        self.counts.factorisations += 1
        factors: Any = lu_factor(np.eye(len(by_state)) / (h * self.tableau.diagonal) - by_state, check_finite=False)
        return lambda right: np.asarray(lu_solve(factors, right, check_finite=False))


def _finite(*arrays: Sequence[float] | Array) -> None:
    if not all(np.isfinite(a).all() for a in arrays):
        raise StepFailure("the rates are not finite")
