"""Drawings in the axes of Matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wheelrail.scenes.plots.drawing import Arrows, Cells, Drawing, Layer, Line, Segments
from wheelrail.scenes.plots.style import PRESSURE_MAP

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def draw(drawing: Drawing, ax: Axes, *, bar: bool = True) -> Axes:
    """Draw in given axes, which are returned.

    Parameters:
        drawing: to be drawn.
        ax: Matplotlib axes.
        bar: whether to add the colour bar, if the drawing has one.
    """
    from matplotlib.patches import Patch

    for layer in drawing.layers:
        shaded = _add(layer, ax, drawing)
        if bar and drawing.bar is not None and isinstance(layer, Cells):
            ax.figure.colorbar(shaded, ax=ax, label=drawing.bar.label)
    if any(isinstance(layer, Cells) for layer in drawing.layers):
        ax.grid(False)
    if drawing.equal:
        ax.set_aspect("equal")
    ax.set(title=drawing.title, ylabel=drawing.y_label, xlabel="\n".join([drawing.x_label, *drawing.notes]))
    ax.set(xlim=drawing.limits[0], ylim=drawing.limits[1])
    labels = [layer.label for layer in drawing.layers if isinstance(layer, Line) and layer.label]
    if drawing.legend:
        areas = [Patch(color=colour, label=text) for colour, text in drawing.legend]
        ax.legend(handles=areas, loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    elif labels:
        ax.legend(loc="lower center", ncols=len(labels), bbox_to_anchor=(0.5, 0.02), fontsize=8)
    return ax


def _add(layer: Layer, ax: Axes, drawing: Drawing) -> Any:
    """Add the artists of a layer; returns those of cells, for a colour bar."""
    from matplotlib.collections import LineCollection, PolyCollection

    match layer:
        case Cells(corners, None, colours):
            return ax.add_collection(PolyCollection(list(corners), facecolors=list(colours), edgecolors="face"))
        case Cells(corners, values):
            cells = PolyCollection(list(corners), cmap=PRESSURE_MAP, edgecolors="face", linewidths=0.3)
            cells.set_array(values)
            cells.set_clim(0.0, None if drawing.bar is None else drawing.bar.upper)
            return ax.add_collection(cells)
        case Arrows(start, vector, colour):
            scale: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "width": 0.004}
            edge = 0.3 if colour == "white" else 0.0
            ax.quiver(*start.T, *vector.T, **scale, color=colour, edgecolor="0.2", linewidth=edge)
        case Segments(points, colour, width):
            ax.add_collection(LineCollection(list(points), colors=colour, linewidths=width))
        case Line(points, colour, label, dash, width, marker):
            style: dict[str, Any] = {"lw": width, "ls": "--" if dash else "-"} if width > 0.0 else {"ls": ""}
            if marker:
                style |= {"marker": marker, "ms": 6, "mec": "white", "mew": 0.8, "zorder": 5}
            ax.plot(*points.T, color=colour, label=label, **style)
    return None
