"""Recording of accepted steps as rows of a history."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import Step
from wheelrail.vehicle.integration.problem import E, StepFailure


class RunRow(Protocol):
    """A row of a history, a dataclass of plain data."""

    @property
    def time(self) -> float: ...

    @property
    def state(self) -> Array: ...

    def is_valid(self, shape: tuple[int, ...]) -> bool: ...


R = TypeVar("R", bound=RunRow)


@dataclass
class Recorder(Generic[E, R]):
    """Rows at accepted steps or at equal intervals.

    Parameters:
        between: state and its evaluation at a time s within a step, from the step, the time and the state of its dense
            output, `Step.at`. Raises StepFailure.
        row_of: row of a time s, a state and its evaluation.
        without_contacts: the evaluation with NaN in place of contact forces, for a reason.
        every: interval s; None: at accepted steps. A contact that fails within a step has NaN forces and no patch.
        rows: recorded so far.
        latest: time s and state at the last accepted step.
    """

    between: Callable[[Step[E], float, Array], tuple[Array, E]]
    row_of: Callable[[float, Array, E], R]
    without_contacts: Callable[[E, str], E]
    every: float | None
    rows: list[R] = field(default_factory=list)
    latest: tuple[float, Array] = field(init=False)

    def begin(self, time: float, state: Array, at: E) -> None:
        """Records the first row, or sets the start of a resumed run."""
        self.latest = time, state
        self.rows = self.rows or [self.row_of(time, state, at)]

    def add(self, step: Step[E]) -> None:
        """Records an accepted step."""
        self.rows.extend([self._end(step)] if self.every is None else self._within(step, self.every))
        self.latest = step.t, step.x

    def _within(self, step: Step[E], every: float) -> list[R]:
        origin = self.rows[0].time
        first = int(np.floor((step.t0 - origin) / every * (1 + 1e-12))) + 1
        last = int(np.floor((step.t - origin) / every * (1 + 1e-12)))
        times = (origin + i * every for i in range(first, last + 1))
        return [self._between(step, time) if time < step.t else self._end(step) for time in times]

    def _end(self, step: Step[E]) -> R:
        """Row at the end of a step."""
        return self.row_of(step.t, step.x, step.end)

    def _between(self, step: Step[E], time: float) -> R:
        """Row at a time s before the end of a step."""
        state = step.at(time)
        try:
            state, evaluation = self.between(step, time, state)
        except StepFailure as failure:
            evaluation = self.without_contacts(step.end, str(failure))
        return self.row_of(time, state, evaluation)


def missing_contact(reason: str) -> ContactResult:
    """A failed result with NaN forces."""
    unknown = np.full(3, np.nan)
    return replace(ContactResult.failed(reason, np.nan), force=unknown, moment=unknown)


def is_array(value: Any, shape: Any) -> bool:
    """Whether a value is an array (for shape (), also a number) of double precision."""
    return isinstance(value, np.ndarray | np.float64) and value.dtype == np.float64 and value.shape == shape
