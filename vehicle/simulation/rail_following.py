"""Motion of wheelsets that follow irregular rails."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Follow, Forcing
from wheelrail.vehicle.multibody.coordinates import ROLL, X, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation

STORED = 8  # times of a step at which the motion is kept


def rail_following(dynamics: VehicleDynamics) -> Follow[VehicleEvaluation] | None:
    """Height and roll by which the wheelsets follow the irregular rails, and the drift of a vehicle from its reference
    motion; None on smooth rails, unless the vehicle runs free.

    The drift is that of the centre of mass: at its speed at the start of a step and, of a vehicle that runs free, with
    its acceleration, so that stages know where the wheels are when the rails there are felt.

    Contacts are so stiff that heights differ from this motion by micrometres. The difference is driven by the
    acceleration of the rails instead of their position: a step of a linearly implicit method is then limited by the
    motion, and not by contacts that the stages load or lift as they extrapolate rails of changing slope.
    """
    if dynamics.track.irregularities is None and not dynamics.runs_free:
        return None
    if not dynamics.drifts:
        fixed = RailFollowing(dynamics)
        return lambda time, state, start: fixed

    def of_step(time: float, state: Array, start: VehicleEvaluation) -> Forcing:
        ahead = dynamics.coordinates.split(state).position[dynamics.coordinates.wheelset_bodies, X]
        speed, acceleration = (float(part) for part in dynamics.drift(start.rate))
        return RailFollowing(dynamics, Drift(time, ahead, speed, acceleration if dynamics.runs_free else 0.0))

    return of_step


@dataclass(frozen=True)
class Drift:
    """Motion of a vehicle from its place in the reference motion.

    Parameters:
        start: time s.
        ahead: (w,) m, of the wheelsets at this time.
        speed, acceleration: m/s at this time, and m/s2.
    """

    start: float
    ahead: Array
    speed: float
    acceleration: float

    def since(self, time: float) -> tuple[float, float, float]:
        """Distance m run since the start until a time s, and its first two derivatives."""
        after = time - self.start
        speed = self.speed + self.acceleration * after
        return 0.5 * (self.speed + speed) * after, speed, self.acceleration


@dataclass(frozen=True)
class RailFollowing:
    """State (n,) of motion along irregular rails, and its first two derivatives by time.

    Parameters:
        dynamics: equations of motion.
        drift: from the reference motion; None: there is none.
    """

    dynamics: VehicleDynamics
    drift: Drift | None = None

    @cached_property
    def _places(self) -> Array:
        """Places (w,) m of the wheelsets."""
        bodies = self.dynamics.vehicle.bodies
        return np.array([bodies[name].x for name in self.dynamics.vehicle.wheelsets])

    @cached_property
    def _indices(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """State indices of free heights, then rolls, of the wheelsets, and their numbers among all 2 w."""
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
        d, travel = self.dynamics, self.dynamics.speed_profile(time)
        result = np.zeros((3, d.size))
        places, run, faster, acceleration = self._places, 0.0, 0.0, 0.0
        if self.drift is not None:
            places, (run, faster, acceleration) = places + self.drift.ahead, self.drift.since(time)
            count, along = d.coordinates.count, d.drifting[: d.coordinates.count]
            share = np.where(d.coordinates.free[np.flatnonzero(along)] % 6 == X, 1.0, 1.0 / d.vehicle.radius)
            result[:, :count][:, along] = np.outer((run, faster, acceleration), share)
            result[:2, count : 2 * count][:, along] = np.outer((faster, acceleration), share)
        if d.track.irregularities is None:
            return result
        speed, acceleration = travel.speed + faster, travel.acceleration + acceleration
        _, _, jerk = d.speed_profile.speeds(time)
        rails = d.track.irregularities.derivatives(travel.distance + run + places)
        left, right, (indices, free) = rails[..., 1], rails[..., 3], self._indices
        follows = np.concatenate([0.5 * (left + right), (left - right) / (2.0 * d.vehicle.wheel_y)], axis=1)[:, free]
        value, slope, second, third = follows
        rate, rate_rate = speed * slope, speed**2 * second + acceleration * slope
        by_time = speed**3 * third + 3.0 * speed * acceleration * second + jerk * slope
        result[:, indices] = value, rate, rate_rate
        result[:, d.coordinates.count + indices] = rate, rate_rate, by_time
        return result
