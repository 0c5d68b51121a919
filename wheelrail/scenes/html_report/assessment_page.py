"""HTML page of an assessment."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from wheelrail.scenes.assessment.assess import Assessment
from wheelrail.scenes.assessment.tables import (
    assessment_results,
    comfort_tables,
    estimate_table,
    method_table,
    section_table,
    write_csv,
    zone_table,
)
from wheelrail.scenes.datasets.result_table import json_text
from wheelrail.scenes.html_report.elements import Page, PageNote, PageSection, PageTable, Part
from wheelrail.scenes.html_report.figures import picture
from wheelrail.scenes.html_report.provenance import pictures
from wheelrail.scenes.html_report.write import write_page
from wheelrail.scenes.plots.assessment import along_track, regressions, utilisation
from wheelrail.scenes.runs.safety_table import safety_table
from wheelrail.support.atomic_file import atomic_file

SOURCES = (
    "The texts of EN 14363 and EN 12299 were not available: limits and rules have a public source, or are from "
    "memory and marked as not confirmed. The page is an engineer's estimate and no acceptance."
)


def assessment_page(found: Assessment) -> Page:
    """Page of an assessment."""
    estimates = estimate_table(found)
    parts: list[Part] = [PageNote(found.verdict)]
    if estimates is not None:
        caption = "Section values and estimates over their limits"
        drawn = picture(partial(utilisation, found.sections, found.estimates), caption, caption)
        parts += [PageTable.of(estimates), *([drawn] if drawn else [])]
    deficiency = found.options.deficiency
    if deficiency is not None:
        caption = "Section values over cant deficiency and their two-dimensional estimates"
        more = picture(partial(regressions, found.sections, found.estimates, deficiency), caption, caption)
        parts += [more] if more else []
    along = [
        picture(
            partial(along_track, own, found.sections, found.options.alpha), f"Along the track: {own.name}", own.name
        )
        for own in found.runs
    ]
    maxima = [
        PageTable.of(safety_table(*own), f"{run.name}: {MAXIMA}")
        for run, own in zip(found.runs, found.safety, strict=True)
    ]
    sections = [
        PageSection("Verdict", parts, SOURCES),
        PageSection("Zones and sections", [PageTable.of(zone_table(found)), PageTable.of(section_table(found))]),
        PageSection("Comfort", list(map(PageTable.of, comfort_tables(found))) or [PageNote("No accelerations.")]),
        PageSection("Along the track", pictures(along, "No figures.")),
        PageSection("Places of maxima", maxima),
        PageSection("Method and sources", [PageTable.of(method_table())]),
        PageSection("Limits of the results", [PageNote(f"{text}.") for text in found.remarks] or [PageNote("None.")]),
    ]
    options = found.options
    facts = {
        "runs": ", ".join(own.name for own in found.runs),
        "static wheel load": f"{1e-3 * found.runs[0].wheel_load:.2f} kN",
        "factor of the sum of Y": f"{options.alpha:g}",
        "length of sections": "by zone and speed" if options.length is None else f"{options.length:g} m",
        "cant deficiency of the estimates": "of the sections" if deficiency is None else f"{1e3 * deficiency:g} mm",
    }
    exceeded = bool(found.exceeded)
    status = "limits exceeded" if exceeded else "limits kept" if found.estimates else "not assessed"
    status += ", no complete test" if found.missing and found.estimates else ""
    return Page(
        title=", ".join(own.name for own in found.runs),
        what="Assessment after EN 14363 and EN 12299",
        status=status,
        well=bool(found.estimates) and not exceeded,
        facts=facts,
        sources={},
        sections=sections,
    )


MAXIMA = "percentiles of the whole run, transitions included, with the places of their maxima"


def write_assessment(found: Assessment, folder: Path) -> list[Path]:
    """Write assessment.html, .json and .csv; returns the files. Raises OSError if one cannot be written."""
    folder.mkdir(parents=True, exist_ok=True)
    page, numbers, lines = (folder / f"assessment.{ending}" for ending in ("html", "json", "csv"))
    write_page(assessment_page(found), page)
    with atomic_file(numbers) as part:
        part.write_text(json_text(assessment_results(found).report, indent=1), encoding="utf-8")
    write_csv(found, lines)
    return [page, numbers, lines]
