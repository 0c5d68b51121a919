"""Comfort in curves by EN 12299: P_CT of curve transitions, P_DE of discrete events.

CEN's page on EN 12299:2024 names both indices, and PyRidy has the weighting Wp of the lateral acceleration. Formulas,
constants and intervals are from memory of EN 12299:2009 and not confirmed.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.evaluation.comfort import WEIGHTINGS, frequencies, weighted

Passengers = Literal["standing", "seated"]
AFTER = 1.6  # s after the transition, in which the acceleration counts
BEFORE = 1.0  # s before the transition, from which the jerk counts
WINDOW = 2.0  # s, of a discrete event


class TransitionFactors(NamedTuple):
    """P_CT = max(a y + b jerk - c, 0) + d roll^e, in per cent of dissatisfied passengers.

    Parameters:
        a: per m/s2.
        b: per m/s3.
        c: threshold.
        d, e: of the roll rate in degrees per second.
    """

    a: float
    b: float
    c: float
    d: float
    e: float


class EventFactors(NamedTuple):
    """P_DE = max(a peak + b mean - c, 0), in per cent of dissatisfied passengers; a, b: per m/s2."""

    a: float
    b: float
    c: float


TRANSITION: dict[Passengers, TransitionFactors] = {
    "standing": TransitionFactors(28.54, 20.69, 11.1, 0.185, 2.283),
    "seated": TransitionFactors(8.97, 9.68, 5.9, 0.120, 1.626),
}
EVENT: dict[Passengers, EventFactors] = {
    "standing": EventFactors(16.62, 27.01, 37.0),
    "seated": EventFactors(8.46, 13.05, 21.7),
}


def lateral(acceleration: Array, interval: float) -> Array:
    """Lateral acceleration (n,) m/s2 on the floor with the weighting Wp.

    Parameters:
        acceleration: (n,) m/s2.
        interval: s.

    Continued by its first and last value over half its length, as the weighting regards signals as periodic.
    """
    margin = len(acceleration) // 2
    longer = np.pad(acceleration, margin, mode="edge")
    found = weighted(longer, WEIGHTINGS["Wp"](frequencies(len(longer), interval)))
    return found[margin : margin + len(acceleration)]


def running_mean(signal: Array, interval: float, duration: float) -> Array:
    """Means (n,) of a signal (n,) over a duration s around each sample, cut off at its ends."""
    half = max(round(0.5 * duration / interval), 1)
    total = np.append(0.0, np.cumsum(signal))
    index = np.arange(len(signal))
    low, high = np.maximum(index - half, 0), np.minimum(index + half, len(signal))
    return np.asarray((total[high] - total[low]) / (high - low))


def transition_discomfort(
    acceleration: Array,
    roll_rate: Array,
    interval: float,
    bounds: tuple[float, float],
    passengers: Passengers = "standing",
) -> float:
    """P_CT, per cent, of a transition.

    Parameters:
        acceleration: (n,) m/s2, lateral, as of `lateral`.
        roll_rate: (n,) rad/s.
        interval: s.
        bounds: start and end of the transition, s from the first sample.
        passengers: standing or seated.

    Of means over 1 s: the largest acceleration until 1.6 s after the transition, the largest change in 1 s from 1 s
    before it, the largest roll rate in it. Raises ValueError for a transition outside of the signal.
    """
    start, end = bounds
    duration = interval * len(acceleration)
    if not 0.0 <= start < end <= duration:
        raise ValueError(f"transition from {start:g} to {end:g} s: must be within the signal of {duration:g} s")
    time = interval * np.arange(len(acceleration))
    y, roll = (running_mean(signal, interval, 1.0) for signal in (acceleration, roll_rate))
    jerk = np.interp(time + 0.5, time, y) - np.interp(time - 0.5, time, y)

    def largest(signal: Array, low: float, high: float) -> float:
        return float(np.abs(signal[(time >= low) & (time <= high)]).max())

    own = TRANSITION[passengers]
    rolling = own.d * np.degrees(largest(roll, start, end)) ** own.e
    sideways = own.a * largest(y, start, end + AFTER) + own.b * largest(jerk, start - BEFORE, end) - own.c
    return max(sideways, 0.0) + float(rolling)


def event_discomfort(acceleration: Array, interval: float, passengers: Passengers = "standing") -> Array:
    """P_DE, per cent, around each sample (n,), by the range and the mean of the acceleration over 2 s.

    Parameters:
        acceleration: (n,) m/s2, lateral, as of `lateral`; n at least 2 s.
        interval: s.
        passengers: standing or seated.

    Raises ValueError for a shorter signal.
    """
    length = round(WINDOW / interval)
    if len(acceleration) < length:
        raise ValueError(f"{interval * len(acceleration):.3g} s of signal: must be {WINDOW:g} s at least")
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(acceleration, length // 2, mode="edge"), length)
    windows, own = windows[: len(acceleration)], EVENT[passengers]
    span = windows.max(axis=1) - windows.min(axis=1)
    return np.asarray(np.maximum(own.a * span + own.b * np.abs(windows.mean(axis=1)) - own.c, 0.0))
