"""Figure of error over time: normal contact, rolling, and times of one wheel on its rail."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.common.measurement import Row
from benchmarks.common.measurement_tables import grouped
from benchmarks.error_vs_time.wheel_on_rail import TASK as WHEEL

# Okabe and Ito's colours, distinct for all colour vision; markers in addition
STYLES: dict[str, tuple[str, str]] = {
    "lattice, half-space": ("#0072B2", "o"),
    "lattice, half-space, warm": ("#56B4E9", "o"),
    "lattice, waveguide": ("#D55E00", "s"),
    "lattice, waveguide, warm": ("#E69F00", "s"),
    "grid, order 1": ("#CC79A7", "v"),
    "grid, order 2": ("#009E73", "^"),
    "grid, soft laws": ("#009E73", "x"),
    "condensed, solid": ("0.45", "D"),
    "full, solid": ("0.45", "P"),
    "CONTACT": ("#000000", "*"),
    "CONTACT, long cells": ("#000000", "p"),
    "CONTACT, long cells, warm": ("0.6", "p"),
}
SMALLEST = 1e-3  # %, below which an error is drawn there
STROKES = ("-", "--", ":")
# each panel: task, titles, and what is drawn by these strokes
PANELS = (
    (
        "normal",
        "Normal contact alone, at Hertz's approach",
        "error, % of Hertz",
        {"force error": "force", "area error": "area"},
    ),
    (
        "rolling",
        "Rolling with xi, eta and spin",
        "error of creep forces, % of mu F_n",
        {
            "creep RMS": "RMS over the creep curves",
            "creep error": "the timed ellipse, larger error",
            "sampled RMS": "RMS over sampled ellipses",
        },
    ),
)


def draw(path: Path, rows: Sequence[Row]) -> None:
    """Draws all measured rows."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.lines import Line2D

    figure, axes = plt.subplots(1, 3, figsize=(18, 7.4), layout="constrained", width_ratios=(1.0, 1.0, 0.6))
    wheel_panel(axes[2], [row for row in rows if row["task"] == WHEEL])
    for axis, (task, title, label, errors) in zip(axes[:2], PANELS, strict=True):
        families = grouped([row for row in rows if row["task"] == task], "family")
        for name, family_rows in families.items():
            colour, marker = STYLES[name]
            scattered, size = name == "grid, soft laws", 10 if name.startswith("CONTACT") else 6
            for k, (error, stroke) in enumerate(zip(errors, STROKES, strict=False)):
                if scattered and k:  # further errors of regularised laws would hide others
                    continue
                style = {} if k == 0 else {"mfc": "none", "lw": 0.8}
                lines(
                    axis, family_rows, error, "" if scattered else stroke, color=colour, marker=marker, ms=size, **style
                )
        strokes = [
            Line2D([], [], color="0.3", ls=stroke, label=name)
            for name, stroke in zip(errors.values(), STROKES, strict=False)
        ]
        axis.legend(handles=strokes, fontsize=8, loc="best")
        axis.set(xscale="log", yscale="log", xlabel="time of a solve, median, ms", ylabel=label, title=title)
        axis.grid(True, which="both", lw=0.3, color="0.85")
    drawn_families = {row["family"] for row in rows}
    shown = {name: f"{name} (times of another date)" if name.startswith("CONTACT") else name for name in STYLES}
    handles = [
        Line2D([], [], color=c, marker=m, ls="none", label=shown[k])
        for k, (c, m) in STYLES.items()
        if k in drawn_families
    ]
    figure.legend(handles=handles, fontsize=8.5, loc="outside lower center", ncols=4)
    figure.savefig(path, dpi=110)


def wheel_panel(axis: Any, rows: Sequence[Row]) -> None:
    """Times of one wheel under its load, by load and number of patches."""
    cases = list(dict.fromkeys((row["load"], row["patches"]) for row in rows))
    divisions = list(dict.fromkeys(row["division"] for row in rows))
    for row in rows:
        colour, marker = STYLES[row["family"]]
        place, turn = cases.index((row["load"], row["patches"])), divisions.index(row["division"]) % 2
        axis.plot(1e3 * row["median"], place, color=colour, marker=marker, ms=10, ls="none")
        above = 9 + 11 * turn if row["family"] == "CONTACT" else -17 - 11 * turn  # points
        at = 1e3 * row["median"], place
        axis.annotate(row["division"], at, (0, above), textcoords="offset points", fontsize=8, ha="center")
    names = [f"{load:g} kN\n{count} patch{'es' * (count > 1)}" for load, count in cases]
    axis.set(xscale="log", xlabel="time of all solves, median, ms", title="One wheel under its load, from cold")
    axis.set_yticks(range(len(cases)), names)
    axis.set_ylim(len(cases) - 0.5, -0.5)
    axis.margins(x=0.15)
    axis.grid(True, which="both", axis="x", lw=0.3, color="0.85")


def lines(axis: Any, rows: Sequence[Row], error: str, stroke: str, **style: Any) -> None:
    """Errors over times, in the order of rows: from coarse to fine."""
    points = [(1e3 * row["median"], max(abs(row[error]), SMALLEST)) for row in rows if error in row]
    if points:
        axis.plot(*zip(*points, strict=True), linestyle=stroke or "none", **style)
