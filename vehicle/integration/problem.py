"""Interfaces of initial value problems and of single trial steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np

from wheelrail.support.arrays import Array


class StepFailure(RuntimeError):
    """The right-hand side cannot be evaluated here; a smaller step may avoid it."""


class HasRate(Protocol):
    @property
    def rate(self) -> Array: ...


class HasDerivatives(Protocol):
    """Derivatives of the rate by state (n, n) and time (n,), exact or approximate, and of outputs under error control
    (o, n), such as forces; None: no outputs.
    """

    @property
    def by_state(self) -> Array: ...

    @property
    def by_time(self) -> Array: ...

    @property
    def exact(self) -> bool: ...

    @property
    def outputs(self) -> Array | None: ...


E = TypeVar("E", bound=HasRate)


RightHandSide = Callable[[float, Array, E | None], E]


Linearise = Callable[[float, Array, E], HasDerivatives]


Forcing = Callable[[float], Array]  # motion near the solution, and its first two derivatives by time: (3, n)


Instant = tuple[float, Array]  # time s and state (n,)


Damping = Callable[[Array], Array]  # a change (n,) within a step without its stiff parts


# The forcing of a step, by its start in time and state and the evaluation there.
Follow = Callable[[float, Array, E], Forcing]


# Longest step s, up to a given one, by its start in time and state and the evaluation there.
LongestStep = Callable[[float, Array, E, float], float]


# State at the end of a step with internal variables that move at ends of steps only, and the errors that the step has
# because they did not move within it, (n,) each; by time and state at the start, and at the end.
Settle = Callable[[float, Array, float, Array], tuple[Array, Array]]


class EndSolution(Protocol[E]):
    """A right-hand side that was solved at an end of a step: from there on to first order.

    at: the same at another state, by its evaluation. missed: rates (2, n) that an evaluation within the step, at a
    share of its length, lacks by the solutions at both ends: by values and slopes, and without the slope at the end.
    """

    def __call__(self, time: float, state: Array, previous: E | None) -> E: ...

    def at(self, state: Array, there: E) -> EndSolution[E]: ...

    def missed(self, time: float, state: Array, within: E, share: float, end: Any) -> Array: ...


# Solution at the start of a step, by the state, the evaluation and the linearisation there; None: there is none.
Ends = Callable[[Array, E, HasDerivatives], EndSolution[E] | None]


class StepMethod(Protocol[E]):
    """Trial step of length h from x at t, with the evaluation `start` there: new state, its errors, (n,) or (k, n), and
    the evaluation of the last stage. Raises StepFailure.

    end: evaluation at the new state, and the error of the linearisation that it shows; None: no such error.
    outputs: derivatives (o, n), see `HasDerivatives`, at the start of the latest trial.
    damping: of stiff parts, with the matrix of the latest trial; None: of explicit methods.
    """

    def __call__(self, t: float, x: Array, start: E, h: float) -> tuple[Array, Array, E]: ...

    def end(self, t: float, x: Array, last: E) -> tuple[E, Array | None]: ...

    @property
    def outputs(self) -> Array | None: ...

    @property
    def damping(self) -> Damping | None: ...


def require_finite(*arrays: Sequence[float] | Array) -> None:
    """Raises StepFailure unless all values are finite."""
    if not all(np.isfinite(a).all() for a in arrays):
        raise StepFailure("the rates are not finite")
