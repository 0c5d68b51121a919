"""Sections of runs and their values after EN 14363.

Forces of a wheelset belong to its own place along the track. A section lies where curvature and cant are constant under
the whole vehicle; transitions have none.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.evaluation.criteria import CRITERIA, Criterion, section_length, zone_of
from wheelrail.vehicle.evaluation.running_safety import (
    INTERVAL,
    PERCENTILES,
    WINDOW,
    band_pass,
    instability_history,
    low_pass,
    sliding_mean,
)

SHORTEST = 2.0 * WINDOW  # m, of a section


class Part(NamedTuple):
    """Piece of track of constant curvature and cant: first and last place m, curvature 1/m, cant m as the height of the
    right rail.
    """

    start: float
    end: float
    curvature: float
    lift: float


def constant_parts(stations: Array, curvature: Array, lift: Array) -> list[Part]:
    """Pieces of constant curvature and superelevation.

    Parameters:
        stations: (n,) m, increasing.
        curvature: (n,) 1/m, positive to the left.
        lift: (n,) m, of the right rail above the left.
    """
    bounds = [1e-6 * max(float(np.abs(values).max()), least) for values, least in ((curvature, 1e-6), (lift, 1e-3))]
    changes = (np.abs(np.diff(curvature)) > bounds[0]) | (np.abs(np.diff(lift)) > bounds[1])
    edges = np.flatnonzero(np.diff(np.concatenate([[True], changes, [True]]).astype(int)))
    pairs = edges.reshape(-1, 2)
    return [
        Part(float(stations[i]), float(stations[j]), float(curvature[(i + j) // 2]), float(lift[(i + j) // 2]))
        for i, j in pairs.tolist()
        if j > i
    ]


@dataclass(frozen=True)
class RunSignals:
    """Signals of a run over time.

    Parameters:
        name: of the run.
        time: (n,) s, increasing.
        distance: (n,) m, of the vehicle's reference point along the track.
        wheelsets: places m along the vehicle, forward, by name.
        guiding: (n, w, 2) N, Y of the left and right wheels, positive outwards.
        load: (n, w, 2) N, Q.
        points: places m of points of bodies along the vehicle, by name.
        acceleration: (n, p, 3) m/s2 of these points in the body's axes, minus gravity; p may be 0.
        roll_rate: (n, p) rad/s of their bodies.
        parts: of the track.
        base: m, of the cant.
        gravity: m/s2.
        wheel_load: static one, N.
    """

    name: str
    time: Array
    distance: Array
    wheelsets: Mapping[str, float]
    guiding: Array
    load: Array
    points: Mapping[str, float]
    acceleration: Array
    roll_rate: Array
    parts: Sequence[Part]
    base: float
    gravity: float
    wheel_load: float

    @cached_property
    def samples(self) -> Array:
        """Times (m,) s, every 2 ms."""
        return np.arange(self.time[0], self.time[-1], INTERVAL)

    @cached_property
    def places(self) -> Array:
        """Distances (m,) m at the samples."""
        return np.interp(self.samples, self.time, self.distance)

    def sampled(self, values: Array) -> Array:
        """Values (m,) at the samples of values (n,)."""
        return np.interp(self.samples, self.time, values)

    @cached_property
    def forces(self) -> tuple[Array, Array]:
        """Filtered Y and Q (m, w, 2) N."""
        y, q = (
            np.stack([low_pass(self.sampled(column)) for column in values.reshape(len(values), -1).T], 1)
            for values in (self.guiding, self.load)
        )
        shape = (len(self.samples), len(self.wheelsets), 2)
        return y.reshape(shape), q.reshape(shape)

    @cached_property
    def filtered(self) -> Mapping[str, Array]:
        """Accelerations (m, p) m/s2: "lateral" and "vertical" from 0.4 to 10 Hz, "quasi-static" lateral up to 20 Hz."""
        columns = [[self.sampled(self.acceleration[:, k, j]) for k in range(len(self.points))] for j in (1, 2)]
        lateral, vertical = columns
        shape = (len(self.samples), len(self.points))
        return {
            "lateral": _stacked(map(band_pass, lateral), shape),
            "vertical": _stacked(map(band_pass, vertical), shape),
            "quasi-static": _stacked(map(low_pass, lateral), shape),
        }


def _stacked(columns: Iterator[Array], shape: tuple[int, int]) -> Array:
    found = list(columns)
    return np.stack(found, axis=1) if found else np.empty(shape)


class SectionValue(NamedTuple):
    """Value of a section and the place m of the largest magnitude."""

    value: float
    place: float


class Section(NamedTuple):
    """Section of a run.

    Parameters:
        run: its name.
        zone: of EN 14363.
        start, end: m, of the reference point.
        curvature: 1/m.
        deficiency: of cant, m, positive where the outer rail should be raised more.
        speed: m/s.
        values: by criterion and signal; "outer" and "inner" are wheels in a curve.
    """

    run: str
    zone: str
    start: float
    end: float
    curvature: float
    deficiency: float
    speed: float
    values: Mapping[str, Mapping[str, SectionValue]]

    @property
    def radius(self) -> float:
        """m; inf on straight track."""
        return 1.0 / abs(self.curvature) if self.curvature else float("inf")


def sections_of(signals: RunSignals, length: float | None = None) -> tuple[list[Section], list[str]]:
    """Sections of a run, and remarks on parts of the track without.

    Parameters:
        signals: of the run.
        length: of all sections, m; by default that of the zone.
    """
    sections, remarks = list[Section](), list[str]()
    offsets = [*signals.wheelsets.values(), *signals.points.values()]
    first, last = float(signals.places[0]), float(signals.places[-1])
    for part in signals.parts:
        start, end = max(part.start - min(offsets), first), min(part.end - max(offsets), last)
        inside = np.flatnonzero((signals.places >= start) & (signals.places <= end))
        if len(inside) < 2:
            continue
        speed = _speed(signals.places[inside])
        deficiency = _deficiency(signals, part, speed)
        zone = zone_of(part.curvature, deficiency)
        needed = section_length(zone, speed) if length is None else length
        count = int((end - start) / needed * (1.0 + 1e-9))
        if not count:
            where = f"{start:.0f} to {end:.0f} m" if end > start else f"near {start:.0f} m"
            remarks.append(
                f"{signals.name}: {where}, zone {zone}: {max(end - start, 0.0):.0f} m are no section of {needed:g} m"
            )
            continue
        edges = np.searchsorted(signals.places, start + needed * np.arange(count + 1))
        rms = _instability(signals, slice(int(inside[0]), int(inside[-1]) + 1))
        for i, j in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            speed = _speed(signals.places[i:j])
            values = dict(_values(signals, slice(i, j), part.curvature, rms, zone))
            bounds = float(signals.places[i]), float(signals.places[j - 1])
            sections.append(
                Section(signals.name, zone, *bounds, part.curvature, _deficiency(signals, part, speed), speed, values)
            )
    return sections, remarks


def _speed(places: Array) -> float:
    """Mean speed m/s over successive samples."""
    return float((places[-1] - places[0]) / (INTERVAL * (len(places) - 1)))


def _deficiency(signals: RunSignals, part: Part, speed: float) -> float:
    sign = -1.0 if part.curvature < 0.0 else 1.0
    return sign * (signals.base * speed**2 * part.curvature / signals.gravity - part.lift)


def _instability(signals: RunSignals, inside: slice) -> dict[str, tuple[Array, Array]]:
    y, places = signals.forces[0][inside], signals.places[inside]
    return {name: instability_history(places, y[:, k, 1] - y[:, k, 0]) for k, name in enumerate(signals.wheelsets)}


def _values(
    signals: RunSignals, inside: slice, curvature: float, rms: Mapping[str, tuple[Array, Array]], zone: str
) -> Iterator[tuple[str, dict[str, SectionValue]]]:
    """Values of a section by criterion and signal."""
    places, (y, q) = signals.places[inside], (values[inside] for values in signals.forces)
    sides = ("left", "right") if not curvature else ("inner", "outer") if curvature > 0.0 else ("outer", "inner")
    found: dict[str, dict[str, SectionValue]] = {key: {} for key, own in CRITERIA.items() if zone in own.zones}

    def put(key: str, signal: str, where: Array, values: Array, offset: float) -> None:
        if key in found and len(values):
            found[key][signal] = section_value(CRITERIA[key], where + offset, values)

    for k, (name, offset) in enumerate(signals.wheelsets.items()):
        shifting = y[:, k, 1] - y[:, k, 0]
        middles = places[0] + 0.5 * WINDOW + 0.5 * np.arange(len(sliding_mean(places, shifting)))
        put("track_shifting", name, middles, sliding_mean(places, shifting), offset)
        values, where = rms[name]
        here = (where >= places[0]) & (where <= places[-1])
        put("instability", name, where[here], values[here], offset)
        for side, label in enumerate(sides):
            signal = f"{name} {label}"
            ratio = y[:, k, side] / np.maximum(q[:, k, side], 1.0)
            put("quotient", signal, middles, sliding_mean(places, ratio), offset)
            put("load", signal, places, q[:, k, side], offset)
            put("quasi_static_guiding", signal, places, y[:, k, side], offset)
            put("quasi_static_load", signal, places, q[:, k, side], offset)
    for k, (name, offset) in enumerate(signals.points.items()):
        for axis in ("lateral", "vertical"):
            for kind in ("acceleration", "rms"):
                put(f"{axis}_{kind}", name, places, signals.filtered[axis][inside, k], offset)
        put("quasi_static_acceleration", name, places, signals.filtered["quasi-static"][inside, k], offset)
    yield from ((key, values) for key, values in found.items() if values)


def section_value(criterion: Criterion, places: Array, values: Array) -> SectionValue:
    """Magnitude of a section by the kind of a criterion, and the place of the largest magnitude.

    Parameters:
        criterion: assessed quantity.
        places: (n,) m.
        values: (n,), filtered.
    """
    magnitude = np.abs(values)
    if criterion.kind == "percentiles":
        value = float(np.abs(np.percentile(values, PERCENTILES)).max())
    elif criterion.kind == "median":
        value = abs(float(np.median(values)))
    elif criterion.kind == "rms":
        value = float(np.sqrt(np.mean(values**2)))
    else:
        value = float(magnitude.max())
    return SectionValue(value, float(places[int(np.argmax(magnitude))]))
