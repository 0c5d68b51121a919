"""Drawings as data: one description of a picture, drawn by Matplotlib in figures and by the explorer in a browser."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from wheelrail.scenes.plots.style import PRESSURE_MAP
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Marker = Literal["", "o", "D", "^", "v"]
DIGITS = 5  # significant ones of coordinates in a browser: 1e-5 of a picture of a thousand pixels


@dataclass(frozen=True)
class Cells:
    """Filled quadrilaterals.

    Parameters:
        corners: (n, 4, 2).
        values: (n,) in the unit of the drawing's colour bar; or
        colours: of each.
    """

    corners: Array
    values: Array | None = None
    colours: Sequence[str] = ()


@dataclass(frozen=True)
class Arrows:
    """Arrows from their tails.

    Parameters:
        start, vector: (n, 2).
        colour: of all; "white" ones have a dark edge.
    """

    start: Array
    vector: Array
    colour: str


@dataclass(frozen=True)
class Segments:
    """Separate straight lines, points (n, 2, 2)."""

    points: Array
    colour: str
    width: float = 1.6


@dataclass(frozen=True)
class Line:
    """One line through points, or marks at points.

    Parameters:
        points: (n, 2); NaN interrupts the line.
        colour: of line and marks.
        label: in the legend; empty: none.
        dash: whether the line is dashed.
        width: of the line, points; 0: marks alone.
        marker: of the points; empty: none.
    """

    points: Array
    colour: str
    label: str = ""
    dash: bool = False
    width: float = 1.3
    marker: Marker = ""


Layer = Cells | Arrows | Segments | Line


@dataclass(frozen=True)
class Bar:
    """Colour bar of the pressure map with a label, from 0 to an upper end."""

    label: str
    upper: float


@dataclass(frozen=True)
class Drawing:
    """Picture in one pair of axes.

    Parameters:
        title: above the axes.
        x_label, y_label: with units.
        layers: from the lowest one.
        equal: whether both axes have one scale.
        x_limits, y_limits: of the axes; by default those of the layers.
        notes: lines below the axes.
        bar: colours of cells with values.
        legend: colour and text of areas without a line.
    """

    title: str
    x_label: str
    y_label: str
    layers: tuple[Layer, ...]
    equal: bool = False
    x_limits: tuple[float, float] | None = None
    y_limits: tuple[float, float] | None = None
    notes: tuple[str, ...] = ()
    bar: Bar | None = None
    legend: tuple[tuple[str, str], ...] = field(default=())

    def plain(self) -> dict[str, Any]:
        """Numbers, texts and lists for a browser, rounded to what can be seen."""
        return {
            **{name: getattr(self, name) for name in ("title", "x_label", "y_label", "equal", "notes", "legend")},
            "x_limits": self.x_limits,
            "y_limits": self.y_limits,
            "bar": None if self.bar is None else {**vars(self.bar), "colours": colour_scale()},
            "layers": [{"kind": type(layer).__name__, **_plain(vars(layer))} for layer in self.layers],
        }


def colour_scale(count: int = 32) -> list[str]:
    """Colours of the pressure map, from its lower end."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return [to_hex(colour) for colour in colormaps[PRESSURE_MAP](np.linspace(0.0, 1.0, count))]


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    return {name: _rounded(value) if isinstance(value, np.ndarray) else value for name, value in values.items()}


def _rounded(values: Array) -> Any:
    """Lists of numbers relative to the largest, None for those that are not finite."""
    if not np.isfinite(values).all():
        return [None if not np.isfinite(row).all() else _rounded(row) for row in values]
    largest = float(np.abs(values).max(initial=0.0))
    digits = DIGITS - 1 - int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    return np.round(values, digits).tolist()
