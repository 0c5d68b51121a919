"""Applied torques and forces on the bodies of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.kinematics.frames import cross
from wheelrail.support.arrays import Array
from wheelrail.vehicle.loads.applied_loads import AppliedLoads
from wheelrail.vehicle.multibody.body_motion import BodyMotion
from wheelrail.vehicle.multibody.coordinates import Coordinates, X
from wheelrail.vehicle.multibody.rotations import rotate
from wheelrail.vehicle.multibody.vehicle import InvalidVehicle, Vehicle
from wheelrail.vehicle.track.speed_profile import TrackPosition

LOCKED = 0.05  # m/s at the rim, half the speed at which a run ends: a slower wheel in a friction brake is held


class AppliedState(NamedTuple):
    """Torques and forces at one time, in common axes unless another is named.

    Parameters:
        torque: (p,) N m, of each torque on its wheelset, about the axle.
        components: (f, 3) N, of each force along the axes of the track section at its body.
        force, moment: (n, 3) N and N m about the centres of mass, on the bodies.
    """

    torque: Array
    components: Array
    force: Array
    moment: Array


@dataclass(frozen=True)
class AppliedForces:
    """Torques on wheelsets with their reactions, and forces at points of bodies.

    Parameters:
        coordinates: of the vehicle.
        loads: torques and forces.

    Raises InvalidVehicle for a body that the vehicle does not have, and a load that does not fit it.
    """

    coordinates: Coordinates
    loads: AppliedLoads

    def __post_init__(self) -> None:
        vehicle = self.coordinates.vehicle
        for k, torque in enumerate(self.loads.torques):
            _check_torque(f"torque.{k}", vehicle, torque.wheelset, torque.reaction)
            if torque.brake and self.loads.tables[k].least < 0.0:
                raise InvalidVehicle(f"torque.{k}.torque", "of a friction brake must not be negative")
        for k, force in enumerate(self.loads.forces):
            if force.body not in vehicle.bodies:
                raise InvalidVehicle(f"force.{k}.body", f"must be one of {', '.join(vehicle.names)}")
            if len(force.point) != 3 or not all(isfinite(value) for value in force.point):
                raise InvalidVehicle(f"force.{k}.point", "must be three finite numbers, m")

    @cached_property
    def wheelsets(self) -> NDArray[np.int64]:
        """Bodies (p,) on which the torques act."""
        return np.array([self._index(part.wheelset) for part in self.loads.torques], dtype=np.int64)

    @cached_property
    def reactions(self) -> NDArray[np.int64]:
        """Bodies (p,) on which their reactions act."""
        vehicle = self.coordinates.vehicle
        names = (part.reaction or bodies_above(vehicle, part.wheelset)[0] for part in self.loads.torques)
        return np.array([self._index(name) for name in names], dtype=np.int64)

    @cached_property
    def brakes(self) -> NDArray[np.bool_]:
        """(p,) whether a torque is that of a friction brake."""
        return np.array([part.brake for part in self.loads.torques], dtype=bool)

    @property
    def release(self) -> float:
        """Rate of rotation, rad/s, below which the torque of a friction brake falls with it to zero."""
        return LOCKED / self.coordinates.vehicle.radius

    @cached_property
    def bodies(self) -> NDArray[np.int64]:
        """Bodies (f,) on which the forces act."""
        return np.array([self._index(part.body) for part in self.loads.forces], dtype=np.int64)

    @cached_property
    def arms(self) -> Array:
        """(f, 3) m, from the centres of mass to the points, in the axes of the bodies."""
        bodies = self.coordinates.vehicle.bodies
        rows = [
            (p.point[0] - bodies[p.body].x, p.point[1], p.point[2] - bodies[p.body].height) for p in self.loads.forces
        ]
        return np.array(rows, dtype=float).reshape(-1, 3)

    def __call__(self, travel: TrackPosition, motion: BodyMotion, state: Array) -> AppliedState:
        """Torques and forces of a state.

        Parameters:
            travel: reference motion along the track.
            motion: of the bodies.
            state: (2 c + m,).
        """
        distance = travel.distance + self.coordinates.split(state).position[:, X]
        force, moment = np.zeros_like(motion.position), np.zeros_like(motion.position)
        owners = [*self.wheelsets.tolist(), *np.repeat(self.bodies, 3).tolist()]
        values = np.array(
            [table.at(travel.time, distance[i]) for table, i in zip(self.loads.tables, owners, strict=True)]
        )
        axle = motion.axes[self.wheelsets, :, 1]
        torque = self._with_brakes(values[: len(axle)], motion, axle)
        np.add.at(moment, self.wheelsets, torque[:, None] * axle)
        np.add.at(moment, self.reactions, -torque[:, None] * axle)
        components = values[len(axle) :].reshape(-1, 3)
        own = rotate(motion.sections.axes[self.bodies], components)
        turning = cross(rotate(motion.axes[self.bodies], self.arms), own)
        # Bearings transmit no moment about the axle of a wheelset.
        about = motion.axes[self.bodies, :, 1]
        is_wheelset = np.isin(self.bodies, self.coordinates.wheelset_bodies)[:, None]
        turning = turning - np.where(is_wheelset, (turning * about).sum(axis=1, keepdims=True), 0.0) * about
        np.add.at(force, self.bodies, own)
        np.add.at(moment, self.bodies, turning)
        return AppliedState(torque, components, force, moment)

    def _with_brakes(self, values: Array, motion: BodyMotion, axle: Array) -> Array:
        """Torques (p,) N m of values (p,), of which those of friction brakes act against the rotation."""
        spin = motion.relative.spin[self.wheelsets]
        spin = spin + ((motion.rate[self.wheelsets] - motion.rate[self.reactions]) * axle).sum(axis=1)
        return np.where(self.brakes, -values * np.clip(spin / self.release, -1.0, 1.0), values)

    def _index(self, name: str) -> int:
        return self.coordinates.vehicle.names.index(name)


def bodies_above(vehicle: Vehicle, wheelset: str) -> list[str]:
    """Names of the bodies that suspension elements join to a wheelset."""
    above = {element.upper for element in vehicle.elements.values() if element.lower == wheelset}
    return [name for name in vehicle.names if name in above]


def _check_torque(key: str, vehicle: Vehicle, wheelset: str, reaction: str | None) -> None:
    """Raises InvalidVehicle."""
    if wheelset not in vehicle.wheelsets:
        raise InvalidVehicle(f"{key}.wheelset", f"must be one of {', '.join(vehicle.wheelsets)}")
    others = [name for name in vehicle.names if not vehicle.bodies[name].wheelset]
    if reaction is not None and reaction not in others:
        raise InvalidVehicle(f"{key}.reaction", f"must be one of {', '.join(others)}, no wheelset")
    above = bodies_above(vehicle, wheelset)
    if reaction is None and len(above) != 1:
        text = f"required, as elements join {wheelset} to {' and '.join(above) or 'no body'}"
        raise InvalidVehicle(f"{key}.reaction", text)
