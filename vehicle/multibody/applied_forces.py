"""Applied torques and forces on the bodies of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.loads.applied_loads import AppliedLoads
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.vehicle import Vehicle

LOCKED = 0.05  # m/s at the rim, half the speed at which a run ends: a slower wheel in a friction brake is held


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
            if torque.brake and torque.wheelset in vehicle.independent:
                raise InvalidVehicle(f"torque.{k}.wheelset", "must have a rigid axle, on which a friction brake acts")
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
        """Rate of rotation, rad/s, below which the torque of a friction brake decreases linearly to zero."""
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
