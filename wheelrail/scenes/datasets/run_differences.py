"""Differences of two runs on the same track by channel, without time shift or filter."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from wheelrail.scenes.datasets.result_table import Column, ResultTable
from wheelrail.scenes.quantities import AXES, RUN
from wheelrail.scenes.quantity import significant
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset


WINDOW = 0.1  # s, of the local parabolas whose residual is the noise


@dataclass(frozen=True)
class RunDifference:
    """Difference of one channel.

    Parameters:
        channel: its label.
        unit: of all values.
        rms: root mean square over time.
        worst: largest magnitude.
        at: distance at which it occurs, m.
        span: range of the channel in the first run.
    """

    channel: str
    unit: str
    rms: float
    worst: float
    at: float
    span: float


def wheels(data: Dataset) -> dict[str, dict[str, str]]:
    """Place of every wheel by its name: side, after the wheelset where there are several."""
    names = data["wheelset"].values.tolist()
    return {
        f"{name} {side}" if len(names) > 1 else side: {"wheelset": name, "side": side}
        for name in names
        for side in data["side"].values.tolist()
    }


def channels(data: Dataset) -> Iterator[tuple[str, str, Array]]:
    """Label, unit and values (n,) of every channel: bodies, elements, wheels."""
    for body in reversed(data["body"].values.tolist()):
        for axis in ("y", "z", "roll") if body in data["wheelset"] else ("y", "roll"):
            yield _channel(data, f"body_{axis}", {"body": body}, f"{body.replace('_', ' ')} {axis}")
    for element in data["element"].values.tolist():
        place = {"element": element, "axis": "y"}
        yield _channel(data, "element_force", place, f"{element.replace('_', ' ')} force")
    for name in (*(f"{axis}_force" for axis in AXES), "t_gamma"):
        for wheel, place in wheels(data).items():
            yield _channel(data, name, place, f"{RUN[name].label}, {wheel}")


def _channel(data: Dataset, name: str, place: Mapping[str, str], label: str) -> tuple[str, str, Array]:
    own = RUN[name]
    return label, own.shown, own.scale * data[name].sel(place).values


def differences(one: Dataset, other: Dataset) -> list[RunDifference]:
    """Differences of all channels, other minus one, at the common samples of the first run.

    The second run is interpolated linearly.
    """
    time, other_time = one["time"].values, other["time"].values
    own = (time >= other_time[0]) & (time <= other_time[-1])
    distance, result = one["distance"].values[own], []
    for (label, unit, first), (_, _, second) in zip(channels(one), channels(other), strict=True):
        difference = np.interp(time[own], other_time, second) - first[own]
        worst, span = int(np.argmax(np.abs(difference))), float(np.ptp(first[own]))
        rms = float(np.sqrt(_mean(time[own], difference**2)))
        result.append(RunDifference(label, unit, rms, float(abs(difference[worst])), float(distance[worst]), span))
    return result


def scatter(time: Array, values: Array) -> Array:
    """Residuals (n,) of values (n,) from local parabolas over 0.1 s; time (n,), s."""
    left = np.zeros(len(time))
    for i, t in enumerate(time):
        near = np.flatnonzero(np.abs(time - t) <= 0.5 * WINDOW)
        if len(near) > 5:
            x = (time[near] - t) / WINDOW
            left[i] = values[i] - np.polyfit(x, values[near], 2)[-1]
    return left


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else np.nan


def full_curve(data: Dataset) -> NDArray[np.bool_]:
    """Mask (n,) of the samples with the largest curvature, from the end of the transition on."""
    curvature = np.abs(data["curvature"].values)
    return np.asarray(curvature >= (1 - 1e-6) * curvature.max(initial=0.0))


def noise(data: Dataset) -> dict[str, tuple[float, float]]:
    """RMS noise of vertical and lateral force of each wheel, N, over the run and in the full curve."""
    values = {}
    for name in ("vertical_force", "lateral_force"):
        for wheel, place in wheels(data).items():
            residual = scatter(data["time"].values, data[name].sel(place).values)
            values[f"{RUN[name].label}, {wheel}"] = (rms(residual), rms(residual[full_curve(data)]))
    return values


def table(run_differences: list[RunDifference], names: tuple[str, str]) -> ResultTable:
    """Table with one row per channel, in its own unit; names: of both runs."""
    title = f"{names[1]} minus {names[0]}; % of the range of {names[0]}"
    return ResultTable("channels", title, _COLUMNS, run_differences)


_COLUMNS = (
    Column("channel", "channel", lambda d: d.channel),
    Column("unit", "unit", lambda d: d.unit),
    *(Column(name, "", attrgetter(name), "unit of the row") for name in ("rms", "worst", "span")),
    Column("", "RMS", lambda d: significant(d.rms, 4)),
    Column("", "maximum", lambda d: significant(d.worst, 4)),
    Column("at", "at", lambda d: d.at, "m", 1),
    Column("", "range", lambda d: significant(d.span, 4)),
    Column("", "RMS [%]", lambda d: f"{100 * d.rms / d.span:.2f}" if d.span > 0 else "-"),
)


def _mean(time: Array, values: Array) -> float:
    """Mean over time; accepted steps are not evenly spaced."""
    if len(time) < 2:
        return float(values.mean())
    return float(trapezoid(values, time) / (time[-1] - time[0]))
