"""Extreme values of a run and the distances at which they occur."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import trapezoid

from wheelrail.scenes.html_report.elements import PageTable, number
from wheelrail.scenes.plots.runs import CHORD, named
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import DataArray, Dataset


def lateral_over_vertical(wheel_data: Dataset) -> Array:
    """Derailment quotient |Y| / Q (n,) of one wheel, NaN without contact."""
    y, q = wheel_data["lateral_force"].values, wheel_data["vertical_force"].values
    return np.asarray(np.divide(np.abs(y), q, out=np.full(len(y), np.nan), where=q > 0.0))


def _of(name: str, scale: float = 1.0) -> Callable[[Dataset], Array]:
    """Scaled values (n,) of a variable; the maximum over patches at each time."""

    def values(data: Dataset) -> Array:
        scaled = scale * data[name]
        return np.asarray(scaled.max("patch").values if "patch" in scaled.dims else scaled.values, dtype=float)

    return values


Row = tuple[str, str, Callable[["Dataset"], Array], str]  # label, required variable, values, kind of extreme
WHEELS: tuple[Row, ...] = (
    ("lateral force Y, largest magnitude [kN]", "lateral_force", _of("lateral_force", 1e-3), "largest"),
    ("vertical force Q, maximum [kN]", "vertical_force", _of("vertical_force", 1e-3), "greatest"),
    ("vertical force Q, minimum [kN]", "vertical_force", _of("vertical_force", 1e-3), "least"),
    ("|Y| / Q, maximum [1]", "lateral_force", lateral_over_vertical, "greatest"),
    ("longitudinal force X, largest magnitude [kN]", "longitudinal_force", _of("longitudinal_force", 1e-3), "largest"),
    ("peak pressure, maximum [MPa]", "patch_max_pressure", _of("patch_max_pressure", 1e-6), "greatest"),
    ("simultaneous patches, maximum [1]", "patches", _of("patches"), "greatest"),
    ("T-gamma, frictional energy per metre, maximum [N]", "t_gamma", _of("t_gamma"), "greatest"),
    ("utilisation T / N of a patch, maximum [1]", "patch_utilisation", _of("patch_utilisation"), "greatest"),
    ("load factor p₀ / k of a patch, maximum [1]", "patch_load_factor", _of("patch_load_factor"), "greatest"),
    (
        "surface fatigue index, maximum [1]; above 0: ratcheting",
        "patch_surface_fatigue_index",
        _of("patch_surface_fatigue_index"),
        "greatest",
    ),
)


def extreme_tables(data: Dataset) -> list[PageTable]:
    """Extremes of the wheelsets, of the wheels of each, and of all bodies."""
    wheels = [wheel_table(data.sel(wheelset=name), str(name)) for name in data["wheelset"].values]
    return [wheelset_table(data), *wheels, body_table(data)]


def wheel_table(data: Dataset, caption: str) -> PageTable:
    """Extremes of the wheels of a wheelset with their distances, m, left and right."""
    sides = [str(side) for side in data["side"].values]
    head = ["quantity", *(text for side in sides for text in (f"{named(side, data)} wheel", "at [m]"))]
    rows = [
        [row[0], *(cell for side in sides for cell in extreme(data.sel(side=side), row))]
        for row in WHEELS
        if row[1] in data
    ]
    return PageTable(caption, head, [*rows, *_averages(data, sides)], frozenset(range(1, len(head))))


def wheelset_table(data: Dataset) -> PageTable:
    """Extremes of every wheelset."""
    names = [str(name) for name in data["wheelset"].values]
    y = data["body_y"].sel(body=data["wheelset"].values)
    yaw = data["body_yaw"].sel(body=data["wheelset"].values)
    force, quotient = data["guiding_force"].max("side"), data["derailment_quotient"].max("side")
    rows = [
        ["sum of Y, largest magnitude, positive to the right [kN]", *_largest(data["track_shifting_force"], 1e-3)],
        ["guiding force Y of a wheel, maximum [kN]", *map(number, 1e-3 * force.max("time").values)],
        ["derailment quotient Y/Q of a wheel, maximum [1]", *map(number, quotient.max("time").values)],
        ["unloading of a wheel, maximum [%]", *map(number, 100 * data["wheel_unloading"].max(["time", "side"]).values)],
        ["T-gamma of both wheels, maximum [N]", *map(number, data["t_gamma"].sum("side").max("time").values)],
        ["lateral displacement, largest magnitude, positive to the left [mm]", *_largest(y, 1e3)],
        ["yaw, largest magnitude, positive to the left [mrad]", *_largest(yaw, 1e3)],
    ]
    return PageTable("Wheelsets", ["quantity", *names], rows, frozenset(range(1, len(names) + 1)))


def body_table(data: Dataset) -> PageTable:
    """Largest magnitudes of the coordinates of all bodies."""
    columns = {"x": 1e3, "y": 1e3, "z": 1e3, "roll": 1e3, "pitch": 1e3, "yaw": 1e3}
    head = ["body", *(f"{name} [{'mm' if name in 'xyz' else 'mrad'}]" for name in columns)]
    cells = {name: _largest(data[f"body_{name}"], scale) for name, scale in columns.items()}
    rolls = np.isin(data["body"].values, data["wheelset"].values)
    cells["pitch"] = ["–" if turns else text for turns, text in zip(rolls, cells["pitch"], strict=True)]
    rows = [[str(name), *values] for name, *values in zip(data["body"].values, *cells.values(), strict=True)]
    caption = f"Largest magnitudes of the coordinates, each body in the track frame at its own distance; {CHORD}"
    return PageTable(caption, head, rows, frozenset(range(1, len(head))))


def _largest(values: DataArray, scale: float) -> list[str]:
    """Values of the largest magnitude over time, scaled; values: (time, n)."""
    samples = np.nan_to_num(values.transpose("time", ...).values)
    return [number(scale * column[np.argmax(np.abs(column))]) for column in samples.T]


def extreme(data: Dataset, row: Row) -> tuple[str, str]:
    """Extreme value and its distance, m, as text."""
    _, _, of, kind = row
    values = of(data)
    finite = np.isfinite(values)
    if not finite.any():
        return number(np.nan), number(np.nan)
    key = {"largest": np.abs(values), "greatest": values, "least": -values}[kind]
    at = int(np.argmax(np.where(finite, key, -np.inf)))
    return number(values[at]), f"{float(data['distance'].values[at]):.1f}"


def _averages(data: Dataset, sides: list[str]) -> Iterator[list[str]]:
    """Values over the whole distance."""
    distance = data["distance"].values
    separated = [100.0 * float((~data["in_contact"].sel(side=side).values.astype(bool)).mean()) for side in sides]
    yield ["samples without contact [%]", *(cell for percent in separated for cell in (number(percent, 3), ""))]
    if "t_gamma" in data and distance[-1] > distance[0]:
        mean = [
            float(trapezoid(data["t_gamma"].sel(side=side).values, distance) / (distance[-1] - distance[0]))
            for side in sides
        ]
        yield ["T-gamma, mean over distance [N]", *(cell for value in mean for cell in (number(value), ""))]
