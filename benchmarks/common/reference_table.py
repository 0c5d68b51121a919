"""Tables of the accuracy benchmark: values compared with a reference, errors as RMS and maximum, targets, points and
seconds.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

REFERENCES = Path(__file__).parents[1] / "reference"


def reference(name: str) -> dict[str, Any]:
    """A file of reference values; sources, units and conventions are in its own keys."""
    return dict(json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8")))


@dataclass(frozen=True)
class Measure:
    """RMS and largest magnitude of an error, in its unit; targets None where none is set."""

    name: str
    unit: str
    rms: float
    worst: float
    rms_target: float | None = None
    worst_target: float | None = None

    @property
    def met(self) -> bool | None:
        """Whether every target is met, None without one."""
        pairs = [(self.rms, self.rms_target), (self.worst, self.worst_target)]
        targets = [(value, target) for value, target in pairs if target is not None]
        return all(value <= target for value, target in targets) if targets else None


def measure(
    name: str, unit: str, errors: Iterable[float], *, rms: float | None = None, worst: float | None = None
) -> Measure:
    """Measure of the concatenated errors in the unit; rms and worst are the targets."""
    e = np.abs(np.fromiter(errors, dtype=float))
    if not len(e):
        raise ValueError(f"no errors of {name}")
    return Measure(name, unit, float(np.sqrt(np.mean(e**2))), float(e.max()), rms, worst)


@dataclass
class TableSection:
    """One part of the benchmark; points: smallest and largest number of points under pressure."""

    name: str
    title: str
    columns: Sequence[str] = ()
    rows: list[list[Any]] = field(default_factory=list)
    measures: list[Measure] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    points: tuple[int, int] = (0, 0)
    seconds: float = 0.0

    def count(self, points: int) -> None:
        """Records the number of points of a solve."""
        low, high = self.points
        self.points = (min(low or points, points), max(high, points))

    def named(self, name: str) -> Measure:
        """The measure of that name; raises KeyError."""
        matching = [quantity for quantity in self.measures if quantity.name == name]
        if not matching:
            raise KeyError(name)
        return matching[0]

    def data(self) -> dict[str, Any]:
        """All data, for a file."""
        return {**asdict(self), "measures": [{**asdict(quantity), "met": quantity.met} for quantity in self.measures]}


def text(value: Any) -> str:
    """A cell."""
    if isinstance(value, float):
        return f"{value:.4g}"
    return str(value)


def target(value: float | None) -> str:
    return "" if value is None else f" (target {value:g})"


def show(section: TableSection) -> str:
    """The section as Markdown."""
    lines = [f"\n## {section.title}", ""]
    if section.rows:
        lines += [f"| {' | '.join(section.columns)} |", "|---" * len(section.columns) + "|"]
        lines += [f"| {' | '.join(text(value) for value in row)} |" for row in section.rows]
        lines.append("")
    if section.measures:
        lines += ["| error | unit | RMS | worst | met |", "|---|---|---|---|---|"]
        for quantity in section.measures:
            met = {None: "", True: "yes", False: "NO"}[quantity.met]
            rms, worst = (
                f"{quantity.rms:.3g}{target(quantity.rms_target)}",
                f"{quantity.worst:.3g}{target(quantity.worst_target)}",
            )
            lines.append(f"| {quantity.name} | {quantity.unit} | {rms} | {worst} | {met} |")
        lines.append("")
    lines += [f"- {note}" for note in section.notes]
    low, high = section.points
    lines.append(f"- {low} to {high} contact points, {section.seconds:.1f} s")
    return "\n".join(lines)
