"""Measured tracks: columns of EN 13848-1 as the four irregularities, gaps, wavelength bands, chords, quality classes.

The texts of EN 13848 were not available: bands and classes are from memory and not confirmed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from wheelrail.support.arrays import Array

Band = tuple[float, float]  # shortest and longest wavelength, m
Gaps = Literal["refuse", "close", "fade"]

BANDS: Mapping[str, Band] = {"D1": (3.0, 25.0), "D2": (25.0, 70.0), "D3": (70.0, 150.0)}
EDGES = (1.1, 1.5)  # ratios of wavelengths over which a filter falls from 1 to 0; a sharp long end would ring for 300 m
GAP = 4.0  # usual steps of chainage that are a gap
LEAST_RESPONSE = 0.25  # of a chord to a wavelength that is to be corrected, times the gain of the band
TOLERANCE, SHARE = 0.2e-3, 0.2  # m, and share of the rms: of differences between columns that should agree


class MeasurementError(ValueError):
    """A measured track that cannot be used; the message names columns or places and what is allowed."""


def quantities(stations: Array, columns: Mapping[str, Array], twist_base: float = 3.0) -> Array:
    """Alignment, level, cross level and gauge (n, 4) m of the columns of a measurement; missing quantities are zero.

    Parameters:
        stations: (n,) m, increasing.
        columns: (n,) m by name: the four quantities, level_left, level_right, alignment_left, alignment_right; twist,
            per metre of its base.
        twist_base: m.

    The cross level is the right rail above the left, the gauge its widening. Raises MeasurementError for one rail
    without the other or the difference, twist without cross level, and columns that contradict each other between 3 and
    25 m.
    """
    level, cross = _of_rails(stations, columns, "level", "cross_level", 1.0)
    alignment, gauge = _of_rails(stations, columns, "alignment", "gauge", -1.0)
    if "twist" in columns:
        if cross is None:
            raise MeasurementError("column twist: needs cross_level, or level_left and level_right")
        half = 0.5 * twist_base
        ahead, behind = (np.interp(stations + shift, stations, cross) for shift in (half, -half))
        inside = (stations >= stations[0] + half) & (stations <= stations[-1] - half)
        found = np.where(inside, (ahead - behind) / twist_base, columns["twist"])
        _agree(
            stations, ("twist", f"the change of cross level over {twist_base:g} m"), columns["twist"], found, twist_base
        )
    zero = np.zeros(len(stations))
    return np.stack([zero if own is None else own for own in (alignment, level, cross, gauge)], axis=1)


def _of_rails(
    stations: Array, columns: Mapping[str, Array], mean: str, difference: str, sign: float
) -> tuple[Array | None, Array | None]:
    """Mean, and difference right minus left times sign, of both rails; None without a column."""
    sides = [columns.get(f"{mean}_{side}") for side in ("left", "right")]
    left, right, own, across = *sides, columns.get(mean), columns.get(difference)
    if left is None and right is None:
        return own, across
    if left is None or right is None:
        given, missing = ("left", "right") if right is None else ("right", "left")
        if across is None:
            raise MeasurementError(f"column {mean}_{given}: needs {mean}_{missing} or {difference}")
        if right is None:
            assert left is not None
            right = left + sign * across
        else:
            left = right - sign * across
    assert left is not None
    found = 0.5 * (left + right), sign * (right - left)
    for name, given_column, of_rails in ((mean, own, found[0]), (difference, across, found[1])):
        if given_column is not None:
            _agree(stations, (name, f"{mean}_left and {mean}_right"), given_column, of_rails, 1.0)
    return found[0] if own is None else own, found[1] if across is None else across


def _agree(stations: Array, names: tuple[str, str], first: Array, second: Array, base: float) -> None:
    """Raise MeasurementError for columns that differ between 3 and 25 m; base: m, over which a difference counts."""
    filtered = band_passed(stations, np.stack([first, second], axis=1), BANDS["D1"])[1]
    rms = np.sqrt(np.mean(filtered**2, axis=0))
    difference = np.abs(filtered[:, 0] - filtered[:, 1])
    allowed, found = TOLERANCE / base + SHARE * float(rms.max()), float(np.sqrt(np.mean(difference**2)))
    if found > allowed:
        worst = float(np.interp(np.argmax(difference), [0, len(difference) - 1], stations[[0, -1]]))
        what, unit = f"columns {names[0]} and {names[1]} contradict each other", "mm" if base == 1.0 else "mm/m"
        raise MeasurementError(
            f"{what}: rms difference {1e3 * found:.2g} {unit} between 3 and 25 m, must be at most {1e3 * allowed:.2g}; "
            f"largest near s = {worst:.0f} m"
        )


def gaps_in(stations: Array) -> list[int]:
    """Indices of the stations before a gap of chainage, a step of more than four usual ones."""
    steps = np.diff(stations)
    return list(map(int, np.flatnonzero(steps > GAP * float(np.median(steps)))))


def without_gaps(stations: Array, values: Array, mode: Gaps, fade: float = 10.0) -> tuple[Array, Array]:
    """Stations (m,) m and values (m, k) without gaps of chainage.

    Parameters:
        stations, values: (n,) m and (n, k), as measured.
        mode: "close": the chainage jumps and the track goes on; "fade": values are zero in the gap and fade to zero
            before and after; "refuse": none is allowed.
        fade: length, m.

    Raises MeasurementError for a gap that is refused.
    """
    gaps, step = gaps_in(stations), float(np.median(np.diff(stations)))
    if not gaps:
        return stations, values
    if mode == "refuse":
        i = gaps[0]
        raise MeasurementError(
            f"gap of chainage from s = {stations[i]:g} to {stations[i + 1]:g} m ({len(gaps)} in all), of more than "
            f'{GAP:g} steps of {step:g} m: must have none, or gaps = "close" or "fade"'
        )
    if mode == "close":
        jumps = np.zeros(len(stations))
        for i in gaps:
            jumps[i + 1 :] += stations[i + 1] - stations[i] - step
        return stations - jumps, values
    weight = np.ones(len(stations))
    for i in gaps:
        away = np.where(np.arange(len(stations)) <= i, stations[i] - stations, stations - stations[i + 1])
        x = np.clip(away / fade, 0.0, 1.0)
        weight = np.minimum(weight, x * x * (3.0 - 2.0 * x))
    pieces, filled = np.split(np.arange(len(stations)), np.array(gaps) + 1), list[Array]()
    zeros = list[Array]()
    for before, after in zip(pieces, [*pieces[1:], None], strict=True):
        filled.append(stations[before])
        zeros.append(values[before] * weight[before, None])
        if after is not None:
            inner = np.arange(stations[before[-1]] + step, stations[after[0]] - 0.5 * step, step)
            filled.append(inner)
            zeros.append(np.zeros((len(inner), values.shape[1])))
    return np.concatenate(filled), np.concatenate(zeros)


def _evenly(stations: Array, values: Array) -> tuple[Array, Array]:
    """Stations at equal steps, and values (m, k) there by a cubic spline."""
    step = float(np.median(np.diff(stations)))
    count = int((stations[-1] - stations[0]) / step * (1.0 + 1e-12)) + 1
    even = stations[0] + step * np.arange(count)
    if count == len(stations) and np.abs(even - stations).max() < 1e-6 * step:
        return stations, values
    from scipy.interpolate import CubicSpline

    return even, np.asarray(CubicSpline(stations, values)(even))


def _gain(wavenumber: Array, band: Band) -> Array:
    """1 in a band of wavelengths m, falling to 0 over `EDGES` by a cosine of the logarithm; wavenumber: 1/m."""
    k = np.maximum(wavenumber, 1e-300)
    beyond = np.maximum(np.log(band[0] * k) / np.log(EDGES[0]), -np.log(band[1] * k) / np.log(EDGES[1]))
    return np.asarray(0.5 + 0.5 * np.cos(np.pi * np.clip(beyond, 0.0, 1.0)))


def chord_response(wavenumber: Array, parts: tuple[float, float]) -> Array:
    """Response of a measurement over a chord to waves of wavenumbers (...) 1/m, complex.

    Parameters:
        wavenumber: 1/m.
        parts: of the chord, m, behind and ahead of the measured point: offset from the chord through both ends.
    """
    behind, ahead = parts
    k = 2.0 * np.pi * wavenumber
    return np.asarray(1.0 - (ahead * np.exp(-1j * k * behind) + behind * np.exp(1j * k * ahead)) / (behind + ahead))


def band_passed(
    stations: Array, values: Array, band: Band, chord: tuple[float, float] | None = None
) -> tuple[Array, Array]:
    """Stations at equal steps, and values (m, k) there with the wavelengths of a band, without shift of phase.

    Parameters:
        stations, values: (n,) m, and (n, k).
        band: wavelengths, m.
        chord: parts of the chord of the measurement, whose response is taken out; None: an inertial measurement.

    At both ends the values are continued by their point reflection. Raises MeasurementError for a chord that responds
    to a wavelength of the band by less than a quarter, and for steps above a quarter of the shortest wavelength.
    """
    even, values = _evenly(stations, values)
    step = float(even[1] - even[0])
    if step > 0.25 * band[0]:
        raise MeasurementError(
            f"steps of {step:g} m: must be at most a quarter of the shortest wavelength, {band[0]:g} m"
        )
    margin = min(len(even) - 1, int(np.ceil(2.0 * band[1] / step)))
    longer = np.concatenate(
        [2 * values[:1] - values[margin:0:-1], values, 2 * values[-1:] - values[-2 : -margin - 2 : -1]]
    )
    wavenumber = np.fft.rfftfreq(len(longer), step)
    response = _gain(wavenumber, band).astype(complex)
    if chord is not None:
        _check_chord(chord, band)
        used = np.abs(response) > 0.0
        response[used] /= chord_response(wavenumber[used], chord)
    found = np.fft.irfft(np.fft.rfft(longer, axis=0) * response[:, None], len(longer), axis=0)
    return even, np.asarray(found[margin : margin + len(even)])


def _check_chord(chord: tuple[float, float], band: Band) -> None:
    lengths = np.geomspace(band[0] / EDGES[0], band[1] * EDGES[1], 2000)
    response = np.abs(chord_response(1.0 / lengths, chord))
    weak = lengths[response < LEAST_RESPONSE * _gain(1.0 / lengths, band)]
    if len(weak):
        raise MeasurementError(
            f"chord of {chord[0]:g} + {chord[1]:g} m: shows waves of {weak.min():.3g} to {weak.max():.3g} m by less "
            f"than {100 * LEAST_RESPONSE:g} %; must have a band without these, or other parts"
        )
