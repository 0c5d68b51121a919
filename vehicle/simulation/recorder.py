"""Recording of accepted steps as rows of a history."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics, Evaluation
from wheelrail.vehicle.dynamics.structure_motions import with_motions_at_rates
from wheelrail.vehicle.integration.integrate import Step
from wheelrail.vehicle.integration.problem import StepFailure

PatchPair = tuple[tuple[Patch, ...], tuple[Patch, ...]]


class Outputs(NamedTuple):
    """Outputs besides the state; see `wheelrail.vehicle.simulation.history.History`."""

    force: Array
    moment: Array
    approach: Array
    yaw_reaction: Array
    secondary_deflection: Array
    bumpstop_deflection: Array
    bumpstop_force: Array

    @classmethod
    def of(cls, dynamics: Dynamics, state: Array, at: Evaluation) -> Outputs:
        position, rate, _, _, series, _ = dynamics.split(state)
        contacts = [at.contacts[side] for side in SIDES]
        forces = dynamics.suspension.forces(position, rate, series)
        return cls(
            force=np.array([c.force for c in contacts]),
            moment=np.array([c.moment for c in contacts]),
            approach=np.array([c.approach for c in contacts]),
            yaw_reaction=np.array(at.yaw_reaction),
            secondary_deflection=np.array(forces.secondary_deflection),
            bumpstop_deflection=forces.deflection[-1, 0],
            bumpstop_force=forces.force[-1, 0],
        )


SHAPES = Outputs((2, 3), (2, 3), (2,), (), (), (), ())  # type: ignore[arg-type]


@dataclass(frozen=True)
class Row:
    time: float
    state: Array
    outputs: Outputs
    patches: PatchPair
    contact_status: tuple[str, str]

    @classmethod
    def of(cls, dynamics: Dynamics, time: float, state: Array, at: Evaluation) -> Row:
        left, right = (at.contacts[side] for side in SIDES)
        outputs = Outputs.of(dynamics, state, at)
        return cls(time, state, outputs, (tuple(left.patches), tuple(right.patches)), (left.status, right.status))


@dataclass
class Recorder:
    """Rows at accepted steps or at equal intervals.

    Parameters:
        dynamics: the equations of motion.
        every: interval s; None: at accepted steps. Within a step the state is that of its dense output, `Step.at`, and
            the contacts are solved at this state; a contact that fails there has NaN forces and no patch. Motions of
            axle and rails are those with their mean rates over the step.
        rows: recorded so far.
        latest: row at the last accepted step, if any.
    """

    dynamics: Dynamics
    every: float | None
    rows: list[Row] = field(default_factory=list)
    latest: list[Row] = field(default_factory=list)

    def begin(self, time: float, state: Array, at: Evaluation) -> None:
        """Records the first row, or sets the start of a resumed run."""
        self.latest = [Row.of(self.dynamics, time, state, at)]
        self.rows = self.rows or self.latest[:]

    def add(self, step: Step[Evaluation]) -> None:
        """Records an accepted step."""
        after = Row.of(self.dynamics, step.t, step.x, step.end)
        self.rows.extend([after] if self.every is None else self._within(step, after, self.every))
        self.latest = [after]

    def _within(self, step: Step[Evaluation], after: Row, every: float) -> list[Row]:
        origin = self.rows[0].time
        first = int(np.floor((step.t0 - origin) / every * (1 + 1e-12))) + 1
        last = int(np.floor((step.t - origin) / every * (1 + 1e-12)))
        times = (origin + i * every for i in range(first, last + 1))
        return [self._between(step, time) if time < step.t else replace(after, time=step.t) for time in times]

    def _between(self, step: Step[Evaluation], time: float) -> Row:
        """Row at a time s before the end of a step."""
        state = step.at(time)
        try:
            if self.dynamics.structure is None:
                evaluation = self.dynamics(time, state, step.end)
            else:
                rates = self.dynamics.split(step.x - step.x0).motions / (step.t - step.t0)
                state, evaluation = with_motions_at_rates(self.dynamics, time, state, rates, step.end)
        except StepFailure as failure:
            evaluation = _without_contacts(step.end, str(failure))
        return Row.of(self.dynamics, time, state, evaluation)

    def states(self) -> Array:
        return np.array([row.state for row in self.rows]).reshape(-1, self.dynamics.size)

    def outputs(self) -> Outputs:
        """Outputs of all rows, stacked along the first axis."""
        columns = zip(*(row.outputs for row in self.rows), strict=True) if self.rows else ([] for _ in SHAPES)
        return Outputs(*(np.array(c).reshape(-1, *shape) for c, shape in zip(columns, SHAPES, strict=True)))


def _without_contacts(evaluation: Evaluation, reason: str) -> Evaluation:
    """The evaluation with NaN in place of all contact forces."""
    unknown = np.full(3, np.nan)
    failed = replace(ContactResult.failed(reason, np.nan), force=unknown, moment=unknown)
    return replace(evaluation, contacts=dict.fromkeys(SIDES, failed), yaw_reaction=np.nan)
