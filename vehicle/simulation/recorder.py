"""Recording of accepted steps as rows of a history."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import Step
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.multibody.equations import VehicleEvaluation
from wheelrail.vehicle.simulation.row import Row, without_contacts

Observer = Callable[[float, Array, VehicleEvaluation], None]


@dataclass
class Recorder:
    """Rows at accepted steps or at equal intervals.

    Parameters:
        between: state and its evaluation at a time s within a step, from the step, the time and the state of its dense
            output, `Step.at`. Raises StepFailure.
        each: values of a function for each task, perhaps by several threads.
        every: interval s; None: at accepted steps. A contact that fails within a step has NaN forces and no patch.
        observer: called with the time s, state and evaluation of each row.
        rows: recorded so far.
        latest: time s and state at the last accepted step.
    """

    between: Callable[[Step[VehicleEvaluation], float, Array], tuple[Array, VehicleEvaluation]]
    each: Callable[[Callable[..., Any], Sequence[tuple[Any, ...]]], Iterable[Any]]
    every: float | None
    observer: Observer | None = None
    rows: list[Row] = field(default_factory=list)
    latest: tuple[float, Array] = field(init=False)

    def begin(self, time: float, state: Array, at: VehicleEvaluation) -> None:
        """Records the first row, or sets the start of a resumed run."""
        self.latest = time, state
        self.rows = self.rows or [self._row(time, state, at)]

    def add(self, step: Step[VehicleEvaluation]) -> None:
        """Records an accepted step."""
        self.rows.extend([self._end(step)] if self.every is None else self._within(step, self.every))
        self.latest = step.t, step.x

    def next_row(self, time: float) -> float:
        """Time s of the next row at equal intervals; infinite for rows at accepted steps."""
        if self.every is None:
            return np.inf
        origin = self.rows[0].time
        return origin + (int(np.floor((time - origin) / self.every * (1 + 1e-12))) + 1) * self.every

    def _within(self, step: Step[VehicleEvaluation], every: float) -> list[Row]:
        origin = self.rows[0].time
        first = int(np.floor((step.t0 - origin) / every * (1 + 1e-12))) + 1
        last = int(np.floor((step.t - origin) / every * (1 + 1e-12)))
        times = (origin + i * every for i in range(first, last + 1))
        return [self._between(step, time) if time < step.t else self._end(step) for time in times]

    def _between(self, step: Step[VehicleEvaluation], time: float) -> Row:
        """Row at a time s before the end of a step."""
        state = step.at(time)
        try:
            state, evaluation = self.between(step, time, state)
        except StepFailure as failure:
            evaluation = without_contacts(step.end, str(failure))
        return self._row(time, state, evaluation)

    def _end(self, step: Step[VehicleEvaluation]) -> Row:
        """Row at the end of a step."""
        return self._row(step.t, step.x, step.end)

    def _row(self, time: float, state: Array, at: VehicleEvaluation) -> Row:
        patches = [(result.patches,) for sides in at.contacts.values() for result in sides.values()]
        list(self.each(len, patches))  # computes them
        if self.observer is not None:
            self.observer(time, state, at)
        return Row.of(time, state, at)
