"""Running safety of a run of a vehicle after EN 14363, from its results."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.datasets.netcdf import read
from wheelrail.scenes.datasets.number_text import fixed
from wheelrail.scenes.runs.files import RESULTS
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.evaluation.running_safety import QUOTIENT_LIMIT, WheelsetSafety, wheelset_safety

if TYPE_CHECKING:
    from rich.table import Table


def safety_of(results: Path, start: float, end: float, alpha: float) -> dict[str, WheelsetSafety]:
    """Assessed quantities by wheelset.

    Parameters:
        results: run.nc of a vehicle file, or its folder.
        start, end: m, of the section of track.
        alpha: of the limit of the sum of Y.

    Raises SceneError for results of the plane wagon, and for a section of less than 2 m.
    """
    file = results / RESULTS if results.is_dir() else results
    data = read(file)
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
    """Table with one column per wheelset; limits in the last one."""
    from rich.table import Table

    table = Table(title="Running safety and track loading after EN 14363", title_justify="left")
    for name in ("", *wheelsets, "limit"):
        table.add_column(name, justify="right" if name else "left")
    values = list(wheelsets.values())
    first = values[0]
    rows = (
        ("sum of Y, 2 m mean (kN)", lambda w: fixed(1e-3 * w.track_shifting, 2), 1e-3 * first.track_shifting_limit),
        ("Y/Q, 2 m mean, left, right", lambda w: "  ".join(fixed(x, 3) for x in w.quotient), QUOTIENT_LIMIT),
        ("Q, left, right (kN)", lambda w: "  ".join(fixed(1e-3 * x, 1) for x in w.load), 1e-3 * first.load_limit),
        (
            "rms of the sum of Y over 100 m (kN)",
            lambda w: fixed(1e-3 * w.instability, 2) if np.isfinite(w.instability) else "-",
            1e-3 * first.instability_limit,
        ),
    )
    for label, text, limit in rows:
        table.add_row(label, *map(text, values), f"{limit:.4g}")
    return table
