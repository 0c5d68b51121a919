"""Extreme values of a run and their distances along the track."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import trapezoid

from wheelrail.scenes.html_report.elements import PageTable, number
from wheelrail.scenes.plots.runs import CHORD, named
from wheelrail.scenes.quantities import RUN
from wheelrail.scenes.studies.quantities import REDUCTIONS
from wheelrail.vehicle.multibody.vehicle import COORDINATES

if TYPE_CHECKING:
    from xarray import DataArray, Dataset


# Variables of the wheels and kinds of their extremes.
WHEELS = (
    ("lateral_force", "largest"),
    ("vertical_force", "greatest"),
    ("vertical_force", "least"),
    ("derailment_quotient", "greatest"),
    ("longitudinal_force", "largest"),
    ("patch_max_pressure", "greatest"),
    ("patches", "greatest"),
    ("t_gamma", "greatest"),
    ("patch_utilisation", "greatest"),
    ("patch_load_factor", "greatest"),
    ("patch_surface_fatigue_index", "greatest"),
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
        [_label(name, kind), *(cell for side in sides for cell in extreme(data.sel(side=side), name, kind))]
        for name, kind in WHEELS
        if name in data
    ]
    return PageTable(caption, head, [*rows, *_averages(data, sides)], frozenset(range(1, len(head))))


def wheelset_table(data: Dataset) -> PageTable:
    """Extremes of every wheelset."""
    names = [str(name) for name in data["wheelset"].values]
    of_wheels = {
        name: data[name].max("side") for name in ("guiding_force", "derailment_quotient", "wheel_unloading")
    } | {"t_gamma": data["t_gamma"].sum("side")}
    attitude = {name: data[name].sel(body=data["wheelset"].values) for name in ("body_y", "body_yaw")}
    rows = [
        [_label("track_shifting_force", "largest"), *_largest(data, "track_shifting_force")],
        *(
            [
                _label(name, "greatest", " of both wheels" if name == "t_gamma" else " of a wheel"),
                *map(number, RUN[name].scale * values.max("time").values),
            ]
            for name, values in of_wheels.items()
        ),
        *([_label(name, "largest"), *_largest(attitude, name)] for name in attitude),
    ]
    return PageTable("Wheelsets", ["quantity", *names], rows, frozenset(range(1, len(names) + 1)))


def _label(name: str, kind: str, of: str = "") -> str:
    """Name of a quantity, kind of the extreme, and unit."""
    own = RUN[name]
    return f"{own.label + of if of else own.name}, {REDUCTIONS[kind][1]} [{own.shown}]"


def body_table(data: Dataset) -> PageTable:
    """Largest magnitudes of the coordinates of all bodies."""
    head = ["body", *(RUN[f"body_{name}"].head for name in COORDINATES)]
    cells = {name: _largest(data, f"body_{name}") for name in COORDINATES}
    rolls = np.isin(data["body"].values, data["wheelset"].values)
    cells["pitch"] = ["–" if turns else text for turns, text in zip(rolls, cells["pitch"], strict=True)]
    rows = [[str(name), *values] for name, *values in zip(data["body"].values, *cells.values(), strict=True)]
    caption = f"Largest magnitudes of the coordinates, each body in the track frame at its own distance; {CHORD}"
    return PageTable(caption, head, rows, frozenset(range(1, len(head))))


def _largest(data: Mapping[Any, DataArray], name: str) -> list[str]:
    """Values of the largest magnitude over time of a variable (time, n)."""
    samples = np.nan_to_num(data[name].transpose("time", ...).values)
    return [number(RUN[name].scale * column[np.argmax(np.abs(column))]) for column in samples.T]


def extreme(data: Dataset, name: str, kind: str) -> tuple[str, str]:
    """Extreme value of a variable, over patches too, and its distance, m, as text."""
    own = RUN[name].scale * data[name]
    values = np.asarray(own.max("patch").values if "patch" in own.dims else own.values, dtype=float)
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
