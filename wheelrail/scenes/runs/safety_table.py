"""Running safety of a run after EN 14363, from its results."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.scenes.datasets.result_table import Results, TextTable
from wheelrail.scenes.datasets.run_file import RESULTS, read_run
from wheelrail.scenes.quantities import SAFETY
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.vehicle.evaluation.resolved_loads import unresolved_loads
from wheelrail.vehicle.evaluation.running_safety import WINDOW, Assessed, WheelsetSafety, wheelset_safety

if TYPE_CHECKING:
    from xarray import Dataset


UNCONFIRMED = "Limits of Q and of the rms are those of UIC 518, not compared with the text of the standard"


class Safety(NamedTuple):
    """Assessed quantities by wheelset, and remarks on a run that is not complete or not resolved."""

    wheelsets: dict[str, WheelsetSafety]
    remarks: list[str]


def safety_of(results: Path, start: float, end: float, alpha: float) -> Safety:
    """Assessed quantities by wheelset.

    Parameters:
        results: run.nc, or its folder.
        start, end: m, of the section of track.
        alpha: of the limit of the sum of Y.

    Samples without forces, of contacts that failed there, are left out. Raises SceneError for
    a section of less than 2 m, and for one of which more than 2 m have no forces.
    """
    file = results / RESULTS if results.is_dir() else results
    return safety_of_data(read_run(file), file, start, end, alpha)


def safety_of_data(data: Dataset, file: Path, start: float = 0.0, end: float = inf, alpha: float = 1.0) -> Safety:
    """The same of a Dataset; file: its place, for errors."""
    section, remarks = with_forces(data, file, start, end)
    time, distance = section["time"].values, section["distance"].values
    forces = section[["guiding_force", "vertical_force"]]
    wheelsets = {
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
    return Safety(wheelsets, remarks)


def with_forces(data: Dataset, file: Path, start: float = 0.0, end: float = inf) -> tuple[Dataset, list[str]]:
    """Samples of a section whose forces are known over (time, wheelset, side), and remarks; errors as `safety_of`."""
    section = data.isel(time=(data["distance"].values >= start) & (data["distance"].values <= end))
    if section.sizes["time"] < 2 or not np.ptp(section["distance"].values) > 2.0:
        raise SceneError(f"{file}: must have results of more than 2 m between {start:g} and {end:g} m")
    status, remarks = str(data.attrs.get("status", "of unknown status")), list[str]()
    if status != "completed":
        remarks.append(f"The run is not complete and ends at {float(data['distance'][-1]):.1f} m: {status}")
    forces = section[["guiding_force", "vertical_force"]].sel(side=list(SIDES))
    forces = forces.transpose("time", "wheelset", "side")
    known = np.isfinite(forces["guiding_force"].values + forces["vertical_force"].values).all(axis=(1, 2))
    if not known.all():
        places, count = section["distance"].values, np.count_nonzero(~known)
        longest = float(np.diff([places[0], *places[known], places[-1]]).max())
        if longest > WINDOW:
            raise SceneError(f"{file}: no contact forces over {longest:.1f} m: must be known every {WINDOW:g} m")
        remarks.append(f"{count} of {len(known)} samples have no contact forces and are left out")
        section, forces = section.isel(time=known), forces.isel(time=known)
    remarks += load_remarks(section)
    return section.assign(forces), remarks


def load_remarks(data: Dataset) -> list[str]:
    """Remarks on largest wheel loads that the rows of a run do not resolve."""
    load = data["vertical_force"].sel(side=list(SIDES)).transpose("time", "wheelset", "side").values
    return unresolved_loads(data["time"].values, data["distance"].values, data["wheelset"].values.tolist(), load)


def safety_results(safety: Safety) -> Results:
    """Table for readers; value, place, limit and result of every quantity of every wheelset for programs."""
    rows = [
        {"wheelset": name, **{key: _facts(one) for key, one in _assessed(own).items()}}
        for name, own in safety.wheelsets.items()
    ]
    units = {"place": "m", **{key: own.unit for key, own in SAFETY.items()}}
    return Results("evaluate", [safety_table(*safety)], {"remarks": safety.remarks, "wheelsets": rows}, units)


def _assessed(own: WheelsetSafety) -> dict[str, Assessed]:
    """Assessed quantities by the keys of SAFETY."""
    return dict(zip(SAFETY, (own.track_shifting, *own.quotient, *own.load, own.instability), strict=True))


def _facts(one: Assessed) -> dict[str, Any]:
    return {"value": one.value, "place": one.place, "limit": one.limit, "passed": one.passed}


def safety_table(wheelsets: dict[str, WheelsetSafety], remarks: Sequence[str] = ()) -> TextTable:
    """Table of safety quantities: value and place for every wheelset, limit, compliance; remarks follow its title."""
    title = f"Running safety and track loading after EN 14363: value, and place along the track (m). {UNCONFIRMED}"
    rows = []
    assessed = [_assessed(own) for own in wheelsets.values()]
    for key, own in SAFETY.items():
        values = [each[key] for each in assessed]
        texts = (f"{own.texts([one.value])} at {one.place:.0f}" if np.isfinite(one.value) else "-" for one in values)
        known = [one.passed for one in values if one.passed is not None]
        result = ("pass" if all(known) else "FAIL") if known else "-"
        limit = values[0].limit
        head = own.label if own.unit == "1" else own.head
        rows.append([head, *texts, "no limit" if limit is None else f"{own.scale * limit:.4g}", result])
    heads = ["", *wheelsets, "limit", "result"]
    return TextTable(". ".join([title, *remarks]), heads, rows, frozenset(range(1, len(heads))))
