"""How far apart two runs of the same track are, channel by channel, as they are: nothing shifted, nothing filtered."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from rich.table import Table
    from xarray import Dataset


# Label, variable, whether it has a side, scale, unit.
CHANNELS = (
    ("wheelset y", "wheelset_y", False, 1e3, "mm"),
    ("wheelset z", "wheelset_z", False, 1e3, "mm"),
    ("wheelset roll", "wheelset_roll", False, 1e3, "mrad"),
    ("bogie y", "bogie_y", False, 1e3, "mm"),
    ("bogie roll", "bogie_roll", False, 1e3, "mrad"),
    ("car body y", "car_body_y", False, 1e3, "mm"),
    ("car body roll", "car_body_roll", False, 1e3, "mrad"),
    ("bumpstop force", "bumpstop_force", False, 1e-3, "kN"),
    ("longitudinal force", "longitudinal_force", True, 1e-3, "kN"),
    ("lateral force", "lateral_force", True, 1e-3, "kN"),
    ("vertical force", "vertical_force", True, 1e-3, "kN"),
    ("T-gamma", "t_gamma", True, 1.0, "N"),
)
WINDOW = 0.1  # s, over which a force is taken as a parabola when its scatter is looked for


@dataclass(frozen=True)
class RunDifference:
    """RMS and worst difference of a channel in its unit, the distance m where it is worst, and the channel's range in
    the first run, largest less smallest value.
    """

    channel: str
    unit: str
    rms: float
    worst: float
    at: float
    span: float


def channels(data: Dataset) -> Iterator[tuple[str, str, Array]]:
    """Label, unit and values (n,) of every channel, those of the two wheels one after the other."""
    for label, name, sided, scale, unit in CHANNELS:
        for side in data["side"].values if sided else (None,):
            values = data[name] if side is None else data[name].sel(side=side)
            yield label if side is None else f"{label}, {side}", unit, scale * values.values


def differences(one: Dataset, other: Dataset) -> list[RunDifference]:
    """Of all channels, other less one, at the samples of the first run that the second one reached.

    Between its own samples the second run is taken as straight lines.
    """
    time, there = one["time"].values, other["time"].values
    own = (time >= there[0]) & (time <= there[-1])
    distance, found = one["distance"].values[own], []
    for (label, unit, mine), (_, _, theirs) in zip(channels(one), channels(other), strict=True):
        apart = np.interp(time[own], there, theirs) - mine[own]
        worst = int(np.argmax(np.abs(apart)))
        rms = float(np.sqrt(_mean(time[own], apart**2)))
        found.append(
            RunDifference(label, unit, rms, float(abs(apart[worst])), float(distance[worst]), float(np.ptp(mine[own])))
        )
    return found


def scatter(time: Array, values: Array) -> Array:
    """What is left of values (n,) when the parabola through those within a tenth of a second is taken away."""
    left = np.zeros(len(time))
    for i, t in enumerate(time):
        near = np.flatnonzero(np.abs(time - t) <= 0.5 * WINDOW)
        if len(near) > 5:
            x = (time[near] - t) / WINDOW
            left[i] = values[i] - np.polyfit(x, values[near], 2)[-1]
    return left


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else np.nan


def settled(data: Dataset) -> NDArray[np.bool_]:
    """Samples (n,) in the second half of those with the sharpest curvature, where the motion has come to rest most."""
    curvature = np.abs(data["curvature"].values)
    full = np.flatnonzero(curvature >= (1 - 1e-6) * curvature.max(initial=0.0))
    inside = np.zeros(len(curvature), dtype=bool)
    inside[full[len(full) // 2 :]] = True
    return inside


def noise(data: Dataset) -> dict[str, tuple[float, float]]:
    """RMS scatter N of every wheel's vertical and lateral force, all along and where it has settled."""
    found = {}
    for name in ("vertical_force", "lateral_force"):
        for side in data["side"].values:
            left = scatter(data["time"].values, data[name].sel(side=side).values)
            found[f"{name.replace('_', ' ')}, {side}"] = (rms(left), rms(left[settled(data)]))
    return found


def table(found: list[RunDifference], names: tuple[str, str]) -> Table:
    """To read: a line for every channel."""
    from rich.table import Table

    view = Table(title=f"{names[1]} less {names[0]}; % of the range of {names[0]}", title_justify="left")
    for head in ("channel", "unit", "RMS", "worst", "at m", "range", "RMS %"):
        text = head in ("channel", "unit")
        view.add_column(head, justify="left" if text else "right", no_wrap=True)
    for d in found:
        share = f"{100 * d.rms / d.span:.2f}" if d.span > 0 else "-"
        view.add_row(d.channel, d.unit, f"{d.rms:.4g}", f"{d.worst:.4g}", f"{d.at:.1f}", f"{d.span:.4g}", share)
    return view


def _mean(time: Array, values: Array) -> float:
    """Over time: rows at accepted steps crowd where little happens."""
    if len(time) < 2:
        return float(values.mean())
    return float(trapezoid(values, time) / (time[-1] - time[0]))


def rows(found: list[RunDifference]) -> list[dict[str, Any]]:
    """For a file."""
    return [dict(d.__dict__) for d in found]
