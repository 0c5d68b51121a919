"""Drawings as data: one description of a picture, drawn by Matplotlib in figures and by the explorer in a browser."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from wheelrail.scenes.plots.style import PRESSURE_MAP
from wheelrail.support.arrays import Array

Marker = Literal["", "o", "D", "^", "v"]
SEEN = 1e-4  # error in a browser over the length of an axis, or over the largest value: a tenth of a pixel


@dataclass(frozen=True)
class Cells:
    """Filled quadrilaterals.

    Parameters:
        points: corners (n, 4, 2).
        values: (n,) in the unit of the drawing's colour bar; or
        colours: of each.
    """

    points: Array
    values: Array | None = None
    colours: Sequence[str] = ()


@dataclass(frozen=True)
class Arrows:
    """Arrows of one colour.

    Parameters:
        points: tails (n, 2).
        vector: (n, 2), from tail to tip.
        colour: "white" ones have a dark edge.
    """

    points: Array
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
    """Picture in one pair of axes, with colours of CSS.

    Parameters:
        title: above the axes.
        x_label, y_label: with units.
        layers: from the lowest one.
        equal: whether both axes have one scale.
        x_limits, y_limits: of the axes; by default those of the points with the margin.
        margin: beyond the points, over their extent.
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
    legend: tuple[tuple[str, str], ...] = ()
    margin: float = 0.05

    @property
    def limits(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Limits of both axes."""
        return self.x_limits or self._extent(0), self.y_limits or self._extent(1)

    def _extent(self, axis: int) -> tuple[float, float]:
        values = np.concatenate([np.zeros(0), *(layer.points[..., axis].ravel() for layer in self.layers)])
        values = values[np.isfinite(values)]
        if not values.size:
            return 0.0, 1.0
        low, high = float(values.min()), float(values.max())
        more = self.margin * (high - low) if high > low else 0.5
        return low - more, high + more

    def plain(self) -> dict[str, Any]:
        """Numbers, texts and lists for a browser: coordinates are whole numbers of a unit that cannot be seen."""
        limits = np.array(self.limits)
        sizes = limits[:, 1] - limits[:, 0]
        if self.equal:
            sizes[:] = sizes.max()
        return {
            **{name: getattr(self, name) for name in ("title", "x_label", "y_label", "equal", "notes", "legend")},
            "x_limits": limits[0].tolist(),
            "y_limits": limits[1].tolist(),
            "unit": (SEEN * sizes).tolist(),
            "bar": None if self.bar is None else {**vars(self.bar), "colours": colour_scale()},
            "layers": [_plain(layer, limits[:, 0], SEEN * sizes, self.bar) for layer in self.layers],
        }


@cache
def colour_scale(count: int = 32) -> tuple[str, ...]:
    """Colours of the pressure map, from its lower end."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return tuple(to_hex(colour) for colour in colormaps[PRESSURE_MAP](np.linspace(0.0, 1.0, count)))


def thinned(points: Array, error: float) -> NDArray[np.int64]:
    """Indices of some points (n, 2) of a curve, by the method of Ramer, Douglas and Peucker.

    Parameters:
        points: finite.
        error: largest distance of the others from the lines between.

    It begins with points between which a smooth curve deviates by about the error.
    """
    steps = np.diff(points, axis=0)
    turn = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(steps[:, 1], steps[:, 0])))))
    length = np.hypot(*steps.T)
    bends = np.cumsum(np.sqrt(turn * (length[1:] + length[:-1]) / (16.0 * error)))
    kept = np.concatenate([[0], 1 + np.flatnonzero(np.diff(np.floor(bends), prepend=0.0)), [len(points) - 1]])
    while True:
        piece = np.minimum(np.searchsorted(kept, np.arange(len(points)), side="right"), len(kept) - 1) - 1
        start, chord = points[kept[piece]], points[kept[piece + 1]] - points[kept[piece]]
        along = np.einsum("nk,nk->n", points - start, chord) / np.maximum(np.einsum("nk,nk->n", chord, chord), 1e-300)
        away = np.hypot(*(points - start - np.clip(along, 0.0, 1.0)[:, None] * chord).T)
        furthest = np.maximum.reduceat(away, kept[:-1])[piece]
        split = np.flatnonzero((away == furthest) & (furthest > error))
        if not split.size:
            return kept
        kept = np.union1d(kept, split)


def _plain(layer: Layer, origin: Array, unit: Array, bar: Bar | None) -> dict[str, Any]:
    """Fields of a layer: its points are in units (2,) from an origin (2,), colours of cells are those of a palette."""
    points = (layer.points - origin) / unit
    if isinstance(layer, Line) and not layer.marker and len(points) > 2 and np.isfinite(points).all():
        points = points[thinned(points, 1.0)]
    values = {**vars(layer), "points": _whole(points)}
    if isinstance(layer, Arrows):
        values["vector"] = _whole(layer.vector / unit)
    if isinstance(layer, Cells):
        if layer.values is None:
            values["colours"] = palette = list(dict.fromkeys(layer.colours))
            values["values"] = [palette.index(colour) for colour in layer.colours]
        else:
            values["colours"], upper = colour_scale(), bar.upper if bar else 0.0
            share = layer.values / upper if upper > 0.0 else np.zeros(len(layer.values))
            values["values"] = (
                np.clip(len(values["colours"]) * share, 0, len(values["colours"]) - 1).astype(int).tolist()
            )
    return {"kind": type(layer).__name__, **values}


def _whole(values: Array) -> list[Any]:
    """Coordinates (n, ...) as lists of whole numbers; None for rows that are not finite."""
    if np.isfinite(values).all():
        return list(np.rint(values).astype(int).tolist())
    return [None if not np.isfinite(row).all() else np.rint(row).astype(int).tolist() for row in values]
