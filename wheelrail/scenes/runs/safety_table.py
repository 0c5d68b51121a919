"""Running safety of a run of a vehicle after EN 14363, from its results."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.datasets.netcdf import read
from wheelrail.scenes.datasets.number_text import fixed
from wheelrail.scenes.runs.files import RESULTS
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.evaluation.running_safety import Assessed, WheelsetSafety, wheelset_safety

if TYPE_CHECKING:
    from rich.table import Table
    from xarray import Dataset


def safety_of(results: Path, start: float, end: float, alpha: float) -> dict[str, WheelsetSafety]:
    """Assessed quantities by wheelset.

    Parameters:
        results: run.nc of a vehicle file, or its folder.
        start, end: m, of the section of track.
        alpha: of the limit of the sum of Y.

    Raises SceneError for results of the plane wagon, and for a section of less than 2 m.
    """
    file = results / RESULTS if results.is_dir() else results
    return safety_of_data(read(file), file, start, end, alpha)


def safety_of_data(
    data: Dataset, file: Path, start: float = 0.0, end: float = inf, alpha: float = 1.0
) -> dict[str, WheelsetSafety]:
    """The same of a Dataset; file: its place, for errors."""
    if "guiding_force" not in data or "wheelset" not in data.dims:
        raise SceneError(f"{file}: must contain a run of a vehicle file, by wheelrail run --vehicle")
    section = data.isel(time=(data["distance"].values >= start) & (data["distance"].values <= end))
    if section.sizes["time"] < 2 or not np.ptp(section["distance"].values) > 2.0:
        raise SceneError(f"{file}: must have results of more than 2 m between {start:g} and {end:g} m")
    time, distance = section["time"].values, section["distance"].values
    forces = section[["guiding_force", "vertical_force"]].sel(side=["left", "right"]).fillna(0.0)
    forces = forces.transpose("time", "wheelset", "side")
    return {
        str(name): wheelset_safety(
            time,
            distance,
            forces["guiding_force"].sel(wheelset=name).values,
            forces["vertical_force"].sel(wheelset=name).values,
            float(data.attrs["mean_wheel_load"]),
            alpha,
        )
        for name in data["wheelset"].values
    }


def safety_table(wheelsets: dict[str, WheelsetSafety]) -> Table:
    """Table with the value and its place for every wheelset, the limit, and whether all wheelsets keep it."""
    from rich.table import Table

    table = Table(title="Running safety and track loading after EN 14363: value, and place along the track (m)")
    table.title_justify = "left"
    for name in ("", *wheelsets, "limit", "result"):
        table.add_column(name, justify="right" if name else "left")
    for label, scale, digits, quantity in ROWS:
        values = [quantity(wheelset) for wheelset in wheelsets.values()]
        texts = (
            "-" if one.passed is None else f"{fixed(scale * one.value, digits)} at {one.place:.0f}" for one in values
        )
        known = [one.passed for one in values if one.passed is not None]
        result = ("pass" if all(known) else "FAIL") if known else "-"
        table.add_row(label, *texts, f"{scale * values[0].limit:.4g}", result)
    return table


ROWS: tuple[tuple[str, float, int, Callable[[WheelsetSafety], Assessed]], ...] = (
    ("sum of Y, 2 m mean, to the right (kN)", 1e-3, 2, lambda w: w.track_shifting),
    ("Y/Q, 2 m mean, left", 1.0, 3, lambda w: w.quotient[0]),
    ("Y/Q, 2 m mean, right", 1.0, 3, lambda w: w.quotient[1]),
    ("Q, left (kN)", 1e-3, 1, lambda w: w.load[0]),
    ("Q, right (kN)", 1e-3, 1, lambda w: w.load[1]),
    ("rms of the sum of Y over 100 m (kN)", 1e-3, 2, lambda w: w.instability),
)
