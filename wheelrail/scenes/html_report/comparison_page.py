"""HTML report of two runs of one scene with different contact models."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.datasets.run_differences import differences, table
from wheelrail.scenes.html_report.elements import Page, PageSection, PageTable, Part
from wheelrail.scenes.html_report.extremes import extreme_tables
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import origin, pictures, seconds
from wheelrail.scenes.html_report.run_page import SIGNS, key_tables
from wheelrail.scenes.html_report.views import run_view
from wheelrail.scenes.plots.comparison import PICTURES
from wheelrail.scenes.quantities import RUN

if TYPE_CHECKING:
    from xarray import Dataset

CAPTIONS = {
    "compare_displacement": "Lateral displacement of wheelset and car body, positive to the left [mm]",
    **{f"compare_{name}": RUN[name].caption for name in ("lateral_force", "vertical_force", "longitudinal_force")},
    "compare_on_wheel": "Contact positions on the wheels [mm]: patches of the first model, points of the second",
    "compare_on_rail": "Contact positions on the rails [mm]: patches of the first model, points of the second",
    "compare_t_gamma": RUN["t_gamma"].caption,
    "compare_scatter": "Residuals of forces from parabolas over 0.1 s [N]: numerical noise where the motion is steady",
    "compare_shakedown": "Shakedown map: load factor of every patch over its utilisation",
}


METHOD = "At the samples of the first run, without time shift or filter."


def comparison_page(runs: tuple[Dataset, Dataset], names: tuple[str, str], folder: Path, *, view: bool = True) -> Page:
    """Page of a comparison.

    Parameters:
        runs: Datasets of both runs.
        names: of both models, and of the subfolders of their runs.
        folder: of the comparison.
        view: whether to include an interactive 3D view of the first run.
    """
    first, second = runs
    both = f"{names[0]} and {names[1]}"
    difference_table = table(differences(first, second), names)
    caption = f"{names[1]} minus {names[0]}: RMS, maximum with its distance, range of {names[0]}"
    sections = [
        PageSection(
            "Differences",
            [PageTable.of(difference_table, caption)],
            METHOD,
        ),
        PageSection("Key figures", key_tables(dict(zip(names, runs, strict=True)))),
        *(
            PageSection(f"Extremes of {name}", extreme_tables(data), SIGNS)
            for data, name in zip(runs, names, strict=True)
        ),
        PageSection("Figures", _pictures(runs, names, both)),
    ]
    if view:
        sections.insert(
            2, PageSection("Interactive 3D view", [run_view(first, folder / names[0] / "run.nc", names[0])])
        )
    statuses = [str(data.attrs["status"]) for data in runs]
    facts = {
        **origin(second.attrs),
        "computing time": ", ".join(
            f"{seconds(float(d.attrs['seconds']))} {n}" for d, n in zip(runs, names, strict=True)
        ),
        "results": ", ".join(f"{name}/run.nc" for name in names),
    }
    if origin(first.attrs)["versions"] != facts["versions"]:
        facts["versions"] = f"{names[0]}: {first.attrs['versions']}; {names[1]}: {second.attrs['versions']}"
    return Page(
        title=folder.resolve().name,
        what=f"Comparison of the contact models {both}",
        status=statuses[0]
        if statuses[0] == statuses[1]
        else "; ".join(f"{n}: {s}" for n, s in zip(names, statuses, strict=True)),
        well=set(statuses) == {"completed"},
        facts=facts,
        sources={f"Scene, {n}": str(d.attrs["scene"]) for n, d in zip(names, runs, strict=True)},
        sections=sections,
    )


def _pictures(runs: tuple[Dataset, Dataset], names: tuple[str, str], both: str) -> list[Part]:
    if min(data.sizes["time"] for data in runs) < 2:
        return pictures([], "No figures: fewer than two samples.")
    return pictures(
        [
            picture(partial(draw, runs, names), CAPTIONS[name], f"{CAPTIONS[name]}, {both}")
            for name, draw in PICTURES.items()
        ],
        "",
    )
