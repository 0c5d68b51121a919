"""Figure of the scaling benchmark: time, memory and error over contact points, and time over unknowns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from benchmarks.common.measurement import Row
from benchmarks.common.measurement_tables import grouped

# Okabe and Ito's colours, distinct for all colour vision; markers in addition
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STROKES = ("o-", "s--", "^:")


def draw(
    path: Path, points: Sequence[Row], floors: Sequence[Row], elastic: Sequence[Row], newton: Sequence[Row]
) -> None:
    """Draws all measured rows."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rows = int(bool(points)) + int(bool(elastic or newton))
    figure, axes = plt.subplots(rows, 3, figsize=(15, 5.2 * rows), layout="constrained", squeeze=False)
    if points:
        lines(axes[0, 0], grouped(points, "family", "task"), "points", lambda row: 1e3 * row["seconds"])
        for name, style in (("dgesv 2n", "--"), ("dgesv n", ":"), ("gather", "-.")):
            points_and_bounds = [(row["points"], 1e3 * row[name]) for row in floors if name in row]
            if points_and_bounds:
                axes[0, 0].plot(
                    *zip(*points_and_bounds, strict=True), style, color="0.5", lw=1, label=f"lower bound: {name}"
                )
        lines(axes[0, 1], grouped(points, "family", "task"), "points", lambda row: row["memory"])
        lines(
            axes[0, 2],
            {f"{name}: creep forces": rows for name, rows in grouped(points, "family", "task").items() if "LU" in name}
            | {
                f"{name}: normal force": rows
                for name, rows in grouped(points, "family", "task").items()
                if "nor" in name
            },
            "points",
            lambda row: row.get("creep error", abs(row["force error"])),
        )
        for axis, label in zip(
            axes[0], ("time of a solve, ms", "memory of a solve, MB", "error, % of F_n or of mu F_n"), strict=True
        ):
            axis.set(xlabel="contact points", ylabel=label)
    if elastic or newton:
        panels = axes[-1]
        lines(panels[0], grouped(elastic, "method", "ranks"), "unknowns", _total)
        normal = [row for row in newton if not row["friction"]]
        lines(panels[1], grouped(normal, "method"), "unknowns", _total)
        by = {f"K u = f, {name}": rows for name, rows in grouped(elastic, "method", "ranks").items()}
        lines(panels[2], by, "unknowns", lambda row: row["memory"])
        titles = ("K u = f, by method and ranks", "contact without friction, by preconditioner", "all ranks")
        labels = ("set-up and solve, s", "set-up and solve, s", "peak memory, MB")
        for axis, title, label in zip(panels, titles, labels, strict=True):
            axis.set(xlabel="unknowns", ylabel=label, title=title)
    for axis in axes.ravel():
        axis.set(xscale="log", yscale="log")
        axis.grid(True, which="both", lw=0.3, color="0.85")
        if axis.get_legend_handles_labels()[0]:
            axis.legend(fontsize=7)
    figure.savefig(path, dpi=110)


def _total(row: Row) -> float:
    return float(row["set-up"] + row["solve"])


def lines(axis: Any, groups: dict[str, list[Row]], size: str, cost: Callable[[Row], float]) -> None:
    """One line per group: families and methods by colour, tasks and ranks by marker and stroke."""
    colours: list[str] = []
    strokes: list[str] = []
    for name, rows in groups.items():
        colour, stroke = str(rows[0].get("family", rows[0].get("method"))), str(rows[0].get("task", rows[0]["ranks"]))
        colours += [] if colour in colours else [colour]
        strokes += [] if stroke in strokes else [stroke]
        i, j = colours.index(colour) % len(COLOURS), strokes.index(stroke) % len(STROKES)
        values = sorted((row[size], cost(row)) for row in rows)
        axis.plot(*zip(*values, strict=True), STROKES[j], color=COLOURS[i], ms=4, lw=1.2, label=name)
