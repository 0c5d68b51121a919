"""Motion of wheelsets that follow irregular rails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

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
    def _wheelsets(self) -> list[tuple[float, list[int | None]]]:
        """Place m and indices of height and roll in the state of each wheelset; None: held."""
        coordinates, bodies = self.dynamics.coordinates, self.dynamics.vehicle.bodies
        places = {full: i for i, full in enumerate(coordinates.free.tolist())}
        x = [bodies[name].x for name in self.dynamics.vehicle.wheelsets]
        indices = [[places.get(6 * i + k) for k in (Z, ROLL)] for i in coordinates.wheelset_bodies.tolist()]
        return list(zip(x, indices, strict=True))

    def __call__(self, time: float) -> Array:
        d, profile = self.dynamics, self.dynamics.speed_profile
        distance, speed, acceleration = profile(time)
        _, _, jerk = profile.speeds(time)
        result = np.zeros((3, d.size))
        for place, indices in self._wheelsets:
            by_distance = self.irregularities.derivatives(distance + place)
            if by_distance is None:
                continue
            left, right = by_distance[:, 1], by_distance[:, 3]
            follows = 0.5 * (left + right), (left - right) / (2.0 * d.vehicle.wheel_y)
            for index, values in zip(indices, follows, strict=True):
                if index is None:
                    continue
                value, slope, second, third = values.tolist()
                rate, rate_rate = speed * slope, speed**2 * second + acceleration * slope
                rates = (value, rate, rate_rate, speed**3 * third + 3.0 * speed * acceleration * second + jerk * slope)
                result[:, index], result[:, d.coordinates.count + index] = rates[:3], rates[1:]
        return result
