"""How fast the vehicle goes, and how far it is: distance, speed and acceleration over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from wheelrail.vehicle.track.piecewise import PiecewiseFunction


class TrackPosition(NamedTuple):
    """distance m along the track, speed m/s, acceleration m/s2."""

    distance: float
    speed: float
    acceleration: float


@dataclass(frozen=True)
class SpeedProfile:
    """Speed m/s as a course over time s; the distance is its exact integral, zero at time zero.

    The motion along the track is prescribed, at constant speed as at a changing one: whatever force that takes acts on
    the bodies along x and appears nowhere. There is neither a motor nor a brake on the axle: rails turn the wheelset,
    with J dV/dt / r^2 in all, when the speed changes. Raises ValueError for speeds that are not positive and finite.
    """

    speeds: PiecewiseFunction

    def __post_init__(self) -> None:
        for speed in self.speeds.values:
            if not 0.0 < speed < float("inf"):
                raise ValueError(f"speed {speed} m/s: positive and finite (creepage is slip over speed)")

    @classmethod
    def of(cls, speed: float | SpeedProfile) -> SpeedProfile:
        return speed if isinstance(speed, SpeedProfile) else cls(PiecewiseFunction.constant(speed))

    @classmethod
    def through(cls, times: tuple[float, ...], speeds: tuple[float, ...]) -> SpeedProfile:
        """Constant before and after, quintic in between: at each of the times s the acceleration is zero."""
        return cls(PiecewiseFunction(times, speeds))

    @property
    def constant(self) -> bool:
        return len(set(self.speeds.values)) == 1

    def __call__(self, time: float) -> TrackPosition:
        speed, acceleration, _ = self.speeds(time)
        return TrackPosition(self.speeds.integral(time), speed, acceleration)

    def time_at(self, distance: float) -> float:
        """When the vehicle gets to a distance m, s."""
        if len(self.speeds.stations) == 1:
            return distance / self.speeds.values[0]
        from scipy.optimize import brentq

        bounds = (distance / speed for speed in (min(self.speeds.values), max(self.speeds.values)))
        low, high = sorted(bounds)
        found = brentq(lambda t: self.speeds.integral(t) - distance, low - 1e-9, high + 1e-9, xtol=1e-12)
        return float(found)
