"""The page of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.html_report.elements import Page, PagePicture, PageSection, PageTable, number
from wheelrail.scenes.html_report.extremes import vehicle_table, wheel_table
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import opening, origin, pictures, seconds
from wheelrail.scenes.html_report.views import moment
from wheelrail.scenes.plots.runs import PICTURES, t_gamma

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

CAPTIONS = {  # in the order of the page, those of one height side by side
    "lateral_force": "Lateral contact force Y on both wheels, to the left [kN]",
    "vertical_force": "Vertical contact force Q on both wheels, upwards [kN]",
    "contact_on_wheel": "Where the wheels are touched: every patch across [mm], shaded by its peak pressure [MPa]",
    "contact_on_rail": "Where the rails are touched: every patch across [mm], shaded by its peak pressure [MPa]",
    "lateral_displacement": "Lateral displacement of wheelset and car body, to the left [mm]",
    "shakedown": "Shakedown map: load factor of every patch over its utilisation, with the limit of line contact",
    "t_gamma": "T-gamma: heat of friction per metre of track [N]",
    "energy": "Mechanical energy and the work of what changes it [kJ]",
}


def run_page(data: Dataset, file: Path, *, view: bool = True) -> Page:
    """Of a run's data; file: the results, for names and for what lies beside them. view: with one to turn."""
    text, reached = str(data.attrs["scene"]), float(data["distance"].values[-1])
    sections = [
        PageSection("Key figures", key_tables({"": data})),
        PageSection("Extremes", [wheel_table(data), vehicle_table(data)], SIGNS),
        PageSection("Pictures", pictures(list(figures(data)), "Fewer than two samples: there is nothing to draw.")),
    ]
    if view:
        sections.insert(2, PageSection("In three dimensions", [moment(data, file)]))
    return Page(
        title=file.parent.resolve().name,
        what="Vehicle run",
        status=f"{data.attrs['status']} at {reached:.1f} m",
        well=data.attrs["status"] == "completed",
        lead=opening(text),
        facts={**origin(data.attrs), "took": seconds(float(data.attrs["seconds"])), "results": file.name},
        sources={"The scene as it was run": text},
        sections=sections,
    )


SIGNS = "Forces act on the wheels, in the track's axes: Y to the left, Q upwards, X forward."


def key_tables(runs: dict[str, Dataset]) -> list[PageTable]:
    """What was computed, a column for every run; and the contact solves, a column for every side of every run."""
    whole = {name or "value": dict(_steps(data)) for name, data in runs.items()}
    sides = {
        " ".join([name, str(side)]).strip(): dict(_solves(data.sel(side=side)))
        for name, data in runs.items()
        for side in data["side"].values
    }
    return [_columns("The run", whole), _columns("Contact solves", sides)]


def _columns(caption: str, columns: dict[str, dict[str, str]]) -> PageTable:
    labels = list(dict.fromkeys(label for column in columns.values() for label in column))
    rows = [[label, *(column.get(label, "–") for column in columns.values())] for label in labels]
    return PageTable(caption, ["quantity", *columns], rows, frozenset(range(1, len(columns) + 1)))


def _steps(data: Dataset) -> Iterator[tuple[str, str]]:
    attrs, time = data.attrs, data["time"].values
    span, spent = float(time[-1] - time[0]), float(attrs["seconds"])
    speeds = [number(v) for v in (data["speed"].min(), data["speed"].max())]
    yield "distance [m]", f"{float(data['distance'].values[-1]):.1f}"
    yield "time rolled [s]", f"{span:.3f}"
    yield "speed [m/s]", " to ".join(dict.fromkeys(speeds))
    yield "samples kept", str(len(time))
    for label, name in STEPS.items():
        yield label, str(attrs[name])
    yield "time to compute [s]", number(spent)
    if spent > 0.0 and span > 0.0:
        yield "time to compute over time rolled", number(spent / span, 3)
    if "energy_balance_error" in attrs:
        yield (
            "gap of the energy balance, of the largest work [%]",
            number(100 * float(attrs["energy_balance_error"]), 3),
        )


STEPS = {
    "steps accepted": "steps_accepted",
    "steps rejected": "steps_rejected",
    "steps failed": "steps_failed",
    "evaluations of the motion": "evaluations",
}
SOLVES = {
    "contact problems solved": "contact_solves",
    "of these, failed and tried again": "failed_solves",
    "Newton iterations": "newton_iterations",
    "linear iterations": "linear_iterations",
}


def _solves(one: Dataset) -> Iterator[tuple[str, str]]:
    """Of one side."""
    for label, name in SOLVES.items():
        yield label, str(int(one[name]))
    yield "time in all [s]", number(one["contact_seconds"], 3)
    if int(one["contact_solves"]):
        yield "time of a solve [ms]", number(1e3 * one["contact_seconds"] / one["contact_solves"], 3)


def figures(data: Dataset) -> Iterator[PagePicture | None]:
    """All pictures that the data allow."""
    if data.sizes["time"] < 2:
        return
    way = "over {:.0f} to {:.0f} m along the track".format(*data["distance"].values[[0, -1]])
    there = drawings(data)
    for name in filter(there.__contains__, CAPTIONS):
        where = "one dot for every patch of every sample" if name == "shakedown" else way
        yield picture(there[name], CAPTIONS[name], f"{CAPTIONS[name]}, {where}")


def drawings(data: Dataset) -> dict[str, Callable[[], Figure]]:
    """By name."""
    from wheelrail.scenes.plots.comparison import shakedown_map
    from wheelrail.scenes.plots.energy import energy_figure

    found: dict[str, Callable[[], Figure]] = {name: partial(draw, data) for name, draw in PICTURES.items()}
    if "t_gamma" in data:
        found["t_gamma"] = partial(t_gamma, data)
    if "mechanical_energy" in data:
        found["energy"] = partial(energy_figure, data)
    if "patch_load_factor" in data:
        found["shakedown"] = partial(shakedown_map, [data], ["patches"])
    return found
