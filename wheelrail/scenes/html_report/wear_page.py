"""HTML report of wear."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.html_report.elements import Page, PageNote, PageSection, PageTable
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import origin, pictures, seconds, toml_text
from wheelrail.scenes.plots.wear import PICTURES
from wheelrail.scenes.quantity import significant
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.wear.tables import remarks, tables

if TYPE_CHECKING:
    from xarray import Dataset

FIGURES = {
    "Profiles": ("profiles", "depth"),
    "Measures": ("measures",),
    "Rates by case": ("duty",),
    "Fatigue, never added to wear": ("fatigue",),
    "Rails": ("rails",),
}


def wear_page(data: Dataset, file: Path) -> Page:
    """Page of wear.

    Parameters:
        data: Dataset of the wear.
        file: results.

    Raises SceneError for other results.
    """
    if not {"step", "removed_area"} <= {*data.dims, *data.data_vars}:
        raise SceneError(f"{file}: contains no results of wear")
    status, distance = str(data.attrs["status"]), float(data["distance"].values[-1])
    notes = remarks(data) or ["None."]
    sections = [
        PageSection("Wear over the distance", [PageTable.of(table) for table in tables(data)]),
        PageSection("Limits of the results", [PageNote(text) for text in notes]),
    ]
    for title, names in FIGURES.items():
        words = {name: (PICTURES[name].__doc__ or "").split(";")[0].rstrip(".") for name in names}
        drawn = [picture(partial(PICTURES[name], data), text, text) for name, text in words.items()]
        if any(drawn):
            sections.append(PageSection(title, pictures(drawn, "")))
    sources = {"Wear": toml_text(json.loads(data.attrs.get("wear", "{}")))}
    sources |= {key.title(): str(data.attrs[key]) for key in ("scene", "vehicle") if data.attrs.get(key)}
    return Page(
        title=file.parent.resolve().name,
        what=f"Wear of wheel profiles over {significant(1e-3 * distance)} km",
        status=status,
        well=status == "completed",
        facts={
            **origin(data.attrs),
            "computing time": seconds(float(data["seconds"].sum())),
            "law": f"{data.attrs['law']}; {data.attrs['law_source']}",
            "results": file.name,
        },
        sources=sources,
        sections=sections,
    )
