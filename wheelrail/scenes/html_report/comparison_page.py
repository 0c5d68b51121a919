"""The page of two runs of one scene with different contact models."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.run_differences import differences, table
from wheelrail.scenes.html_report.elements import Page, PageSection, PageTable, Part
from wheelrail.scenes.html_report.extremes import vehicle_table, wheel_table
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import opening, origin, pictures, seconds
from wheelrail.scenes.html_report.run_page import SIGNS, key_tables
from wheelrail.scenes.html_report.views import moment
from wheelrail.scenes.plots.comparison import PICTURES

if TYPE_CHECKING:
    from xarray import Dataset

CAPTIONS = {
    "compare_displacement": "Lateral displacement of wheelset and car body, to the left [mm]",
    "compare_lateral_force": "Lateral contact force Y, to the left [kN]",
    "compare_vertical_force": "Vertical contact force Q, upwards [kN]",
    "compare_longitudinal_force": "Longitudinal contact force X, forward [kN]",
    "compare_on_wheel": "Where the wheels are touched [mm]: patches of the first model, contact points of the second",
    "compare_on_rail": "Where the rails are touched [mm]: patches of the first model, contact points of the second",
    "compare_t_gamma": "T-gamma: heat of friction per metre of track [N]",
    "compare_scatter": "What is left of forces beside parabolas over 0.1 s [N]: numerical noise where motion is steady",
    "compare_shakedown": "Shakedown map: load factor of every patch over its utilisation",
}


HOW = "At the samples of the first run; nothing shifted, nothing filtered."


def comparison_page(runs: tuple[Dataset, Dataset], names: tuple[str, str], folder: Path, *, view: bool = True) -> Page:
    """Of both runs, in folders of their names within the folder. view: with one of the first run to turn."""
    one, other = runs
    both = f"{names[0]} and {names[1]}"
    apart = table(differences(one, other), names)
    caption = f"{names[1]} less {names[0]}: RMS, worst and where, range of {names[0]}"
    sections = [
        PageSection(
            "Differences",
            [PageTable.of_rich(apart, caption)],
            HOW,
        ),
        PageSection("Key figures", key_tables(dict(zip(names, runs, strict=True)))),
        *(
            PageSection(f"Extremes of {name}", [wheel_table(data), vehicle_table(data)], SIGNS)
            for data, name in zip(runs, names, strict=True)
        ),
        PageSection("Pictures", _pictures(runs, names, both)),
    ]
    if view:
        sections.insert(2, PageSection("In three dimensions", [moment(one, folder / names[0] / "run.nc", names[0])]))
    done = [str(data.attrs["status"]) for data in runs]
    facts = {
        **origin(other.attrs),
        "took": ", ".join(f"{seconds(float(d.attrs['seconds']))} {n}" for d, n in zip(runs, names, strict=True)),
        "results": ", ".join(f"{name}/run.nc" for name in names),
    }
    if origin(one.attrs)["versions"] != facts["versions"]:
        facts["versions"] = f"{names[0]}: {one.attrs['versions']}; {names[1]}: {other.attrs['versions']}"
    return Page(
        title=folder.resolve().name,
        what=f"Comparison of the contact models {both}",
        status=done[0] if done[0] == done[1] else "; ".join(f"{n}: {s}" for n, s in zip(names, done, strict=True)),
        well=set(done) == {"completed"},
        lead=opening(str(one.attrs["scene"])),
        facts=facts,
        sources={f"The scene as it was run, {n}": str(d.attrs["scene"]) for n, d in zip(names, runs, strict=True)},
        sections=sections,
    )


def _pictures(runs: tuple[Dataset, Dataset], names: tuple[str, str], both: str) -> list[Part]:
    if min(data.sizes["time"] for data in runs) < 2:
        return pictures([], "Fewer than two samples: there is nothing to draw.")
    return pictures(
        [
            picture(partial(draw, runs, names), CAPTIONS[name], f"{CAPTIONS[name]}, {both}")
            for name, draw in PICTURES.items()
        ],
        "",
    )
