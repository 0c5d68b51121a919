"""Results of a run of a vehicle as arrays over time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.multibody.suspension_forces import SuspensionState
from wheelrail.vehicle.simulation.history import RunCost
from wheelrail.vehicle.simulation.recorder import is_array, missing_contact
from wheelrail.vehicle.simulation.row import PatchPair


@dataclass(frozen=True)
class VehicleRow:
    """A row of a history of w wheelsets, see `VehicleHistory`."""

    time: float
    state: Array
    force: Array
    moment: Array
    approach: Array
    patches: tuple[PatchPair, ...]
    contact_status: tuple[tuple[str, str], ...]

    @classmethod
    def of(cls, time: float, state: Array, at: VehicleEvaluation) -> VehicleRow:
        wheels = [[sides[side] for side in SIDES] for sides in at.contacts.values()]
        return cls(
            time,
            state,
            force=np.array([[wheel.force for wheel in pair] for pair in wheels]),
            moment=np.array([[wheel.moment for wheel in pair] for pair in wheels]),
            approach=np.array([[wheel.approach for wheel in pair] for pair in wheels]),
            patches=tuple((tuple(left.patches), tuple(right.patches)) for left, right in wheels),
            contact_status=tuple((left.status, right.status) for left, right in wheels),
        )

    def is_valid(self, shape: tuple[int, ...]) -> bool:
        """Whether the values, of any type when they are read from a file, are those of a run; shape: of a state."""
        count = np.shape(self.force)[:1]
        return (
            is_array(self.state, shape)
            and all(is_array(values, (*count, 2, 3)) for values in (self.force, self.moment))
            and is_array(self.approach, (*count, 2))
        )


def without_contacts(evaluation: VehicleEvaluation, reason: str) -> VehicleEvaluation:
    """The evaluation with NaN in place of all contact forces."""
    missing = dict.fromkeys(SIDES, missing_contact(reason))
    return replace(evaluation, contacts=dict.fromkeys(evaluation.contacts, missing))


@dataclass(frozen=True)
class VehicleHistory:
    """Results of a run in n rows for w wheelsets.

    Parameters:
        dynamics: equations of motion.
        status: "completed", "interrupted" or "failed: ..." with the reason.
        rows: of the run.
        cost: of the run.
    """

    dynamics: VehicleDynamics
    status: str
    rows: list[VehicleRow]
    cost: RunCost

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def time(self) -> Array:
        """(n,) s."""
        return np.array([row.time for row in self.rows])

    @cached_property
    def state(self) -> Array:
        """(n, 2 c + m), see `wheelrail.vehicle.multibody.coordinates`."""
        return np.array([row.state for row in self.rows]).reshape(-1, self.dynamics.size)

    @cached_property
    def force(self) -> Array:
        """(n, w, 2, 3) N on the left and right wheels, in the track frames of the wheelsets."""
        return np.array([row.force for row in self.rows])

    @cached_property
    def moment(self) -> Array:
        """(n, w, 2, 3) N m about the centres of the wheelsets, in the same frames."""
        return np.array([row.moment for row in self.rows])

    @cached_property
    def approach(self) -> Array:
        """(n, w, 2) m, largest penetration of the undeformed bodies."""
        return np.array([row.approach for row in self.rows])

    @cached_property
    def frictional_power(self) -> Array:
        """(n, w, 2) W."""
        powers = [
            [[sum(patch.frictional_power for patch in wheel) for wheel in pair] for pair in row.patches]
            for row in self.rows
        ]
        return np.array(powers, dtype=float)

    @property
    def distance(self) -> Array:
        """Distance of the reference motion along the track (n,), m."""
        return self._track_positions[:, 0]

    @property
    def speeds(self) -> Array:
        """Speed of the reference motion (n,), m/s."""
        return self._track_positions[:, 1]

    @cached_property
    def _track_positions(self) -> Array:
        return self.dynamics.speed_profile.positions(self.time)

    def coordinate(self, body: str, coordinate: int) -> Array:
        """Values (n,) m or rad of a coordinate of a body, see `wheelrail.vehicle.multibody.coordinates`."""
        return np.asarray(self.state[:, self.dynamics.coordinates.index(body, coordinate)])

    def suspension(self) -> list[SuspensionState]:
        """Deflections and forces of the suspension elements of each row."""
        d = self.dynamics
        return [
            d.suspension(d.kinematics(d.speed_profile(row.time), row.state), d.coordinates.split(row.state).series)
            for row in self.rows
        ]
