"""Extreme values of a run and the distances at which they occur."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import trapezoid

from wheelrail.scenes.html_report.elements import PageTable, number
from wheelrail.scenes.plots.runs import named
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from xarray import Dataset


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
VEHICLE: tuple[Row, ...] = (
    ("wheelset y, positive to the left [mm]", "wheelset_y", _of("wheelset_y", 1e3), "largest"),
    ("wheelset roll [mrad]", "wheelset_roll", _of("wheelset_roll", 1e3), "largest"),
    ("bogie y, positive to the left [mm]", "bogie_y", _of("bogie_y", 1e3), "largest"),
    ("car body y, positive to the left [mm]", "car_body_y", _of("car_body_y", 1e3), "largest"),
    ("car body roll [mrad]", "car_body_roll", _of("car_body_roll", 1e3), "largest"),
    (
        "bumpstop force on the car body, positive to the left [kN]",
        "bumpstop_force",
        _of("bumpstop_force", 1e-3),
        "largest",
    ),
)


def wheel_table(data: Dataset, caption: str = "Wheels and rails") -> PageTable:
    """Extremes of the wheels of a wheelset with their distances, m, left and right."""
    sides = [str(side) for side in data["side"].values]
    head = ["quantity", *(text for side in sides for text in (f"{named(side, data)} wheel", "at [m]"))]
    rows = [
        [row[0], *(cell for side in sides for cell in extreme(data.sel(side=side), row))]
        for row in WHEELS
        if row[1] in data
    ]
    return PageTable(caption, head, [*rows, *_averages(data, sides)], frozenset(range(1, len(head))))


def vehicle_table(data: Dataset) -> PageTable:
    """The same for the bodies of the vehicle, largest magnitudes."""
    rows = [[row[0], *extreme(data, row)] for row in VEHICLE if row[1] in data]
    return PageTable(
        "Bodies of the vehicle, largest magnitudes", ["quantity", "value", "at [m]"], rows, frozenset({1, 2})
    )


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
