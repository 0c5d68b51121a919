"""Diagnostics of a run: extremes, time without contact, energy, undetected errors."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from wheelrail.bindings._contact import PATCH_TOO_LONG, TOO_DEEP
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.plane_wagon import COORDINATES
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.limits import LIMITS
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

WHEELSET_Y = COORDINATES.index("wheelset_y")
LOADED = 0.1  # of the static wheel load, from which Y/Q counts
MEAN_LOAD = 0.1  # allowed relative deviation of the mean vertical force from the expected one; runs are short
# Allowed differences from a run at a tenth of the tolerances, RMS over the run: wheelset's y m, car body's roll rad;
# relative difference of the end of a run that ends early.
APART = {"y": 2e-4, "roll": 1e-3, "end": 0.01}


@dataclass(frozen=True)
class Findings:
    """Of one run: metres, smallest wheel load N, largest Y/Q, seconds with an unloaded wheel, largest |y| of the
    wheelset m and roll of the car body rad, mean of the vertical forces over the expected one, error of the energy
    balance; wrong: reasons for an invalid run, empty if there are none.
    """

    metres: float
    load: float
    ratio: float
    off: float
    aside: float
    roll: float
    mean: float
    energy: float
    wrong: str

    @classmethod
    def of(cls, history: History, wagon: Wagon, track: Track) -> Findings:
        t, force = history.time, history.force[:, 0]
        loaded = force[:, :, 2] > LOADED * wagon.wheel_load
        ratio = np.abs(force[:, :, 1]) / np.where(loaded, force[:, :, 2], np.inf)
        off = np.array(
            [any(s == "separated" for s in pair) for row in history.rows for pair in row.contact_status], dtype=float
        )
        mean = _mean_load(history, wagon, track)
        aside, roll = float(np.abs(history.state[:, WHEELSET_Y]).max()), float(np.abs(history.state[:, 2]).max())
        stopped = history.status != "completed"
        numbers = np.isfinite(history.state).all() and np.isfinite(force).all()
        wrong = [
            *([] if numbers else ["not finite"]),
            *([] if abs(mean - 1.0) < MEAN_LOAD or stopped else [f"mean load {mean:.2f}"]),
            *([] if stopped or roll <= LIMITS.roll else [f"rolls {roll:.2f} rad"]),
            *([] if stopped or aside <= LIMITS.shift + 0.02 else [f"{1e3 * aside:.0f} mm lateral displacement"]),
            *([] if not stopped or names_cause(history.status) else ["status without a cause"]),
        ]
        return cls(
            metres=float(history.distance[-1]),
            load=float(force[:, :, 2].min()),
            ratio=float(ratio.max()),
            off=_integral(off, t),
            aside=aside,
            roll=roll,
            mean=mean,
            energy=energy_balance(history).error,
            wrong=", ".join(wrong),
        )

    def numbers(self) -> dict[str, float | str]:
        return asdict(self)


def _integral(values: Array | list[float], time: Array) -> float:
    """By trapezoids."""
    samples = np.asarray(values)
    return float(0.5 * (samples[1:] + samples[:-1]) @ np.diff(time))


def names_cause(status: str) -> bool:
    """Whether the status of a run that ended early names overturning, derailment, or a wheel that is pressed into the
    rail beyond the range of the contact, by several mm of the undeformed profiles.
    """
    return any(cause in status for cause in ("overturns", "left the rails", PATCH_TOO_LONG, TOO_DEEP))


def _mean_load(history: History, wagon: Wagon, track: Track) -> float:
    """Mean vertical force of both wheels over the mean of weight and centrifugal force across the rails."""
    t, plane = history.time, wagon.plane
    mass = wagon.axle_load / plane.gravity
    sections = TrackSections(track).at(history.distance, 0.0)
    expected = mass * (plane.gravity * sections.axes[:, 2, 2] - history.speeds**2 * sections.rate[:, 1])
    if len(t) < 2:
        return 1.0
    return _integral(history.force[:, 0, :, 2].sum(axis=1), t) / _integral(expected, t)


def run_differences(history: History, reference: History) -> dict[str, float]:
    """RMS difference of the wheelset's y m and the car body's roll rad over the common time, and relative difference of
    the ends.
    """
    end = min(history.time[-1], reference.time[-1])
    times: Array = np.linspace(history.time[0], end, 2001)
    difference = {
        name: np.interp(times, history.time, history.state[:, i])
        - np.interp(times, reference.time, reference.state[:, i])
        for name, i in (("y", WHEELSET_Y), ("roll", 2))
    }
    rms = {name: float(np.sqrt((d**2).mean())) for name, d in difference.items()}
    return {**rms, "end": float(abs(history.time[-1] - reference.time[-1]) / reference.time[-1])}
