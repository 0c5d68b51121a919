"""One try of a step, explicit or linearly implicit: the new state and its error, not yet judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

import numpy as np

from wheelrail.support.arrays import Array


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


class StepMethod(Protocol[E]):
    """A step of length h from x at t, where `start` was evaluated: new state, its difference to the companion, the last
    evaluation on the way. Raises StepFailure. end: the evaluation at the new state, once that is accepted.
    """

    def __call__(self, t: float, x: Array, start: E, h: float) -> tuple[Array, Array, E]: ...

    def end(self, t: float, x: Array, last: E) -> E: ...


def require_finite(*arrays: Sequence[float] | Array) -> None:
    if not all(np.isfinite(a).all() for a in arrays):
        raise StepFailure("the rates are not finite")
