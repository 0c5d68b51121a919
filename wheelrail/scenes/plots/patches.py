"""Figures of contact patches in plan view: pressure, tractions, slip, stick and slip areas."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wheelrail.scenes.plots.drawing import Arrows, Bar, Cells, Drawing, Layer, Segments
from wheelrail.scenes.plots.patch_cells import PatchCells, chosen, title, touching
from wheelrail.scenes.plots.render import draw
from wheelrail.scenes.plots.style import REGIONS, axes_of, save, styled
from wheelrail.scenes.quantity import significant
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset


ARROWS = 15  # along the longer side of a patch
WIDTH = 3.5  # inches, of a panel of all patches
LEFT, ABOVE, BELOW = 0.75, 0.35, 0.95  # inches beside a panel, for the labels of its axes, its title and notes
BAR = 1.0  # inches, width of the colour bar with its label
LOWEST = 0.5  # height over width of a panel of all patches: room for the label of its axis
EDGE = "#D55E00"
PRESSURE = "pressure [MPa]"
PLAN: dict[str, Any] = {
    "x_label": "longitudinal, positive forward [mm]",
    "y_label": "lateral, positive to the left [mm]",
    "equal": True,
    "margin": 0.075,
}


def draw_patches(data: Dataset, file: Path) -> None:
    """Save the figure in the format of the file ending. Raises ValueError without contact or for another ending."""
    with styled():
        save(patches_figure(data), file)


def patches_figure(data: Dataset, figure: Figure | None = None) -> Figure:
    """Pressure, traction arrows and stick-slip boundary of all patches.

    Parameters:
        data: Dataset of `wheelrail.scenes.datasets.contact`.
        figure: Matplotlib figure; a new one by default.

    One column per side with its patches below one another; one scale of lengths and one of pressure for all. Raises
    ValueError without contact.
    """
    from matplotlib.figure import Figure

    patches = touching(data)
    if not patches:
        raise ValueError("the bodies are not in contact: no patch to draw")
    sides = list(dict.fromkeys(side for side, _ in patches))
    drawings = {key: pressure_drawing(data, *key, tractions=True) for key in patches}
    halves = {key: 0.5 * np.ptp(drawing.limits, axis=1) for key, drawing in drawings.items()}
    half_width = float(max(half for half, _ in halves.values()))
    half_heights = [LOWEST * half_width] * (1 + max(patch for _, patch in patches))
    for (_, patch), (_, half) in halves.items():
        half_heights[patch] = max(half_heights[patch], float(half))
    figure = Figure() if figure is None else figure
    axes, bar_axes = _panels(figure, len(sides), [WIDTH * half / half_width for half in half_heights])
    for column, side in zip(axes.T, sides, strict=True):
        for patch, ax in enumerate(column):
            if (side, patch) not in drawings:
                ax.set_axis_off()
                continue
            drawing = drawings[side, patch]
            x, y = map(_about, drawing.limits, (half_width, half_heights[patch]))
            draw(replace(drawing, x_limits=x, y_limits=y), ax, bar=False)
    figure.colorbar(axes[0, 0].collections[0], cax=bar_axes, label=PRESSURE)
    return figure


def pressure_map(data: Dataset, side: str | None = None, patch: int = 0, ax: Axes | None = None) -> Axes:
    """Pressure of one patch, MPa, and its stick-slip boundary.

    Parameters:
        data: Dataset of `wheelrail.scenes.datasets.contact`.
        side: of the patch; the first side in contact by default.
        patch: index by decreasing load.
        ax: Matplotlib axes; new ones by default.

    The colours range to the largest pressure of all patches. Raises ValueError for a missing patch.
    """
    return draw(pressure_drawing(data, side, patch), axes_of(ax))


def traction_map(
    data: Dataset, side: str | None = None, patch: int = 0, ax: Axes | None = None, *, slip: bool = True
) -> Axes:
    """Stick and slip areas of one patch, with arrows of the traction on the wheel or upper body and of the slip.

    Parameters:
        data, side, patch, ax: as for `pressure_map`.
        slip: whether to draw arrows of the slip velocity.

    Raises ValueError for a missing patch.
    """
    return draw(traction_drawing(data, side, patch, slip=slip), axes_of(ax))


def pressure_drawing(data: Dataset, side: str | None = None, patch: int = 0, *, tractions: bool = False) -> Drawing:
    """Drawing of `pressure_map`.

    Parameters:
        data, side, patch: as for `pressure_map`.
        tractions: whether to add their arrows.
    """
    key = chosen(data, side, patch)
    cells = PatchCells.of(data, *key)
    arrows = _arrows(cells, cells.traction, "white") if tractions else ()
    layers = (Cells(1e3 * cells.corners, 1e-6 * cells.pressure), *arrows)
    notes = [_longest(cells)] if arrows else []
    if cells.traction.any():
        if cells.sticks.all() or not cells.sticks.any():
            notes.append("full stick" if cells.sticks.all() else "full slip")
        else:
            layers += (Segments(1e3 * cells.stick_edge(), EDGE),)
            notes.append("orange: stick-slip boundary")
    bar = Bar(PRESSURE, 1e-6 * float(np.nanmax(data.variables["patch_max_pressure"].values)))
    return Drawing(title(data, *key), layers=layers, notes=tuple(notes), bar=bar, **PLAN)


def traction_drawing(data: Dataset, side: str | None = None, patch: int = 0, *, slip: bool = True) -> Drawing:
    """Drawing of `traction_map`, with its parameters."""
    key = chosen(data, side, patch)
    cells = PatchCells.of(data, *key)
    colours = [REGIONS["stick" if sticks else "slip"] for sticks in cells.sticks]
    arrows = _arrows(cells, cells.traction, "#1a1a1a")
    notes = [_longest(cells)] if arrows else []
    slips = ~cells.sticks
    if slip and slips.any() and arrows:
        moving = np.where(slips[:, None], cells.slip, 0.0)
        arrows += _arrows(cells, moving, EDGE, slips)
        notes.append(f"orange: slip velocity, largest {np.hypot(*moving.T).max():.3g} of the rolling speed")
    areas = {name: float(cells.areas[cells.sticks == (name == "stick")].sum()) for name in REGIONS}
    legend = tuple(
        (REGIONS[name], f"{name}, {significant(1e6 * area)} mm²") for name, area in areas.items() if area > 0.0
    )
    layers = (Cells(1e3 * cells.corners, colours=colours), *arrows)
    return Drawing(title(data, *key), layers=layers, notes=tuple(notes), legend=legend, **PLAN)


def _panels(figure: Figure, columns: int, heights: list[float]) -> tuple[NDArray[np.object_], Axes]:
    """Axes (rows, columns) of given heights, inches, and axes of a colour bar beside the first row.

    Lengths are set in inches, as layouts that are fitted to the labels give each panel another scale.
    """
    rows = len(heights)
    width = columns * (LEFT + WIDTH) + BAR
    height = sum(heights) + rows * (ABOVE + BELOW)
    figure.set_layout_engine("none")
    figure.set_size_inches(width, height)
    axes, bottom = np.empty((rows, columns), dtype=object), height
    for row, panel_height in enumerate(heights):
        bottom -= ABOVE + panel_height
        for column in range(columns):
            left = LEFT + column * (LEFT + WIDTH)
            axes[row, column] = figure.add_axes((left / width, bottom / height, WIDTH / width, panel_height / height))
        bottom -= BELOW
    place = ((width - BAR + 0.2) / width, 1 - (ABOVE + heights[0]) / height, 0.15 / width, heights[0] / height)
    return axes, figure.add_axes(place, label="<colorbar>")


def _about(limits: tuple[float, float], half: float) -> tuple[float, float]:
    """Limits with the same middle."""
    middle = 0.5 * (limits[0] + limits[1])
    return middle - half, middle + half


def _arrows(cells: PatchCells, vectors: Array, colour: str, only: NDArray[np.bool_] | None = None) -> tuple[Layer, ...]:
    """Arrows of vectors (n, 2) in the direction of each, none for zero ones."""
    largest = float(np.hypot(*vectors.T).max())
    if not largest > 0.0:
        return ()
    at = cells.spread(ARROWS, only)
    longest = 1e3 * float(np.ptp(cells.corners.reshape(-1, 2), axis=0).max()) / (0.7 * ARROWS)
    return (Arrows(1e3 * cells.middle[at], longest / largest * vectors[at], colour),)


def _longest(cells: PatchCells) -> str:
    largest = significant(1e-6 * np.hypot(*cells.traction.T).max())
    return f"longest arrow: traction of {largest} MPa on the {cells.on}"
