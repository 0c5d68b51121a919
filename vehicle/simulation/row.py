"""Rows of the history of a run: state, contact forces and patches at one time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.results.packed_patches import WIDTH, PackedPatches
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.equations import VehicleEvaluation

PatchPair = tuple[PackedPatches, PackedPatches]


@dataclass(frozen=True)
class Row:
    """A row of a history of w wheelsets, see `wheelrail.vehicle.simulation.history.History`."""

    time: float
    state: Array
    force: Array
    moment: Array
    approach: Array
    patches: tuple[PatchPair, ...]
    contact_status: tuple[tuple[str, str], ...]

    @classmethod
    def of(cls, time: float, state: Array, at: VehicleEvaluation) -> Row:
        wheels = [[sides[side] for side in SIDES] for sides in at.contacts.values()]
        return cls(
            time,
            state,
            force=np.array([[wheel.force for wheel in pair] for pair in wheels]),
            moment=np.array([[wheel.moment for wheel in pair] for pair in wheels]),
            approach=np.array([[wheel.approach for wheel in pair] for pair in wheels]),
            patches=tuple((PackedPatches.of(left.patches), PackedPatches.of(right.patches)) for left, right in wheels),
            contact_status=tuple((left.status, right.status) for left, right in wheels),
        )

    def is_valid(self, shape: tuple[int, ...]) -> bool:
        """Whether the values, of any type when read from a file, form a row of a run; shape: of a state."""
        count = np.shape(self.force)[:1]
        return (
            is_array(self.state, shape)
            and all(is_array(values, (*count, 2, 3)) for values in (self.force, self.moment))
            and is_array(self.approach, (*count, 2))
            and isinstance(self.patches, tuple)
            and all(isinstance(pair, tuple) and all(map(_are_patches, pair)) for pair in self.patches)
        )


def _are_patches(value: Any) -> bool:
    return isinstance(value, PackedPatches) and is_array(value.values, (*np.shape(value.values)[:1], WIDTH))


def without_contacts(evaluation: VehicleEvaluation, reason: str) -> VehicleEvaluation:
    """The evaluation with NaN in place of all contact forces."""
    unknown = np.full(3, np.nan)
    missing = replace(ContactResult.failed(reason), force=unknown, moment=unknown)
    return replace(evaluation, contacts=dict.fromkeys(evaluation.contacts, dict.fromkeys(SIDES, missing)))


def is_array(value: Any, shape: Any) -> bool:
    """Whether a value is an array (for shape (), also a number) of double precision."""
    return isinstance(value, np.ndarray | np.float64) and value.dtype == np.float64 and value.shape == shape
