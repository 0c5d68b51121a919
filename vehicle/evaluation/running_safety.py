"""Running safety and track loading of a run after EN 14363: filters, sliding means, percentiles, limits.

The text of the standard was not available. The sliding mean over 2 m with the percentiles 0.15 and 99.85 %, the limit
of the sum of Y and that of Y/Q stand in two public texts (GENSYS, railwaynews.net), the filter of 20 Hz and the band of
2 Hz in one; the order of the filter and the limits of Q and of instability are from memory, those of UIC 518.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array

INTERVAL = 2e-3  # s, of the samples that are filtered
CUTOFF, ORDER = 20.0, 4  # Hz, and order of the Butterworth low-pass filter
BAND = (0.4, 10.0)  # Hz, of accelerations, by a Butterworth filter of the same order
WINDOW, STEP = 2.0, 0.5  # m, of the sliding mean
PERCENTILES = (0.15, 99.85)
QUOTIENT_LIMIT = 0.8  # of Y/Q
INSTABILITY_WINDOW, INSTABILITY_STEP, HALF_BAND = 100.0, 10.0, 2.0  # m, m, Hz


@dataclass(frozen=True)
class Assessed:
    """An assessed quantity.

    Parameters:
        value: NaN where the section is too short for it.
        place: m along the track, of the largest value; of a mean the middle of its window.
        limit: of the magnitude.
    """

    value: float
    place: float
    limit: float

    @property
    def passed(self) -> bool | None:
        """Whether the limit is kept; None without a value."""
        return abs(self.value) <= self.limit if np.isfinite(self.value) else None


@dataclass(frozen=True)
class WheelsetSafety:
    """Assessed quantities of a wheelset over a section of track.

    Parameters:
        track_shifting: N, sum of Y: the percentile of its 2 m mean that is largest in magnitude; at most
            alpha (10 kN + P0 / 3) with the static axle load P0.
        quotient: Y/Q of the left and right wheel, 99.85th percentiles of the 2 m means; at most 0.8.
        load: N, Q of the left and right wheel, 99.85th percentiles; at most the smaller of 90 kN + Q0 and 200 kN down
            to 160 kN by speed.
        instability: N, largest rms of the sum of Y over 100 m within 2 Hz of its main frequency; at most half the limit
            of the sum of Y; NaN for a section that is shorter.
    """

    track_shifting: Assessed
    quotient: tuple[Assessed, Assessed]
    load: tuple[Assessed, Assessed]
    instability: Assessed


def wheelset_safety(
    time: Array, distance: Array, guiding: Array, load: Array, static_wheel_load: float, alpha: float = 1.0
) -> WheelsetSafety:
    """Assessment of one wheelset.

    Parameters:
        time: (n,) s, increasing; values between are interpolated.
        distance: (n,) m along the track.
        guiding: (n, 2) N, Y of the left and right wheel, positive outwards.
        load: (n, 2) N, Q.
        static_wheel_load: Q0, N.
        alpha: 1 for locomotives and passenger vehicles, 0.85 for freight wagons.

    Raises ValueError for less than 2 m of track.
    """
    samples = np.arange(time[0], time[-1], INTERVAL)
    y, q = (
        np.stack([low_pass(np.interp(samples, time, column)) for column in wheels.T], 1) for wheels in (guiding, load)
    )
    places, shifting = np.interp(samples, time, distance), y[:, 1] - y[:, 0]
    limit = track_shifting_limit(static_wheel_load, alpha)
    means = sliding_mean(places, shifting)
    low, high = np.percentile(means, PERCENTILES).tolist()
    largest = np.argmin(means) if abs(low) > abs(high) else np.argmax(means)
    ratios = [sliding_mean(places, y[:, side] / np.maximum(q[:, side], 1.0)) for side in (0, 1)]
    speed = float((distance[-1] - distance[0]) / (time[-1] - time[0]))
    load_limit = min(90e3 + static_wheel_load, largest_wheel_load(speed))
    left, right = (
        Assessed(float(np.percentile(ratio, PERCENTILES[1])), _middle(places, int(np.argmax(ratio))), QUOTIENT_LIMIT)
        for ratio in ratios
    )
    left_load, right_load = (
        Assessed(float(np.percentile(q[:, side], PERCENTILES[1])), float(places[np.argmax(q[:, side])]), load_limit)
        for side in (0, 1)
    )
    return WheelsetSafety(
        track_shifting=Assessed(max(low, high, key=abs), _middle(places, int(largest)), limit),
        quotient=(left, right),
        load=(left_load, right_load),
        instability=Assessed(*instability(places, shifting), 0.5 * limit),
    )


def _middle(distance: Array, index: int, window: float = WINDOW, step: float = STEP) -> float:
    """Place m of the middle of a window of `sliding_mean`."""
    return float(distance[0] + index * step + 0.5 * window)


def track_shifting_limit(static_wheel_load: float, alpha: float) -> float:
    """Limit of the sum of Y, N, by the static wheel load N and the factor of the kind of vehicle."""
    return alpha * (10e3 + 2.0 * static_wheel_load / 3.0)


def largest_wheel_load(speed: float) -> float:
    """Upper limit of Q, N, by the speed m/s."""
    bounds = ((160.0, 200e3), (200.0, 190e3), (250.0, 180e3), (300.0, 170e3))  # km/h, N
    return next((limit for bound, limit in bounds if 3.6 * speed <= bound), 160e3)


def low_pass(signal: Array, cutoff: float = CUTOFF) -> Array:
    """Signal (n,), sampled every 2 ms, after the low-pass filter of a corner frequency, Hz; it starts at the steady
    state of the first value.
    """
    return _filtered(signal, cutoff, "lowpass")


def band_pass(signal: Array) -> Array:
    """Signal (n,), sampled every 2 ms, from 0.4 to 10 Hz; it starts at the steady state of the first value."""
    return _filtered(signal, BAND, "bandpass")


def _filtered(signal: Array, corners: float | tuple[float, float], kind: str) -> Array:
    from scipy.signal import butter, sosfilt, sosfilt_zi

    sections = butter(ORDER, corners, kind, fs=1.0 / INTERVAL, output="sos")
    filtered, _ = sosfilt(sections, signal, zi=sosfilt_zi(sections) * signal[0])
    return np.asarray(filtered)


def sliding_mean(distance: Array, signal: Array, window: float = WINDOW, step: float = STEP) -> Array:
    """Means over windows that begin every `step`, of the linear interpolation of a signal.

    Parameters:
        distance: (n,) m, increasing.
        signal: (n,).
        window, step: m.

    Raises ValueError for a signal shorter than the window.
    """
    if distance[-1] - distance[0] < window:
        raise ValueError(f"{distance[-1] - distance[0]:.3g} m of track: must be {window:g} m at least")
    starts = np.arange(distance[0], distance[-1] - window * (1 - 1e-12), step)
    return np.asarray((_integral(distance, signal, starts + window) - _integral(distance, signal, starts)) / window)


def _integral(distance: Array, signal: Array, ends: Array) -> Array:
    """Integrals (m,) of a piecewise linear signal from the first distance to ends (m,)."""
    lengths = np.diff(distance)
    areas = np.append(0.0, np.cumsum(0.5 * lengths * (signal[1:] + signal[:-1])))
    piece = np.clip(np.searchsorted(distance, ends, side="right") - 1, 0, len(lengths) - 1)
    x = ends - distance[piece]
    return np.asarray(areas[piece] + x * (signal[piece] + 0.5 * x * np.diff(signal)[piece] / lengths[piece]))


def instability(distance: Array, shifting: Array) -> tuple[float, float]:
    """Largest rms, N, over 100 m of the sum of Y within 2 Hz of its main frequency, and the middle of this window; NaN
    for less than 100 m.

    Parameters:
        distance: (n,) m, at equal times of 2 ms.
        shifting: (n,) N.
    """
    values, places = instability_history(distance, shifting)
    if not len(values):
        return float("nan"), float("nan")
    worst = int(np.argmax(values))
    return float(values[worst]), float(places[worst])


def instability_history(distance: Array, shifting: Array) -> tuple[Array, Array]:
    """The same rms (m,) N of all windows and their middles (m,) m; none for less than 100 m."""
    if distance[-1] - distance[0] < INSTABILITY_WINDOW:
        return np.empty(0), np.empty(0)
    spectrum = np.fft.rfft(shifting - shifting.mean())
    frequency = np.fft.rfftfreq(len(shifting), INTERVAL)
    main = frequency[np.argmax(np.abs(spectrum))]
    near = np.fft.irfft(np.where(np.abs(frequency - main) <= HALF_BAND, spectrum, 0.0), len(shifting))
    squares = sliding_mean(distance, near**2, INSTABILITY_WINDOW, INSTABILITY_STEP)
    middles = distance[0] + INSTABILITY_STEP * np.arange(len(squares)) + 0.5 * INSTABILITY_WINDOW
    return np.sqrt(squares), np.asarray(middles)
