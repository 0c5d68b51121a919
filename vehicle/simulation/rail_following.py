"""Motion of wheelsets that follow irregular rails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Forcing
from wheelrail.vehicle.multibody.coordinates import ROLL, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.track.irregularity import Irregularities


def rail_following(dynamics: VehicleDynamics) -> Forcing | None:
    """Height and roll by which the wheelsets follow the irregular rails in the reference motion; None on smooth rails.

    Contacts are so stiff that heights differ from this motion by micrometres. The difference is driven by the
    acceleration of the rails instead of their position: a step of a linearly implicit method is then limited by the
    motion, and not by contacts that the stages load or lift as they extrapolate rails of changing slope.
    """
    irregularities = dynamics.track.irregularities
    return None if irregularities is None else RailFollowing(dynamics, irregularities)


@dataclass(frozen=True)
class RailFollowing:
    """State (n,) of motion along irregular rails with wheelsets at their places, and its first two derivatives by time.

    Parameters:
        dynamics: equations of motion.
        irregularities: of its track.
    """

    dynamics: VehicleDynamics
    irregularities: Irregularities

    @cached_property
    def _places(self) -> Array:
        """Places (w,) m of the wheelsets."""
        bodies = self.dynamics.vehicle.bodies
        return np.array([bodies[name].x for name in self.dynamics.vehicle.wheelsets])

    @cached_property
    def _indices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Indices in the state of the heights, then the rolls, of the wheelsets, and which of these 2 w are free."""
        coordinates = self.dynamics.coordinates
        places = {full: i for i, full in enumerate(coordinates.free.tolist())}
        indices = [places.get(6 * i + k, -1) for k in (Z, ROLL) for i in coordinates.wheelset_bodies.tolist()]
        free = np.flatnonzero(np.array(indices) >= 0)
        return np.array(indices)[free], free

    def __call__(self, time: float) -> Array:
        d, profile = self.dynamics, self.dynamics.speed_profile
        distance, speed, acceleration = profile(time)
        _, _, jerk = profile.speeds(time)
        rails = self.irregularities.derivatives(distance + self._places)
        left, right, (indices, free) = rails[..., 1], rails[..., 3], self._indices
        follows = np.concatenate([0.5 * (left + right), (left - right) / (2.0 * d.vehicle.wheel_y)], axis=1)[:, free]
        value, slope, second, third = follows
        rate, rate_rate = speed * slope, speed**2 * second + acceleration * slope
        by_time = speed**3 * third + 3.0 * speed * acceleration * second + jerk * slope
        result = np.zeros((3, d.size))
        result[:, indices] = value, rate, rate_rate
        result[:, d.coordinates.count + indices] = rate, rate_rate, by_time
        return result
