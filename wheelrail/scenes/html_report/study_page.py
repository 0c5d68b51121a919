"""HTML report of a study."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.html_report.elements import Page, PageNote, PageSection, PageTable
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import origin, pictures, seconds, toml_text
from wheelrail.scenes.html_report.views import case
from wheelrail.scenes.studies.convergence import errors_of
from wheelrail.scenes.studies.plan import SAMPLE, shown
from wheelrail.scenes.studies.tables import case_table, convergence_tables, flat, parameters

if TYPE_CHECKING:
    from xarray import Dataset

ROWS = 2000  # of the table of cases
KINDS = {"hertz": "pairs of bodies", "wheelset": "wheelsets on rails", "run": "vehicle runs"}


def study_page(data: Dataset, file: Path, *, view: bool = True) -> Page:
    """Page of a study.

    Parameters:
        data: Dataset of the study.
        file: results.
        view: whether to include an interactive 3D view of one case, which is solved again.
    """
    counts = {str(s): int((data["status"] == s).sum()) for s in np.unique(data["status"].values)}
    spent = float(data["seconds"].sum())
    sections = [
        PageSection("Parameters", [parameter_table(data)]),
        PageSection("Failed cases", [failures(data, file.name)]),
        PageSection("Cases", [PageTable.of(case_table(data, ROWS, f"in {file.name}"))]),
        PageSection("Figures", pictures(_pictures(data), "No figures: no plotted quantity varies between cases.")),
    ]
    if errors_of(data):
        sections.insert(2, PageSection("Convergence", list(map(PageTable.of, convergence_tables(data)))))
    if view:
        sections.append(PageSection("Interactive 3D view", [case(data, file)]))
    if not counts.get("failed"):
        del sections[1]
    return Page(
        title=file.parent.resolve().name,
        what=f"Study of {data['status'].size} cases, {KINDS.get(str(data.attrs.get('scene_kind')), 'scenes')}",
        status=", ".join(f"{count} {status}" for status, count in counts.items()),
        well=not counts.keys() & {"failed", "not computed"},
        facts={**origin(data.attrs), "computing time": f"{seconds(spent)}, sum over cases", "results": file.name},
        sources={
            "Study": toml_text(_without_defaults(json.loads(data.attrs["study"]))),
            "Scene": toml_text(json.loads(data.attrs["scene"])),
        },
        sections=sections,
    )


def parameter_table(data: Dataset) -> PageTable:
    """Parameters with unit, dimension and values."""
    rows = []
    for name in parameters(data):
        values, unit = data[name].values, data[name].attrs.get("units", "1")
        texts = [shown(value.item() if hasattr(value, "item") else value) for value in values]
        numbers = values.dtype.kind in "if" and len(values)
        sampled = numbers and SAMPLE in data[name].dims
        summary = (
            f"{len(values)} values from {shown(values.min())} to {shown(values.max())}" if sampled else ", ".join(texts)
        )
        dims = " x ".join(map(str, data[name].dims))
        rows.append([str(data[name].attrs.get("long_name", name)), unit if unit != "1" else "–", dims, summary])
    return PageTable("Varied parameters", ["parameter", "unit", "dimension", "values"], rows, frozenset())


def failures(data: Dataset, file: str) -> PageTable | PageNote:
    """Parameters and error of the failed cases; file: contains those beyond 2000."""
    names = parameters(data)
    columns = [flat(data, name) for name in names]
    failed, errors = np.flatnonzero(flat(data, "status") == "failed"), flat(data, "error")
    if not failed.size:
        return PageNote("None.")
    rows = [[*(shown(column[k].item()) for column in columns), str(errors[k])] for k in failed[:ROWS]]
    heads = [str(data[name].attrs.get("long_name", name)) for name in names]
    note = f"and {failed.size - ROWS} more, in {file}" if failed.size > ROWS else ""
    return PageTable("Failed cases and their errors", [*heads, "error"], rows, frozenset(range(len(heads))), note)


def _pictures(data: Dataset) -> list[Any]:
    from wheelrail.scenes.studies.plots import convergence, drawings, sensitivity

    sampled = SAMPLE in data.dims
    caption = (
        "Rank correlation with every parameter, and the quantity over the parameter of largest correlation"
        if sampled
        else "Main quantities over the varied parameters"
    )
    errors = "Relative errors [%] over the refined parameter, and over the time for the contact solves [s]"
    return [
        picture(partial(sensitivity if sampled else drawings(data)["study"], data, None), caption, caption),
        picture(partial(convergence, data), errors, errors),
    ]


def _without_defaults(study: dict[str, Any]) -> dict[str, Any]:
    """Non-default values; a scene in a table is shown separately."""
    values = {key: value for key, value in study.items() if value not in (None, {}, [], False)}
    return {key: value for key, value in values.items() if not (key == "scene" and isinstance(value, dict))}
