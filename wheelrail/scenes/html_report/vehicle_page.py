"""HTML report of a run of a vehicle in three dimensions."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.html_report.elements import Page, PageNote, PagePicture, PageSection, PageTable, number
from wheelrail.scenes.html_report.extremes import wheel_table
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import pictures
from wheelrail.scenes.html_report.run_page import SIGNS, key_tables, page_of_run
from wheelrail.scenes.html_report.views import vehicle_view
from wheelrail.scenes.plots.vehicle_runs import CHORD, pictures_of
from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

CAPTIONS = {
    "attitude": "Plan view of the wheelsets with the horizontal forces on their wheels, at the largest guiding forces",
    "guiding_force": "Guiding force Y of every wheel, positive outwards [kN]",
    "wheel_load": "Wheel load Q of every wheel [kN]",
    "derailment_quotient": "Derailment quotient Y/Q of every wheel [1]",
    "track_shifting_force": "Sum of Y of every wheelset, positive to the right [kN]",
    "t_gamma": "T-gamma of every wheel: frictional energy per metre of track [N]",
    "wheelset_motion": "Lateral displacement and yaw of the wheelsets [mm, mrad]",
    "traction": "Over time: speed of vehicle and rims [m/s], longitudinal forces of the wheelsets [kN], torques [kN m]",
    "body_motion": f"Lateral displacement and yaw of the other bodies [mm, mrad]; {CHORD}",
}


def vehicle_page(data: Dataset, file: Path, *, view: bool = True) -> Page:
    """Page of a run.

    Parameters:
        data: Dataset of the run.
        file: results.
        view: whether to include an interactive 3D view.
    """
    tables = [wheel_table(data.sel(wheelset=name), str(name)) for name in data["wheelset"].values]
    sections = [
        PageSection("Key figures", key_tables({"": data})),
        PageSection("Running safety", [_safety(data, file)]),
        PageSection("Extremes", [wheelset_table(data), *tables, body_table(data)], SIGNS),
        PageSection("Track", [_track(data, file)]),
        PageSection("Figures", pictures(list(_figures(data)), "No figures: fewer than two samples.")),
    ]
    if view:
        sections.insert(2, PageSection("Interactive 3D view", [vehicle_view(data, file)]))
    sources = {"Vehicle": str(data.attrs["vehicle"])}
    return page_of_run(data, file, "Vehicle run in three dimensions", sources, sections)


def _safety(data: Dataset, file: Path) -> PageTable | PageNote:
    """Running safety over the whole run, or the reason why it cannot be assessed."""
    from wheelrail.scenes.runs.safety_table import safety_of_data, safety_table

    try:
        return PageTable.of(safety_table(*safety_of_data(data, file)))
    except SceneError as error:
        return PageNote(f"Not assessed: {error}.")


def _track(data: Dataset, file: Path) -> PagePicture | PageNote:
    """Figure of the track, or the reason why it cannot be drawn."""
    from wheelrail.scenes.runs.track_plot import track_figure
    from wheelrail.scenes.views.view import scene_of_run, vehicle_of_run

    caption = "Track of the run: plan view, curvature, cant and cant deficiency, gradient and height, irregularities"
    try:
        figure = track_figure(scene_of_run(data, file), vehicle_of_run(data, file))
    except SceneError as error:
        return PageNote(f"No figure of the track: {error}.")
    drawn = picture(lambda: figure, caption, caption)
    assert drawn is not None
    return drawn


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


def _figures(data: Dataset) -> Iterator[PagePicture | None]:
    """All figures."""
    if data.sizes["time"] < 2:
        return
    extent = "over {:.0f} to {:.0f} m along the track".format(*data["distance"].values[[0, -1]])
    for name, draw in pictures_of(data).items():
        yield picture(partial(draw, data), CAPTIONS[name], f"{CAPTIONS[name]}, {extent}")
