"""Wheel unloading of a vehicle in steady wind, and the wind at which the unloading reaches its limit.

The criterion, 90 % unloading of the windward wheels of one running gear, is that of EN 14067-6 after public texts; the
standard was not available.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, sqrt

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.support.arrays import Array
from wheelrail.vehicle.crosswind.wind import Crosswind
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.multibody.equations import VehicleDynamics, WheelContacts
from wheelrail.vehicle.steady.equilibrium import Equilibrium, EquilibriumError, equilibrium, equilibrium_near
from wheelrail.vehicle.steady.twist_test import bogies
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

LIMIT = 0.9  # of the unloading
NEAR = 1e-3  # of the unloading, and
CLOSE = 0.02  # m/s of the wind, at which the search ends
GROWTH = 1.15  # of the wind from one trial to the next until its limit lies between two
BEYOND = 0.01  # of the unloading, so that the next trial is on the other side
SHORTEST = 0.2  # m/s, of steps of the continuation that are halved
SLOWEST, FASTEST = 3.0, 120.0  # m/s, of the wind


@dataclass(frozen=True)
class CriticalWind:
    """Wind at which the unloading reaches its limit.

    Parameters:
        wind: m/s.
        unloading: reached; less than the limit where a stronger wind has no equilibrium or ends the run.
        gear: worst running gear, the first is 0.
    """

    wind: float
    unloading: float
    gear: int

    @property
    def reached(self) -> bool:
        """Whether the unloading reaches its limit before the vehicle is lost."""
        return self.unloading > LIMIT - 10.0 * NEAR


@dataclass(frozen=True)
class WindyVehicle:
    """Vehicle at constant speed in crosswind, on straight track or in a curve away from the wind without cant.

    Parameters:
        dynamics: equations of motion; its track, speed and loads are not used.
        crosswind: on one of its bodies.
        speed: m/s.
        acceleration: unbalanced lateral one m/s2, in the direction of the wind.
    """

    dynamics: VehicleDynamics
    crosswind: Crosswind
    speed: float
    acceleration: float = 0.0

    @cached_property
    def placed(self) -> VehicleDynamics:
        """Equations of motion at the speed, in the curve, without wind."""
        leeward = 1.0 if self.crosswind.from_left else -1.0  # curves to the right press to the left
        curve = ConstantCurve(self.speed, leeward * self.acceleration / self.speed**2)
        return replace(self.dynamics, track=curve.track if self.acceleration else Track(), speed=self.speed)

    @cached_property
    def gears(self) -> list[list[int]]:
        """Numbers of the wheelsets of each running gear from the front."""
        names = self.dynamics.vehicle.wheelsets
        return [[names.index(name) for name in group] for group in bogies(self.dynamics.vehicle)]

    @cached_property
    def level(self) -> Array:
        """(w,) N, loads of the windward wheels on straight track without wind."""
        straight = replace(self.dynamics, track=Track(), speed=self.speed)
        return self.windward(equilibrium(straight).contacts)

    def windward(self, contacts: WheelContacts) -> Array:
        """Loads (w,) N of the windward wheels."""
        side: Side = "left" if self.crosswind.from_left else "right"
        return np.array([contacts[name][side].force[2] for name in self.dynamics.vehicle.wheelsets])

    def unloading(self, loads: Array) -> Array:
        """Unloading (..., g) of the windward wheels of each running gear on average, by their loads (..., w) N."""
        parts = [loads[..., own].sum(axis=-1) / self.level[own].sum() for own in self.gears]
        return np.asarray(1.0 - np.stack(parts, axis=-1))

    @cached_property
    def found(self) -> dict[float, Equilibrium]:
        """Known equilibria by the wind, m/s, to continue from. Raises EquilibriumError without wind."""
        return {0.0: equilibrium(self.placed)}

    def at(self, wind: float) -> Equilibrium:
        """Equilibrium in a wind, m/s, by continuation from the nearest one found before, in steps as long as possible.

        Raises EquilibriumError and StepFailure where a step of 0.1 m/s fails, WindTableError.
        """
        reached = min(self.found, key=lambda known: abs(known - wind))
        step = wind - reached
        while reached != wind:
            tried = wind if abs(step) >= abs(wind - reached) else reached + step
            dynamics = replace(self.placed, loads=self.crosswind.loads(self.speed, tried))
            last = self.found[reached]
            try:
                self.found[tried] = equilibrium_near(dynamics, 0.0, last.state, last.contacts)
            except (EquilibriumError, StepFailure):
                if abs(step) < SHORTEST:
                    raise
                step = 0.5 * (tried - reached)
                continue
            reached, step = tried, 1.5 * step
        return self.found[wind]

    def critical(self, first: float = 20.0) -> CriticalWind | None:
        """Steady wind at which the unloading reaches its limit, searched from a first one, m/s; None beyond 120 m/s.

        Raises EquilibriumError for a vehicle without equilibrium in no wind, WindTableError.
        """
        _ = self.found

        def unloading(wind: float) -> Array | None:
            try:
                return self.unloading(self.windward(self.at(wind).contacts))
            except (EquilibriumError, StepFailure):
                return None

        return critical_wind(unloading, first)


def critical_wind(unloading: Callable[[float], Array | None], first: float) -> CriticalWind | None:
    """Wind at which the largest unloading reaches its limit, by false position in its square and bisection.

    Parameters:
        unloading: (g,) of running gears by the wind m/s; None where the vehicle is lost.
        first: wind, m/s, of the first trial.

    None if even the strongest wind does not unload so much, or the weakest one unloads more.
    """
    wind, low, high = first, CriticalWind(0.0, -inf, 0), CriticalWind(inf, inf, 0)
    while SLOWEST <= wind <= FASTEST:
        values = unloading(wind)
        if values is None or not np.isfinite(values).all():
            at = CriticalWind(wind, inf, 0)
        else:
            at = CriticalWind(wind, float(values.max()), int(values.argmax()))
        if abs(at.unloading - LIMIT) < NEAR:
            return at
        low, high = (at, high) if at.unloading < LIMIT else (low, at)
        if high.wind == inf:  # unloading grows about as the square
            wind *= min(sqrt((LIMIT + BEYOND) / max(low.unloading, BEYOND)), GROWTH)
        elif low.wind == 0.0:
            wind *= max(sqrt((LIMIT - BEYOND) / high.unloading), 1.0 / GROWTH)
        elif high.wind - low.wind < CLOSE:
            return low
        else:
            share = (LIMIT - low.unloading) / (high.unloading - low.unloading) if high.unloading < inf else 0.5
            wind = sqrt(low.wind**2 + min(max(share, 0.1), 0.9) * (high.wind**2 - low.wind**2))
    return None
