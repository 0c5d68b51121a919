"""Motion of wheelsets that follow irregular rails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Follow, Forcing
from wheelrail.vehicle.multibody.coordinates import ROLL, X, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.track.irregularity import Irregularities

STORED = 8  # times of a step at which the motion is kept


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

    @cached_property
    def _latest(self) -> dict[float, Array]:
        """Motions at the latest times: stages and rows of a step ask for the same ones several times."""
        return {}

    def __call__(self, time: float) -> Array:
        if time not in self._latest:
            if len(self._latest) == STORED:
                del self._latest[next(iter(self._latest))]
            self._latest[time] = self._at(time)
            self._latest[time].setflags(write=False)
        return self._latest[time]

    def _at(self, time: float) -> Array:
        """Motion (3, n) at a time s."""
        d, profile = self.dynamics, self.dynamics.speed_profile
        distance, reference_speed, acceleration, _ = profile(time)
        _, _, jerk = profile.speeds(time)
        ahead, faster = np.zeros((2, 1)) if self.drift is None else self.drift.T
        rails = self.irregularities.derivatives(distance + ahead + faster * (time - self.start) + self._places)
        left, right, (indices, free) = rails[..., 1], rails[..., 3], self._indices
        follows = np.concatenate([0.5 * (left + right), (left - right) / (2.0 * d.vehicle.wheel_y)], axis=1)[:, free]
        value, slope, second, third = follows
        speed = np.tile(np.broadcast_to(reference_speed + faster, left.shape[1:]), 2)[free]
        rate, rate_rate = speed * slope, speed**2 * second + acceleration * slope
        by_time = speed**3 * third + 3.0 * speed * acceleration * second + jerk * slope
        result = np.zeros((3, d.size))
        result[:, indices] = value, rate, rate_rate
        result[:, d.coordinates.count + indices] = rate, rate_rate, by_time
        return result
