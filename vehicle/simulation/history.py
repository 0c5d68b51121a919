"""Results of a run as arrays over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import PITCH, VehicleState, X
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.contact_cost import ContactCost
from wheelrail.vehicle.simulation.row import Row


@dataclass
class RunCost:
    """Cost of a run.

    Parameters:
        steps: statistics of the integrator.
        contact: call statistics by side, including the initial equilibrium.
        seconds: wall time, including the initial equilibrium.
    """

    steps: StepStatistics = field(default_factory=StepStatistics)
    contact: dict[Side, ContactCost] = field(default_factory=dict)
    seconds: float = 0.0


@dataclass(frozen=True)
class History:
    """Results of a run in n rows for w wheelsets.

    Parameters:
        dynamics: equations of motion.
        status: "completed", "interrupted" or "failed: ..." with the reason.
        rows: of the run.
        cost: of the run.
    """

    dynamics: VehicleDynamics
    status: str
    rows: list[Row]
    cost: RunCost

    def __len__(self) -> int:
        return len(self.rows)

    @cached_property
    def time(self) -> Array:
        """(n,) s."""
        return np.array([row.time for row in self.rows])

    @cached_property
    def state(self) -> Array:
        """(n, 2 c + m + k), see `wheelrail.vehicle.multibody.coordinates`."""
        return np.array([row.state for row in self.rows]).reshape(-1, self.dynamics.size)

    @cached_property
    def force(self) -> Array:
        """(n, w, 2, 3) N on the left and right wheels, in the track frames of the wheelsets."""
        return self._of_wheels([row.force for row in self.rows], 3)

    @cached_property
    def moment(self) -> Array:
        """(n, w, 2, 3) N m about the centres of the wheelsets, in the same frames."""
        return self._of_wheels([row.moment for row in self.rows], 3)

    @cached_property
    def approach(self) -> Array:
        """(n, w, 2) m, largest penetration of the undeformed bodies."""
        return self._of_wheels([row.approach for row in self.rows])

    @cached_property
    def frictional_power(self) -> Array:
        """(n, w, 2) W."""
        powers = [
            [[wheel.column("frictional_power").sum() for wheel in pair] for pair in row.patches] for row in self.rows
        ]
        return self._of_wheels(powers)

    def _of_wheels(self, rows: Sequence[object], *components: int) -> Array:
        """Values (n, w, 2, ...) of rows, also of none."""
        return np.array(rows, dtype=float).reshape(len(rows), len(self.dynamics.vehicle.wheelsets), 2, *components)

    @property
    def distance(self) -> Array:
        """Distance along the track (n,), m: of the reference motion or, of a vehicle that runs free, of its centre of
        mass, both from their places at time zero.
        """
        return self._track_positions[:, 0]

    @property
    def speeds(self) -> Array:
        """Speed along the track (n,), m/s, of the same."""
        return self._track_positions[:, 1]

    @cached_property
    def _track_positions(self) -> Array:
        positions = self.dynamics.speed_profile.positions(self.time)
        if self.dynamics.runs_free:
            positions[:, :2] += np.stack(self.dynamics.drift(self.state), axis=1)
        return positions

    @cached_property
    def motion(self) -> VehicleState:
        """States with x, and rolling angles of the wheelsets, relative to a reference motion with `distance` and
        `speeds`: that of the run or, of a vehicle that runs free, that of its centre of mass.
        """
        parts = self.dynamics.coordinates.split(self.state)
        if not self.dynamics.runs_free:
            return parts
        wheelsets = self.dynamics.coordinates.wheelset_bodies
        for values, drift in zip(parts[:2], self.dynamics.drift(self.state), strict=True):
            values[..., X] -= drift[:, None]
            values[:, wheelsets, PITCH] -= drift[:, None] / self.dynamics.vehicle.radius
        return parts

    def applied(self) -> tuple[Array, Array]:
        """Torques (n, w) N m on wheelsets about their axles, and forces (n, b, 3) N on bodies in axes of the local
        track section.
        """
        d = self.dynamics
        torque, force = np.zeros((len(self), len(d.vehicle.names))), np.zeros((len(self), len(d.vehicle.names), 3))
        for row, on_wheelsets, on_bodies in zip(self.rows, torque, force, strict=True):
            travel = d.speed_profile(row.time)
            torques, components = d.bodies.load_values(travel, row.state)
            np.add.at(on_wheelsets, d.applied.wheelsets, torques)
            np.add.at(on_bodies, d.applied.bodies, components)
        return torque[:, d.coordinates.wheelset_bodies], force

    def position(self, body: str) -> Array:
        """Coordinates (n, 6) m and rad of a body; the pitch of a wheelset in excess of nominal rolling."""
        return self.dynamics.coordinates.split(self.state).position[:, self.dynamics.vehicle.names.index(body)]

    def rate(self, body: str) -> Array:
        """Rates (n, 6) m/s and rad/s of the coordinates of a body."""
        return self.dynamics.coordinates.split(self.state).rate[:, self.dynamics.vehicle.names.index(body)]

    @property
    def series(self) -> Array:
        """Spring deflections (n, m) m of Maxwell elements."""
        return self.dynamics.coordinates.split(self.state).series

    @property
    def motions(self) -> Array:
        """Motions (n, k) of axles and rails of all wheelsets, see `VehicleDynamics.structures`."""
        return self.dynamics.motions(self.state)

    def coordinate(self, body: str, coordinate: int) -> Array:
        """Values (n,) m or rad of a coordinate of a body, see `wheelrail.vehicle.multibody.coordinates`."""
        return np.asarray(self.state[:, self.dynamics.coordinates.index(body, coordinate)])

    def suspension(self) -> tuple[Array, Array]:
        """Deflections m and forces N (n, e, 3) of the suspension elements on their upper bodies, in their own axes."""
        d = self.dynamics
        return d.bodies.element_states([d.speed_profile(row.time) for row in self.rows], self.state)
