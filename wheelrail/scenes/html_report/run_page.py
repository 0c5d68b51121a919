"""HTML report of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.html_report.elements import Page, PageNote, PagePicture, PageSection, PageTable, number
from wheelrail.scenes.html_report.extremes import extreme_tables
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import origin, pictures, seconds
from wheelrail.scenes.html_report.views import run_view
from wheelrail.scenes.plots.runs import CHORD, energy, of_wheels, pictures_of
from wheelrail.scenes.quantities import RUN
from wheelrail.scenes.schema.errors import SceneError

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

CAPTIONS = {  # in the order of the page, figures of equal height side by side
    "attitude": "Plan view of the wheelsets with the horizontal forces on their wheels, at the largest guiding forces",
    "guiding_force": RUN["guiding_force"].caption,
    "wheel_load": RUN["vertical_force"].caption,
    "lateral_force": RUN["lateral_force"].caption,
    "vertical_force": RUN["vertical_force"].caption,
    "contact_on_wheel": "Contact positions on the wheels: lateral extent [mm], coloured by peak pressure [MPa]",
    "contact_on_rail": "Contact positions on the rails: lateral extent [mm], coloured by peak pressure [MPa]",
    "lateral_displacement": "Lateral displacement of wheelset and car body, positive to the left [mm]",
    "check_rail": RUN["check_rail_force"].caption,
    "derailment_quotient": RUN["derailment_quotient"].caption,
    "track_shifting_force": RUN["track_shifting_force"].caption,
    "shakedown": "Shakedown map: load factor of every patch over its utilisation, with the limit for line contact",
    "t_gamma": RUN["t_gamma"].caption,
    "energy": "Mechanical energy, and work by cause [kJ]",
    "wheelset_motion": "Lateral displacement and yaw of the wheelsets [mm, mrad]",
    "traction": "Over time: speed of vehicle and rims [m/s], longitudinal forces of the wheelsets [kN], torques [kN m]",
    "body_motion": f"Lateral displacement and yaw of the other bodies [mm, mrad]; {CHORD}",
}


def run_page(data: Dataset, file: Path, *, view: bool = True) -> Page:
    """Page of a run.

    Parameters:
        data: Dataset of the run.
        file: results.
        view: whether to include an interactive 3D view.
    """
    text, reached = str(data.attrs["scene"]), float(data["distance"].values[-1])
    sections = [
        PageSection("Key figures", key_tables({"": data})),
        PageSection("Running safety", [_safety(data, file)]),
        PageSection("Extremes", extreme_tables(data), SIGNS),
        PageSection("Track", [_track(data, file)]),
        PageSection("Figures", pictures(list(_figures(data)), "No figures: fewer than two samples.")),
    ]
    if view:
        sections.insert(2, PageSection("Interactive 3D view", [run_view(data, file)]))
    return Page(
        title=file.parent.resolve().name,
        what="Vehicle run",
        status=f"{data.attrs['status']} at {reached:.1f} m",
        well=data.attrs["status"] == "completed",
        facts={**origin(data.attrs), "computing time": seconds(float(data.attrs["seconds"])), "results": file.name},
        sources={"Scene": text, **({"Vehicle": vehicle} if (vehicle := data.attrs["vehicle"]) else {})},
        sections=sections,
    )


SIGNS = "Forces act on the wheels, in the track frame; positive directions: Y to the left, Q upwards, X forward."


def key_tables(runs: dict[str, Dataset]) -> list[PageTable]:
    """Statistics of every run, and of the contact solves of every side; runs: Datasets by name."""
    run_values = {name or "value": dict(_steps(data)) for name, data in runs.items()}
    sides = {
        " ".join([name, str(side)]).strip(): dict(_solves(data.sel(side=side)))
        for name, data in runs.items()
        for side in data["side"].values
    }
    return [_columns("Run", run_values), _columns("Statistics of the solver", sides)]


def _columns(caption: str, columns: dict[str, dict[str, str]]) -> PageTable:
    labels = list(dict.fromkeys(label for column in columns.values() for label in column))
    rows = [[label, *(column.get(label, "–") for column in columns.values())] for label in labels]
    return PageTable(caption, ["quantity", *columns], rows, frozenset(range(1, len(columns) + 1)))


def _steps(data: Dataset) -> Iterator[tuple[str, str]]:
    attrs, time = data.attrs, data["time"].values
    span, spent = float(time[-1] - time[0]), float(attrs["seconds"])
    speeds = [number(v) for v in (data["speed"].min(), data["speed"].max())]
    yield "distance [m]", f"{float(data['distance'].values[-1]):.1f}"
    yield "simulated time [s]", f"{span:.3f}"
    yield "speed [m/s]", " to ".join(dict.fromkeys(speeds))
    yield "samples", str(len(time))
    for label, name in STEPS.items():
        yield label, str(attrs[name])
    yield "computing time [s]", number(spent)
    if spent > 0.0 and span > 0.0:
        yield "computing time over simulated time", number(spent / span, 3)
    if "energy_balance_error" in attrs:
        yield (
            "error of the energy balance, relative to the largest work [%]",
            number(100 * float(attrs["energy_balance_error"]), 3),
        )


STEPS = {
    "steps accepted": "steps_accepted",
    "steps rejected": "steps_rejected",
    "steps failed": "steps_failed",
    "evaluations of the equations of motion": "evaluations",
}
SOLVES = {
    "contact problems solved": "contact_solves",
    "failed and repeated": "failed_solves",
    "Newton iterations": "newton_iterations",
    "linear iterations": "linear_iterations",
}


def _solves(one: Dataset) -> Iterator[tuple[str, str]]:
    """Statistics of one side."""
    for label, name in SOLVES.items():
        yield label, str(int(one[name]))
    yield "total time [s]", number(one["contact_seconds"], 3)
    if int(one["contact_solves"]):
        yield "mean time per solve [ms]", number(1e3 * one["contact_seconds"] / one["contact_solves"], 3)


def _safety(data: Dataset, file: Path) -> PageTable | PageNote:
    """Running safety over the whole run, or a note with the reason for its absence."""
    from wheelrail.scenes.runs.safety_table import safety_of_data, safety_table

    try:
        return PageTable.of(safety_table(*safety_of_data(data, file)))
    except SceneError as error:
        return PageNote(f"Not assessed: {error}.")


def _track(data: Dataset, file: Path) -> PagePicture | PageNote:
    """Figure of the track, or a note with the reason for its absence."""
    from wheelrail.scenes.datasets.input_files import scene_of_run
    from wheelrail.scenes.runs.track_plot import track_figure
    from wheelrail.scenes.views.view import vehicle_of_run

    caption = "Track of the run: plan view, curvature, cant and cant deficiency, gradient and height, irregularities"
    try:
        figure = track_figure(scene_of_run(data, file), vehicle_of_run(data, file))
    except SceneError as error:
        return PageNote(f"No figure of the track: {error}.")
    drawn = picture(lambda: figure, caption, caption)
    assert drawn is not None
    return drawn


def _figures(data: Dataset) -> Iterator[PagePicture | None]:
    """All figures for which the data exist."""
    if data.sizes["time"] < 2:
        return
    extent = "over {:.0f} to {:.0f} m along the track".format(*data["distance"].values[[0, -1]])
    available = _drawings(data)
    for name in filter(available.__contains__, CAPTIONS):
        detail = "one dot per patch and sample" if name == "shakedown" else extent
        yield picture(available[name], CAPTIONS[name], f"{CAPTIONS[name]}, {detail}")


def _drawings(data: Dataset) -> dict[str, Callable[[], Figure]]:
    """Functions that draw the figures, by name."""
    from wheelrail.scenes.plots.comparison import shakedown_map

    functions: dict[str, Callable[[], Figure]] = {name: partial(draw, data) for name, draw in pictures_of(data).items()}
    if "t_gamma" in data:
        functions["t_gamma"] = partial(of_wheels, "t_gamma", data)
    if "mechanical_energy" in data:
        functions["energy"] = partial(energy, data)
    if "patch_load_factor" in data:
        functions["shakedown"] = partial(shakedown_map, [data], ["patches"])
    return functions
