"""Tables of an assessment for readers, and the same numbers as JSON and CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from wheelrail.scenes.assessment.assess import Assessment
from wheelrail.scenes.datasets.result_table import Column, Results, ResultTable, TextTable
from wheelrail.scenes.quantity import Quantity
from wheelrail.support.atomic_file import atomic_file
from wheelrail.vehicle.evaluation.criteria import CRITERIA, UNCONFIRMED, ZONES
from wheelrail.vehicle.evaluation.estimates import Estimate

SHOWN = {
    "N": Quantity((), "N", shown="kN", digits=2),
    "1": Quantity((), "1", digits=3),
    "m/s2": Quantity((), "m/s2", digits=3),
}
HEADS = ("run", "zone", "from [m]", "to [m]", "quantity", "unit", "signal", "statistic", "value", "place [m]", "source")
UNITS = {"count": "1", "speed": "m/s", **dict.fromkeys(("place", "start", "end", "radius", "deficiency"), "m")}
COMFORT_SOURCE = "PyRidy, comfpy"
COMFORT_SCALE = "N_MV below 1.5 is very comfortable, above 4.5 very uncomfortable; Wz 2 is good, 3 poor (not confirmed)"
DISCOMFORT_NOTE = f"Formulas and constants of P_CT and P_DE: {UNCONFIRMED}"


def assessment_results(found: Assessment, files: Sequence[Path] = ()) -> Results:
    """Text for readers and facts for programs; files: that were written."""
    estimated = estimate_table(found)
    parts: list[ResultTable | TextTable | str] = [found.verdict, zone_table(found)]
    parts += [*([estimated] if estimated else []), *comfort_tables(found)]
    parts += [*map(str, files), *(f"Remark: {text}." for text in found.remarks)]
    estimates = [{"zone": own.zone, "criterion": own.criterion, own.criterion: _facts(own)} for own in found.estimates]
    sections = [
        {
            **{name: getattr(own, name) for name in ("run", "zone", "start", "end", "deficiency", "speed", "radius")},
            **{
                key: [{"signal": signal, "value": one.value, "place": one.place} for signal, one in values.items()]
                for key, values in own.values.items()
            },
        }
        for own in found.sections
    ]
    units = {key: own.unit for key, own in CRITERIA.items()} | UNITS
    facts = {
        "verdict": found.verdict,
        "exceeded": [f"{own.criterion}, zone {own.zone}" for own in found.exceeded],
        "missing": found.missing,
        "remarks": list(found.remarks),
        "estimates": estimates,
        "sections": sections,
        "files": list(files),
    }
    return Results("assess", parts, facts, units)


def _facts(own: Estimate) -> dict[str, Any]:
    criterion = CRITERIA[own.criterion]
    names = ("signal", "mean", "deviation", "one", "two", "assessed", "limit", "passed", "largest", "run")
    facts = {name: getattr(own, name) for name in names}
    sources = {"limit_source": criterion.source, "method_source": criterion.method, "confirmed": criterion.confirmed}
    return facts | {"count": own.number, "place": own.place} | sources


def zone_table(found: Assessment) -> ResultTable:
    """Zones and their sections."""
    rows = []
    for zone, own in ZONES.items():
        inside = [section for section in found.sections if section.zone == zone]
        if not inside and zone == "5":
            continue
        radii = [section.radius for section in inside if section.curvature]
        deficiencies, speeds = ([getattr(s, name) for s in inside] for name in ("deficiency", "speed"))
        lengths = [section.end - section.start for section in inside]
        rows.append(
            {
                "zone": zone,
                "text": own.text,
                "count": len(inside),
                "needed": own.sections,
                "length": float(np.mean(lengths)) if inside else None,
                "radius": float(np.mean(radii)) if radii else None,
                "least_deficiency": min(deficiencies, default=None),
                "greatest_deficiency": max(deficiencies, default=None),
                "greatest_speed": max(speeds, default=None),
                "source": own.source,
            }
        )
    title = "Zones: sections of constant curvature and cant under the whole vehicle"
    return ResultTable("zones", title, ZONE_COLUMNS, rows)


ZONE_COLUMNS = Column.items(
    ("zone", "zone", "", None),
    ("text", "conditions", "", None),
    ("count", "sections", "1", None),
    ("needed", "needed", "1", None),
    ("length", "mean length", "m", 1),
    ("radius", "mean radius", "m", 0),
    ("least_deficiency", "least cant deficiency", "mm", 0),
    ("greatest_deficiency", "greatest cant deficiency", "mm", 0),
    ("greatest_speed", "greatest speed", "m/s", 1),
    ("source", "source", "", None),
)


def estimate_table(found: Assessment) -> TextTable | None:
    """Estimates by group, with limits, sources and results; None without sections."""
    rows = []
    for own in sorted(found.estimates, key=lambda own: (list(CRITERIA).index(own.criterion), own.zone)):
        criterion, shown = CRITERIA[own.criterion], SHOWN[CRITERIA[own.criterion].unit]
        number = [shown.texts([value]) if np.isfinite(value) else "-" for value in own[4:8]]
        limit = f"{shown.scale * own.limit:.4g}"
        unit = f" [{shown.shown or shown.unit}]" if shown.unit != "1" else ""
        rows.append(
            [
                f"{criterion.label}{unit}",
                own.zone,
                own.signal,
                str(own.number),
                *number,
                limit,
                "kept" if own.passed else "EXCEEDED",
                f"{shown.texts([own.largest])} at {own.place:.0f} m, {own.run}",
                criterion.source,
            ]
        )
    if not rows:
        return None
    head = ["quantity", "zone", "most critical signal", "sections", "mean", "deviation", "one-dimensional"]
    head += ["two-dimensional", "limit", "result", "largest section", "source of the limit"]
    return TextTable("Estimates over the sections of a zone", head, rows, frozenset(range(3, 9)))


def comfort_tables(found: Assessment) -> list[ResultTable]:
    """Comfort at points of the floor and on transitions."""
    tables = []
    if found.comfort:
        title = f"Comfort at points {found.options.floor:g} m above top of rail: N_MV, Wz ({COMFORT_SOURCE}), P_DE"
        note = f"{COMFORT_SCALE}. {DISCOMFORT_NOTE}"
        tables.append(ResultTable("comfort", title, COMFORT_COLUMNS, list(found.comfort), note=note))
    if found.transitions:
        title = "Comfort on transitions into curves, P_CT at the worst point"
        tables.append(
            ResultTable("transitions", title, TRANSITION_COLUMNS, list(found.transitions), note=DISCOMFORT_NOTE)
        )
    return tables


def _fields(*entries: tuple[str, str, str, str, int | None]) -> tuple[Column, ...]:
    return tuple(Column(name, label, attrgetter(of), unit, digits) for name, of, label, unit, digits in entries)


COMFORT_COLUMNS = _fields(
    ("run", "run", "run", "", None),
    ("point", "point", "point", "", None),
    ("mean_comfort", "mean", "N_MV", "1", 2),
    ("sperling_lateral", "lateral", "Wz lateral", "1", 2),
    ("sperling_vertical", "vertical", "Wz vertical", "1", 2),
    ("event_standing", "standing", "largest P_DE standing", "percent", 1),
    ("event_seated", "seated", "seated", "percent", 1),
    ("place", "place", "at", "m", 1),
)
TRANSITION_COLUMNS = _fields(
    ("run", "run", "run", "", None),
    ("start", "start", "from", "m", 1),
    ("end", "end", "to", "m", 1),
    ("radius", "radius", "radius", "m", 0),
    ("point", "point", "worst point", "", None),
    ("transition_standing", "standing", "P_CT standing", "percent", 1),
    ("transition_seated", "seated", "P_CT seated", "percent", 1),
)


def section_table(found: Assessment) -> TextTable:
    """Largest value of every criterion in every section."""
    head = ["run", "zone", "from [m]", "to [m]", "radius [m]", "cant deficiency [mm]", "speed [m/s]"]
    rows = []
    for own in found.sections:
        radius = f"{own.radius:.0f}" if own.curvature else "-"
        row = [own.run, own.zone, f"{own.start:.1f}", f"{own.end:.1f}", radius, f"{1e3 * own.deficiency:.0f}"]
        row.append(f"{own.speed:.1f}")
        for key, criterion in CRITERIA.items():
            values = [one.value for one in own.values.get(key, {}).values()]
            row.append(SHOWN[criterion.unit].texts([max(values)]) if values else "-")
        rows.append(row)
    for criterion in CRITERIA.values():
        unit = SHOWN[criterion.unit].shown or criterion.unit
        head.append(f"{criterion.label} [{unit}]" if criterion.unit != "1" else criterion.label)
    return TextTable("Sections: the largest of all signals", head, rows, frozenset(range(1, len(head))))


def method_table() -> TextTable:
    """Statistic, factor and sources of every criterion."""
    rows = [
        [own.label, own.group, own.kind, f"{own.factor:g}", ", ".join(sorted(own.zones)), own.method, own.source]
        for own in CRITERIA.values()
    ]
    head = [
        "quantity",
        "group",
        "value of a section",
        "k",
        "zones",
        "source of filter and value",
        "source of the limit",
    ]
    return TextTable("Method", head, rows, frozenset((3,)))


def write_csv(found: Assessment, file: Path) -> None:
    """Write all numbers in SI units, one a line, with run, zone, place, quantity, signal and statistic.

    Raises OSError if the file cannot be written.
    """
    with atomic_file(file) as part, part.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(HEADS)
        for row in _lines(found):
            writer.writerow([repr(cell) if isinstance(cell, float) else cell for cell in row])


def _lines(found: Assessment) -> Iterator[tuple[Any, ...]]:
    for s in found.sections:
        for key, values in s.values.items():
            own = CRITERIA[key]
            for signal, one in values.items():
                where = s.run, s.zone, s.start, s.end, own.label, own.unit, signal
                yield *where, f"section, {own.kind}", one.value, one.place, own.method
    for e in found.estimates:
        own = CRITERIA[e.criterion]
        zone = "", e.zone, "", "", own.label, own.unit, e.signal
        for name, text in STATISTICS.items():
            yield *zone, text, float(getattr(e, name)), "", own.source if name == "limit" else UNCONFIRMED
    for c in found.comfort:
        for column in COMFORT_COLUMNS[2:7]:
            source = UNCONFIRMED if column.unit == "percent" else COMFORT_SOURCE
            yield c.run, "", "", "", column.label, column.unit, c.point, "run", column.of(c), "", source
    for t in found.transitions:
        for column in TRANSITION_COLUMNS[5:]:
            yield (
                t.run,
                "",
                t.start,
                t.end,
                column.label,
                column.unit,
                t.point,
                "transition",
                column.of(t),
                "",
                UNCONFIRMED,
            )


STATISTICS = {
    "mean": "mean",
    "deviation": "standard deviation",
    "one": "one-dimensional estimate",
    "two": "two-dimensional estimate",
    "assessed": "assessed",
    "limit": "limit",
}
