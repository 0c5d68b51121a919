"""Motion of wheelsets that follow irregular rails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Follow, Forcing
from wheelrail.vehicle.multibody.coordinates import ROLL, X, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.track.irregularity import Irregularities


def rail_following(dynamics: VehicleDynamics) -> Follow | None:
    """Height and roll by which the wheelsets follow the irregular rails; None on smooth rails.

    They do so in the reference motion or, where the vehicle may leave it, each at its speed at the start of the step.

    Contacts are so stiff that heights differ from this motion by micrometres. The difference is driven by the
    acceleration of the rails instead of their position: a step of a linearly implicit method is then limited by the
    motion, and not by contacts that the stages load or lift as they extrapolate rails of changing slope.
    """
    irregularities = dynamics.track.irregularities
    if irregularities is None:
        return None
    if not dynamics.drifts:
        fixed = RailFollowing(dynamics, irregularities)
        return lambda time, state: fixed

    def of_step(time: float, state: Array) -> Forcing:
        position, rate, _ = dynamics.coordinates.split(state)
        wheelsets = dynamics.coordinates.wheelset_bodies
        drift = np.stack([position[wheelsets, X], rate[wheelsets, X]], axis=1)
        return RailFollowing(dynamics, irregularities, time, drift)

    return of_step


@dataclass(frozen=True)
class RailFollowing:
    """State (n,) of motion along irregular rails, and its first two derivatives by time.

    Parameters:
        dynamics: equations of motion.
        irregularities: of its track.
        start: time s.
        drift: (w, 2) distance m of each wheelset from its place in the reference motion at this time, and its rate m/s;
            None: they are at their places.
    """

    dynamics: VehicleDynamics
    irregularities: Irregularities
    start: float = 0.0
    drift: Array | None = None

    @cached_property
    def _wheelsets(self) -> list[tuple[float, list[int | None]]]:
        """Place m and indices of height and roll in the state of each wheelset; no index where held."""
        coordinates, bodies = self.dynamics.coordinates, self.dynamics.vehicle.bodies
        places = {full: i for i, full in enumerate(coordinates.free.tolist())}
        x = [bodies[name].x for name in self.dynamics.vehicle.wheelsets]
        indices = [[places.get(6 * i + k) for k in (Z, ROLL)] for i in coordinates.wheelset_bodies.tolist()]
        return list(zip(x, indices, strict=True))

    def __call__(self, time: float) -> Array:
        d, profile = self.dynamics, self.dynamics.speed_profile
        reference, reference_speed, acceleration, _ = profile(time)
        distance, speed = reference, reference_speed
        _, _, jerk = profile.speeds(time)
        result = np.zeros((3, d.size))
        for number, (place, indices) in enumerate(self._wheelsets):
            if self.drift is not None:
                ahead, faster = self.drift[number].tolist()
                distance = reference + ahead + faster * (time - self.start)
                speed = reference_speed + faster
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
