"""HTML report of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.html_report.elements import Page, PagePicture, PageSection, PageTable, number
from wheelrail.scenes.html_report.extremes import vehicle_table, wheel_table
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import origin, pictures, seconds
from wheelrail.scenes.html_report.views import largest_force_view
from wheelrail.scenes.plots.runs import PICTURES, t_gamma

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

CAPTIONS = {  # in the order of the page, figures of equal height side by side
    "lateral_force": "Lateral contact force Y on both wheels, positive to the left [kN]",
    "vertical_force": "Vertical contact force Q on both wheels, positive upwards [kN]",
    "contact_on_wheel": "Contact positions on the wheels: lateral extent [mm], coloured by peak pressure [MPa]",
    "contact_on_rail": "Contact positions on the rails: lateral extent [mm], coloured by peak pressure [MPa]",
    "lateral_displacement": "Lateral displacement of wheelset and car body, positive to the left [mm]",
    "shakedown": "Shakedown map: load factor of every patch over its utilisation, with the limit for line contact",
    "t_gamma": "T-gamma: frictional energy per metre of track [N]",
    "energy": "Mechanical energy, and work by cause [kJ]",
}


def run_page(data: Dataset, file: Path, *, view: bool = True) -> Page:
    """Page of a run.

    Parameters:
        data: Dataset of the run.
        file: results.
        view: whether to include an interactive 3D view.
    """
    sections = [
        PageSection("Key figures", key_tables({"": data})),
        PageSection("Extremes", [wheel_table(data), vehicle_table(data)], SIGNS),
        PageSection("Figures", pictures(list(figures(data)), "No figures: fewer than two samples.")),
    ]
    if view:
        sections.insert(2, PageSection("Interactive 3D view", [largest_force_view(data, file)]))
    return page_of_run(data, file, "Vehicle run", {}, sections)


def page_of_run(data: Dataset, file: Path, what: str, sources: dict[str, str], sections: list[PageSection]) -> Page:
    """Page of a run with its status, origin and scene.

    Parameters:
        data: Dataset of the run.
        file: results.
        what: kind of run.
        sources: texts beside that of the scene, by name.
        sections: of the page.
    """
    text, reached = str(data.attrs["scene"]), float(data["distance"].values[-1])
    return Page(
        title=file.parent.resolve().name,
        what=what,
        status=f"{data.attrs['status']} at {reached:.1f} m",
        well=data.attrs["status"] == "completed",
        facts={**origin(data.attrs), "computing time": seconds(float(data.attrs["seconds"])), "results": file.name},
        sources={"Scene": text, **sources},
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


def figures(data: Dataset) -> Iterator[PagePicture | None]:
    """All figures for which the data exist."""
    if data.sizes["time"] < 2:
        return
    extent = "over {:.0f} to {:.0f} m along the track".format(*data["distance"].values[[0, -1]])
    available = drawings(data)
    for name in filter(available.__contains__, CAPTIONS):
        detail = "one dot per patch and sample" if name == "shakedown" else extent
        yield picture(available[name], CAPTIONS[name], f"{CAPTIONS[name]}, {detail}")


def drawings(data: Dataset) -> dict[str, Callable[[], Figure]]:
    """Functions that draw the figures, by name."""
    from wheelrail.scenes.plots.comparison import shakedown_map
    from wheelrail.scenes.plots.energy import energy_figure

    functions: dict[str, Callable[[], Figure]] = {name: partial(draw, data) for name, draw in PICTURES.items()}
    if "t_gamma" in data:
        functions["t_gamma"] = partial(t_gamma, data)
    if "mechanical_energy" in data:
        functions["energy"] = partial(energy_figure, data)
    if "patch_load_factor" in data:
        functions["shakedown"] = partial(shakedown_map, [data], ["patches"])
    return functions
