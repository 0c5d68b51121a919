"""Run of a vehicle in time through an extreme gust, and the critical wind of such runs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.crosswind.critical_wind import LIMIT, CriticalWind, WindyVehicle, critical_wind
from wheelrail.vehicle.crosswind.gust import REACH, Gust
from wheelrail.vehicle.evaluation.running_safety import INTERVAL, low_pass
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import EquilibriumError

CUTOFF = 2.0  # Hz, of the low-pass filter of wheel loads; not confirmed
SPACING = 0.1  # of the shorter of gust and width, between points of the load
AFTER = 2.0  # s of the run behind the middle of the gust, at least


@dataclass(frozen=True)
class GustRun:
    """Run through a gust.

    Parameters:
        time: (n,) s, every 2 ms.
        wind: (n,) m/s, averaged over the vehicle.
        unloading: (n, g) of the windward wheels of each running gear, low-pass filtered.
        completed: whether the run reached its end.
    """

    time: Array
    wind: Array
    unloading: Array
    completed: bool


def gust_run(windy: WindyVehicle, peak: float, width: float) -> GustRun:
    """Run from the equilibrium in mean wind through a gust.

    Parameters:
        windy: vehicle.
        peak: of the gust, m/s.
        width: over which the wind acts as its mean, m.

    Raises EquilibriumError and StepFailure without an equilibrium in mean wind, WindTableError.
    """
    gust = Gust(peak, windy.crosswind.angle)
    reach = REACH * gust.length + 0.5 * width
    fine = np.arange(-reach, reach, SPACING * min(gust.length, max(width, 1.0)))
    middle = reach
    loads = windy.crosswind.loads(windy.speed, gust.averaged(fine, width), middle + fine)
    end = middle + min(reach, max(2.0 * gust.length + 0.5 * width, AFTER * windy.speed))
    start = windy.at(float(gust.averaged(fine[:1], width)[0])).state
    run = simulate(replace(windy.placed, loads=loads), (0.0, end / windy.speed), initial=start)
    time = np.arange(0.0, run.time[-1], INTERVAL)
    side = 0 if windy.crosswind.from_left else 1
    raw = windy.unloading(run.force[:, :, side, 2])
    filtered = np.stack([low_pass(np.interp(time, run.time, column), CUTOFF) for column in raw.T], axis=1)
    wind = gust.averaged(windy.speed * time - middle, width)
    return GustRun(time, wind, filtered, run.status == "completed")


def critical_gust(windy: WindyVehicle, width: float, first: float) -> CriticalWind | None:
    """Peak of the gust at which the filtered unloading reaches its limit, searched from a first one, m/s.

    Raises WindTableError.
    """

    def unloading(peak: float) -> Array | None:
        try:
            run = gust_run(windy, peak, width)
        except (EquilibriumError, StepFailure):
            return None
        largest = np.asarray(run.unloading.max(axis=0))
        return largest if run.completed or largest.max() > LIMIT else None

    return critical_wind(unloading, first)
