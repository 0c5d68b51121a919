"""Extremes of a run and the distances where they occur."""

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


def lateral_over_vertical(one: Dataset) -> Array:
    """|Y| / Q of one wheel, NaN where nothing carries it."""
    y, q = one["lateral_force"].values, one["vertical_force"].values
    return np.asarray(np.divide(np.abs(y), q, out=np.full(len(y), np.nan), where=q > 0.0))


def _of(name: str, scale: float = 1.0) -> Callable[[Dataset], Array]:
    """A variable in another unit; of patches, the largest at each time."""

    def values(one: Dataset) -> Array:
        found = scale * one[name]
        return np.asarray(found.max("patch").values if "patch" in found.dims else found.values, dtype=float)

    return values


Row = tuple[str, str, Callable[["Dataset"], Array], str]  # label, variable it needs, values, which extreme
WHEELS: tuple[Row, ...] = (
    ("lateral force Y, largest either way [kN]", "lateral_force", _of("lateral_force", 1e-3), "largest"),
    ("vertical force Q, greatest [kN]", "vertical_force", _of("vertical_force", 1e-3), "greatest"),
    ("vertical force Q, least [kN]", "vertical_force", _of("vertical_force", 1e-3), "least"),
    ("|Y| / Q, greatest [1]", "lateral_force", lateral_over_vertical, "greatest"),
    ("longitudinal force X, largest either way [kN]", "longitudinal_force", _of("longitudinal_force", 1e-3), "largest"),
    ("peak pressure, greatest [MPa]", "patch_max_pressure", _of("patch_max_pressure", 1e-6), "greatest"),
    ("patches at once, most [1]", "patches", _of("patches"), "greatest"),
    ("T-gamma, heat of friction per metre, greatest [N]", "t_gamma", _of("t_gamma"), "greatest"),
    ("utilisation T / N of a patch, greatest [1]", "patch_utilisation", _of("patch_utilisation"), "greatest"),
    ("load factor p₀ / k of a patch, greatest [1]", "patch_load_factor", _of("patch_load_factor"), "greatest"),
    (
        "surface fatigue index, greatest [1]; above 0 the surface ratchets",
        "patch_surface_fatigue_index",
        _of("patch_surface_fatigue_index"),
        "greatest",
    ),
)
VEHICLE: tuple[Row, ...] = (
    ("wheelset y, to the left [mm]", "wheelset_y", _of("wheelset_y", 1e3), "largest"),
    ("wheelset roll [mrad]", "wheelset_roll", _of("wheelset_roll", 1e3), "largest"),
    ("bogie y, to the left [mm]", "bogie_y", _of("bogie_y", 1e3), "largest"),
    ("car body y, to the left [mm]", "car_body_y", _of("car_body_y", 1e3), "largest"),
    ("car body roll [mrad]", "car_body_roll", _of("car_body_roll", 1e3), "largest"),
    ("bumpstop force on the car body, to the left [kN]", "bumpstop_force", _of("bumpstop_force", 1e-3), "largest"),
)


def wheel_table(data: Dataset) -> PageTable:
    """A row for every quantity of the wheels: value and distance m, left and right."""
    sides = [str(side) for side in data["side"].values]
    head = ["quantity", *(text for side in sides for text in (f"{named(side, data)} wheel", "at [m]"))]
    rows = [
        [row[0], *(cell for side in sides for cell in extreme(data.sel(side=side), row))]
        for row in WHEELS
        if row[1] in data
    ]
    return PageTable("Wheels and rails", head, [*rows, *_shares(data, sides)], frozenset(range(1, len(head))))


def vehicle_table(data: Dataset) -> PageTable:
    """The same of the bodies, largest either way."""
    rows = [[row[0], *extreme(data, row)] for row in VEHICLE if row[1] in data]
    return PageTable(
        "Bodies of the vehicle, largest either way", ["quantity", "value", "at [m]"], rows, frozenset({1, 2})
    )


def extreme(data: Dataset, row: Row) -> tuple[str, str]:
    """Value and distance m."""
    _, _, of, which = row
    values = of(data)
    known = np.isfinite(values)
    if not known.any():
        return number(np.nan), number(np.nan)
    size = {"largest": np.abs(values), "greatest": values, "least": -values}[which]
    at = int(np.argmax(np.where(known, size, -np.inf)))
    return number(values[at]), f"{float(data['distance'].values[at]):.1f}"


def _shares(data: Dataset, sides: list[str]) -> Iterator[list[str]]:
    """What holds for a part of the way has no place."""
    distance = data["distance"].values
    away = [100.0 * float((~data["in_contact"].sel(side=side).values.astype(bool)).mean()) for side in sides]
    yield ["samples without contact [%]", *(cell for share in away for cell in (number(share, 3), ""))]
    if "t_gamma" in data and distance[-1] > distance[0]:
        mean = [
            float(trapezoid(data["t_gamma"].sel(side=side).values, distance) / (distance[-1] - distance[0]))
            for side in sides
        ]
        yield ["T-gamma, mean over the way [N]", *(cell for value in mean for cell in (number(value), ""))]
