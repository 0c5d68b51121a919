"""Quality of a track: standard deviations in wavelength bands with their classes, and spectral densities.

The text of EN 13848-6 was not available: classes are from memory and not confirmed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.measured_track import BANDS, band_passed

SECTION = 200.0  # m, of a quality class
# m, largest standard deviations in D1 of the classes A to D up to a speed, km/h; EN 13848-6, not confirmed.
CLASSES: Mapping[str, Mapping[float, tuple[float, ...]]] = {
    "level": {
        80.0: (1.25e-3, 1.75e-3, 2.75e-3, 3.75e-3),
        120.0: (0.75e-3, 1.10e-3, 1.80e-3, 2.50e-3),
        160.0: (0.65e-3, 0.85e-3, 1.40e-3, 1.85e-3),
        230.0: (0.60e-3, 0.75e-3, 1.15e-3, 1.60e-3),
        300.0: (0.40e-3, 0.55e-3, 0.85e-3, 1.15e-3),
    },
    "alignment": {
        80.0: (0.90e-3, 1.25e-3, 1.95e-3, 2.70e-3),
        120.0: (0.50e-3, 0.70e-3, 1.05e-3, 1.45e-3),
        160.0: (0.45e-3, 0.55e-3, 0.75e-3, 1.00e-3),
        230.0: (0.40e-3, 0.50e-3, 0.70e-3, 0.90e-3),
        300.0: (0.35e-3, 0.40e-3, 0.50e-3, 0.65e-3),
    },
}


class Quality(NamedTuple):
    """Standard deviations m of a section in the bands D1 to D3, of the worse rail, and the class in D1.

    Parameters:
        start, end: m.
        level, alignment: (3,) m; NaN where the section is shorter than the longest wavelength.
        classes: A to E of level and alignment at a speed; "-" above 300 km/h.
    """

    start: float
    end: float
    level: Array
    alignment: Array
    classes: tuple[str, str]


def quality(stations: Array, values: Array, speed: float, section: float = SECTION) -> list[Quality]:
    """Quality of successive sections; the last one, if shorter, is one of its own from half a length on.

    Parameters:
        stations, values: (n,) m and (n, 4) m as of `Irregularities`.
        speed: m/s.
        section: length, m.
    """
    rails = {
        "level": values[:, [1, 1]] + 0.5 * values[:, [2, 2]] * [-1.0, 1.0],
        "alignment": values[:, [0, 0]] + 0.5 * values[:, [3, 3]] * [1.0, -1.0],
    }
    length = float(stations[-1] - stations[0])
    filtered = {
        name: [band_passed(stations, own, band) if band[1] <= length else None for band in BANDS.values()]
        for name, own in rails.items()
    }
    count = max(int(length / section + 0.5), 1)
    edges = np.append(stations[0] + section * np.arange(count), stations[-1])
    found = []
    for start, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        deviations = {
            name: np.array([_deviation(own, start, end) for own in bands]) for name, bands in filtered.items()
        }
        level, alignment = (quality_class(name, float(own[0]), speed) for name, own in deviations.items())
        found.append(Quality(start, end, deviations["level"], deviations["alignment"], (level, alignment)))
    return found


def _deviation(filtered: tuple[Array, Array] | None, start: float, end: float) -> float:
    if filtered is None:
        return float("nan")
    stations, values = filtered
    return float(values[(stations >= start) & (stations <= end)].std(axis=0).max())


def quality_class(quantity: str, deviation: float, speed: float) -> str:
    """Class A to E by the standard deviation m of "level" or "alignment" in D1, at a speed m/s; "-" where unknown."""
    bounds = next((own for limit, own in CLASSES[quantity].items() if 3.6 * speed <= limit), None)
    if bounds is None or not np.isfinite(deviation):
        return "-"
    return "ABCDE"[int(np.searchsorted(bounds, deviation))]


def spectral_density(stations: Array, values: Array, segment: float = 100.0) -> tuple[Array, Array]:
    """One-sided densities (m, k) m2/(rad/m) of values (n, k) m over wave numbers (m,) rad/m, without that of zero.

    Parameters:
        stations: (n,) m, at equal steps.
        values: (n, k) m.
        segment: length m of the overlapping pieces with Hann's window whose periodograms are averaged; a shorter track
            has one.
    """
    step = float(stations[1] - stations[0])
    size = min(round(segment / step), len(stations))
    window = np.hanning(size + 1)[:-1]
    starts = range(0, len(stations) - size + 1, max(size // 2, 1))
    pieces = np.array([values[i : i + size] - values[i : i + size].mean(axis=0) for i in starts])
    power = np.mean(np.abs(np.fft.rfft(pieces * window[:, None], axis=1)) ** 2, axis=0)
    density = power * step / (np.pi * float(window @ window))
    return 2.0 * np.pi * np.fft.rfftfreq(size, step)[1:], density[1:]
