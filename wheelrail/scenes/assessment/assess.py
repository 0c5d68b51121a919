"""Assessment of one or several runs of a vehicle."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from wheelrail.scenes.assessment.signals import signals_of
from wheelrail.scenes.datasets.run_file import RESULTS, read_run
from wheelrail.scenes.runs.safety_table import Safety, safety_of_data
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.arrays import Array
from wheelrail.vehicle.evaluation.comfort import BLOCK, mean_comfort, sperling_comfort
from wheelrail.vehicle.evaluation.criteria import CRITERIA, ZONES
from wheelrail.vehicle.evaluation.curve_comfort import (
    WINDOW,
    Passengers,
    event_discomfort,
    lateral,
    transition_discomfort,
)
from wheelrail.vehicle.evaluation.estimates import Estimate, estimates_of
from wheelrail.vehicle.evaluation.on_track import SHORTEST, RunSignals, Section, sections_of
from wheelrail.vehicle.evaluation.running_safety import INTERVAL

BLOCKS = 60  # of 5 s, for the mean comfort
PASSENGERS: tuple[Passengers, Passengers] = ("standing", "seated")


@dataclass(frozen=True)
class Options:
    """Options of an assessment.

    Parameters:
        alpha: factor of the limit of the sum of Y: 1, for freight wagons 0.85.
        length: of all sections, m; None: by zone and speed.
        deficiency: of cant, m, for which curves are estimated; None: for their own.
        floor: height of the floor above top of rail, m.

    Raises SceneError for a value out of range.
    """

    alpha: float = 1.0
    length: float | None = None
    deficiency: float | None = None
    floor: float = 1.2

    def __post_init__(self) -> None:
        ranges = {"alpha": (0.1, 1.0), "length": (SHORTEST, 1e4), "deficiency": (-0.5, 0.5), "floor": (0.0, 5.0)}
        for name, (low, high) in ranges.items():
            value, unit = getattr(self, name), "" if name == "alpha" else " m"
            if value is not None and not low <= value <= high:
                raise SceneError(f"{name} = {value:g}{unit}: must be {low:g} to {high:g}{unit}")


class PointComfort(NamedTuple):
    """Comfort at a point of the floor over a run.

    Parameters:
        run, point: names.
        mean: N_MV; NaN for less than 5 s.
        lateral, vertical: Sperling's Wz.
        standing, seated: largest P_DE, per cent; NaN for less than 2 s.
        place: of the former along the track, m.
    """

    run: str
    point: str
    mean: float
    lateral: float
    vertical: float
    standing: float
    seated: float
    place: float


class TransitionComfort(NamedTuple):
    """P_CT, per cent, of a transition at its worst point.

    Parameters:
        run, point: names.
        start, end: of the transition, m.
        radius: of the curve, m.
        standing, seated: passengers.
    """

    run: str
    point: str
    start: float
    end: float
    radius: float
    standing: float
    seated: float


@dataclass(frozen=True)
class Assessment:
    """Results of an assessment.

    Parameters:
        options: of the assessment.
        runs: signals.
        sections: of all runs.
        estimates: the most critical signal of each criterion and zone.
        comfort, transitions: of all runs.
        safety: percentiles of whole runs with the places of their maxima, transitions included.
        remarks: what limits the results.
    """

    options: Options
    runs: Sequence[RunSignals]
    sections: Sequence[Section]
    estimates: Sequence[Estimate]
    comfort: Sequence[PointComfort]
    transitions: Sequence[TransitionComfort]
    safety: Sequence[Safety]
    remarks: Sequence[str]

    @property
    def exceeded(self) -> list[Estimate]:
        return [own for own in self.estimates if not own.passed]

    @property
    def missing(self) -> list[str]:
        """Zones of EN 14363 with fewer sections than needed."""
        counts = {zone: sum(own.zone == zone for own in self.sections) for zone in "1234"}
        return [f"zone {zone}: {n} of {ZONES[zone].sections}" for zone, n in counts.items() if n < ZONES[zone].sections]

    @property
    def verdict(self) -> str:
        """One sentence on the limits, one on the number of sections."""
        if not self.estimates:
            first = "Not assessed: no section."
        elif self.exceeded:
            which = "; ".join(f"{CRITERIA[own.criterion].label}, zone {own.zone}" for own in self.exceeded)
            first = f"Limits exceeded by {len(self.exceeded)} of {len(self.estimates)} estimates: {which}."
        else:
            first = f"All {len(self.estimates)} estimates keep their limits."
        missing = f"No complete test, sections are missing: {', '.join(self.missing)}." if self.missing else ""
        return f"{first} {missing}".strip()


def assessment_of(files: Sequence[Path], options: Options = Options()) -> Assessment:
    """Assessment of runs of one vehicle.

    Parameters:
        files: run.nc, or their folders.
        options: of the assessment.

    Raises SceneError for files that are no runs, for runs of different vehicles, and without a file.
    """
    if not files:
        raise SceneError("runs: must be one at least")
    signals, remarks, safety, vehicles = list[RunSignals](), list[str](), list[Safety](), list[str]()
    for place in files:
        file = place / RESULTS if place.is_dir() else place
        data = read_run(file)
        vehicles.append(str(data.attrs["vehicle"]))
        if signals and (vehicles[-1] != vehicles[0] or data.attrs["mean_wheel_load"] != signals[0].wheel_load):
            raise SceneError(f"{file}: must be a run of the vehicle of {files[0]}")
        names = [own.name for own in signals]
        name = str(place.resolve().name if place.is_dir() else file.resolve().parent.name)
        name = name if name not in names else f"{name} ({len(names) + 1})"
        own, more = signals_of(data, file, name, options.floor)
        signals.append(own)
        remarks += more
        safety.append(safety_of_data(data, file, alpha=options.alpha))
    sections = list[Section]()
    for own in signals:
        found, more = sections_of(own, options.length)
        sections += found
        remarks += more
    estimates = estimates_of(sections, signals[0].wheel_load, options.alpha, options.deficiency)
    single = sorted({own.zone for own in estimates if own.number == 1})
    if single:
        remarks.append(f"Zones with one section have its value in place of an estimate: {', '.join(single)}")
    if options.deficiency is not None and not any(np.isfinite(own.two) for own in estimates):
        remarks.append("No two-dimensional estimate: it needs three sections of different cant deficiency in a zone")
    short = [own.name for own in signals if own.points and own.time[-1] - own.time[0] < BLOCKS * BLOCK]
    if short:
        remarks.append(f"Mean comfort needs {BLOCKS} blocks of {BLOCK:g} s; fewer: {', '.join(short)}")
    return Assessment(
        options,
        signals,
        sections,
        estimates,
        [row for own in signals for row in _comfort(own)],
        [row for own in signals for row in _transitions(own)],
        safety,
        remarks,
    )


def _comfort(signals: RunSignals) -> Iterator[PointComfort]:
    """Comfort at all points of a run."""
    duration = INTERVAL * len(signals.samples)
    for k, (point, offset) in enumerate(signals.points.items()):
        columns = [_level(signals.sampled(signals.acceleration[:, k, j])) for j in range(3)]
        mean = mean_comfort(np.stack(columns, axis=1), INTERVAL) if duration >= BLOCK else np.nan
        standing = seated = place = np.nan
        if duration >= WINDOW:
            sideways = _sideways(signals, k)
            events = event_discomfort(sideways, INTERVAL, "standing")
            standing, seated = float(events.max()), float(event_discomfort(sideways, INTERVAL, "seated").max())
            place = float(signals.places[int(np.argmax(events))]) + offset if standing > 0.0 else np.nan
        sideways_wz = sperling_comfort(columns[1], INTERVAL, "lateral")
        upwards_wz = sperling_comfort(columns[2], INTERVAL, "vertical")
        yield PointComfort(signals.name, point, mean, sideways_wz, upwards_wz, standing, seated, place)


def _level(signal: Array) -> Array:
    """Signal (n,) less the straight line from its first to its last value: continued periodically, it does not jump."""
    return np.asarray(signal - np.linspace(signal[0], signal[-1], len(signal)))


def _sideways(signals: RunSignals, point: int) -> Array:
    """Weighted lateral acceleration (m,) m/s2 of a point."""
    return lateral(signals.sampled(signals.acceleration[:, point, 1]), INTERVAL)


def _transitions(signals: RunSignals) -> Iterator[TransitionComfort]:
    """Comfort on the transitions into curves that a run has passed."""
    signal = [(_sideways(signals, k), signals.sampled(signals.roll_rate[:, k])) for k in range(len(signals.points))]
    reached = float(signals.places[-1])
    for before, after in pairwise(signals.parts):
        if abs(after.curvature) <= abs(before.curvature) or not signal:
            continue
        rows = []
        for (point, offset), (sideways, roll) in zip(signals.points.items(), signal, strict=True):
            low, high = before.end - offset, after.start - offset
            if not signals.places[0] <= low < high <= reached:
                continue
            start, end = (
                float(np.interp(s, signals.places, signals.samples) - signals.samples[0]) for s in (low, high)
            )
            standing, seated = (
                transition_discomfort(sideways, roll, INTERVAL, (start, end), who) for who in PASSENGERS
            )
            ends = before.end, after.start, 1.0 / abs(after.curvature)
            rows.append(TransitionComfort(signals.name, point, *ends, standing, seated))
        if rows:
            yield max(rows, key=lambda row: row.standing)
