"""The page of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from scenes.pictures.runs import PICTURES
from scenes.report_page.common import opening, origin, pictures, seconds
from scenes.report_page.drawing import picture
from scenes.report_page.extremes import vehicle_table, wheel_table
from scenes.report_page.parts import Page, Picture, Section, Table, number
from scenes.report_page.views import moment

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

CAPTIONS = {
    "lateral_displacement": "Lateral displacement of wheelset and car body, to the left [mm]",
    "lateral_force": "Lateral contact force Y on both wheels, to the left [kN]",
    "vertical_force": "Vertical contact force Q on both wheels, upwards [kN]",
    "contact_on_wheel": "Where the wheels are touched: lateral extent of every patch [mm], shaded by peak pressure [MPa]",
    "contact_on_rail": "Where the rails are touched: lateral extent of every patch [mm], shaded by peak pressure [MPa]",
    "t_gamma": "T-gamma: heat of friction per metre of track [N]",
    "energy": "Mechanical energy and the work of what changes it [kJ]",
    "shakedown": "Shakedown map: load factor of every patch over its utilisation, with the limit of line contact",
}


def run_page(data: Dataset, file: Path, *, view: bool = True) -> Page:
    """Of a run's data; file: the results, for names and for what lies beside them. view: with one to turn."""
    text, reached = str(data.attrs["scene"]), float(data["distance"].values[-1])
    sections = [
        Section("Key figures", [key_table({"": data})]),
        Section("Extremes", [wheel_table(data), vehicle_table(data)], SIGNS),
        Section("Pictures", pictures(list(figures(data)), "Fewer than two samples: there is nothing to draw.")),
    ]
    if view:
        sections.insert(2, Section("In three dimensions", [moment(data, file)]))
    return Page(
        title=f"Vehicle run: {file.parent.resolve().name}",
        what="vehicle run",
        status=f"{data.attrs['status']} at {reached:.1f} m",
        well=data.attrs["status"] == "completed",
        lead=opening(text),
        facts={**origin(data.attrs), "took": seconds(float(data.attrs["seconds"])), "results": file.name},
        sources={"The scene as it was run": text},
        sections=sections,
    )


SIGNS = "Forces act on the wheels, in the track's axes: Y to the left, Q upwards, X forward."


def key_table(runs: dict[str, Dataset]) -> Table:
    """What was computed and what it cost, a column for every run."""
    columns = [dict(_figures(data)) for data in runs.values()]
    labels = list(dict.fromkeys(label for column in columns for label in column))
    rows = [[label, *(column.get(label, "–") for column in columns)] for label in labels]
    heads = [name or "value" for name in runs]
    return Table("What was computed, and what it cost", ["", *heads], rows, frozenset(range(1, len(heads) + 1)))


def _figures(data: Dataset) -> Iterator[tuple[str, str]]:
    attrs, time = data.attrs, data["time"].values
    span, spent = float(time[-1] - time[0]), float(attrs["seconds"])
    yield "distance [m]", f"{float(data['distance'].values[-1]):.1f}"
    yield "time [s]", f"{span:.3f}"
    yield "speed, least to greatest [m/s]", " to ".join(number(v) for v in (data["speed"].min(), data["speed"].max()))
    yield "samples kept", str(len(time))
    yield "steps accepted", str(attrs["steps_accepted"])
    yield "steps rejected; failed", f"{attrs['steps_rejected']}; {attrs['steps_failed']}"
    yield "evaluations of the motion", str(attrs["evaluations"])
    by_side = {
        "contact solves": "contact_solves",
        "of these, failed and tried again": "failed_solves",
        "Newton iterations of the contact": "newton_iterations",
    }
    for label, name in by_side.items():
        if name in data:
            values = [int(value) for value in data[name].values]
            yield f"{label}, left; right", "; ".join(map(str, values))
    if "contact_seconds" in data:
        yield "time for contact solves, left; right [s]", "; ".join(number(v, 3) for v in data["contact_seconds"].values)
    yield "time for the run [s]", number(spent, 4)
    if spent > 0.0 and span > 0.0:
        yield "time over time rolled [1]", number(spent / span, 3)
    if "energy_balance_error" in attrs:
        yield "gap of the energy balance, of the largest work [%]", number(100 * float(attrs["energy_balance_error"]), 3)


def figures(data: Dataset) -> Iterator[Picture | None]:
    """All pictures that the data allow."""
    if data.sizes["time"] < 2:
        return
    way = "over {:.0f} to {:.0f} m along the track".format(*data["distance"].values[[0, -1]])
    for name, draw in drawings(data).items():
        where = "one dot for every patch of every sample" if name == "shakedown" else way
        yield picture(draw, CAPTIONS[name], f"{CAPTIONS[name]}, {where}")


def drawings(data: Dataset) -> dict[str, Callable[[], Figure]]:
    """By name."""
    from scenes.pictures.comparison import shakedown_map, t_gamma
    from scenes.pictures.energy import energy_figure

    found: dict[str, Callable[[], Figure]] = {name: partial(draw, data) for name, draw in PICTURES.items()}
    if "t_gamma" in data:
        found["t_gamma"] = partial(t_gamma, [data], ["this run"])
    if "mechanical_energy" in data:
        found["energy"] = partial(energy_figure, data)
    if "patch_load_factor" in data:
        found["shakedown"] = partial(shakedown_map, [data], ["patches"])
    return found
