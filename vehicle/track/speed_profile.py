"""Kinematics along the track: distance, speed and acceleration over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.piecewise import PiecewiseFunction


class TrackPosition(NamedTuple):
    """Distance m along the track, speed m/s, acceleration m/s2, at a time s."""

    distance: float
    speed: float
    acceleration: float
    time: float = 0.0


@dataclass(frozen=True)
class SpeedProfile:
    """Prescribed speed over time; the distance is its exact integral, zero at time zero.

    Parameters:
        speeds: m/s, function of time s.

    Of the plane wagon, and of bodies whose x is held, the motion along the track is a constraint. A vehicle whose speed
    is held follows the profile by the force of its `SpeedHold` on one body, not by its wheels: when the speed changes
    without a torque on the axles, the rails accelerate the rotation of every wheelset by a longitudinal force of J
    dV/dt / r^2 in total. To a vehicle that runs free it is the reference from which displacements count. Raises
    ValueError for speeds that are not positive and finite.
    """

    speeds: PiecewiseFunction

    def __post_init__(self) -> None:
        for speed in self.speeds.values:
            if not 0.0 < speed < float("inf"):
                raise ValueError(f"speed {speed} m/s: must be positive and finite (creepage is slip over speed)")

    @classmethod
    def of(cls, speed: float | SpeedProfile) -> SpeedProfile:
        return speed if isinstance(speed, SpeedProfile) else cls(PiecewiseFunction.constant(speed))

    @classmethod
    def through(cls, times: tuple[float, ...], speeds: tuple[float, ...]) -> SpeedProfile:
        """Profile through speeds m/s at times s, quintic in between and constant outside; no acceleration at the times.

        Parameters:
            times: (n,) s.
            speeds: (n,) m/s.
        """
        return cls(PiecewiseFunction(times, speeds))

    @property
    def constant(self) -> bool:
        return len(set(self.speeds.values)) == 1

    def __call__(self, time: float) -> TrackPosition:
        speed, acceleration, _ = self.speeds(time)
        return TrackPosition(self.speeds.integral(time), speed, acceleration, time)

    def positions(self, times: Array) -> Array:
        """Distance m, speed m/s and acceleration m/s2 (n, 3) at times (n,) s."""
        return np.array([self(time)[:3] for time in times.tolist()], dtype=float).reshape(-1, 3)

    def time_at(self, distance: float) -> float:
        """Time s at which the vehicle reaches a distance m."""
        if len(self.speeds.stations) == 1:
            return distance / self.speeds.values[0]
        from scipy.optimize import brentq

        bounds = (distance / speed for speed in (min(self.speeds.values), max(self.speeds.values)))
        low, high = sorted(bounds)
        time = brentq(lambda t: self.speeds.integral(t) - distance, low - 1e-9, high + 1e-9, xtol=1e-12)
        return float(time)
