"""Rows of the history of a wagon: state, contact forces and patches at one time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics, Evaluation
from wheelrail.vehicle.simulation.recorder import is_array, missing_contact

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

    @classmethod
    def stacked(cls, rows: list[Outputs]) -> Outputs:
        """Outputs of n rows along a first axis."""
        columns: Any = zip(*rows, strict=True) if rows else ([] for _ in SHAPES)
        return cls(*(np.array(c).reshape(-1, *shape) for c, shape in zip(columns, SHAPES, strict=True)))


SHAPES = Outputs((2, 3), (2, 3), (2,), (), (), (), ())  # type: ignore[arg-type]


@dataclass(frozen=True)
class Row:
    """A row of a history, see `wheelrail.vehicle.simulation.history.History`."""

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

    def is_valid(self, shape: tuple[int, ...]) -> bool:
        """Whether the values, of any type when they are read from a file, are those of a run; shape: of a state."""
        return (
            is_array(self.state, shape)
            and isinstance(self.outputs, Outputs)
            and all(map(is_array, self.outputs, SHAPES))
        )


def without_contacts(evaluation: Evaluation, reason: str) -> Evaluation:
    """The evaluation with NaN in place of all contact forces."""
    return replace(evaluation, contacts=dict.fromkeys(SIDES, missing_contact(reason)), yaw_reaction=np.nan)
