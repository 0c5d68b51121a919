"""Figures of contact patches in plan view: pressure, tractions, slip, stick and slip areas."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wheelrail.scenes.plots.patch_cells import PatchCells, chosen, title, touching
from wheelrail.scenes.plots.style import PRESSURE_MAP, REGIONS, axes_of, save, styled
from wheelrail.scenes.quantity import significant
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from xarray import Dataset


ARROWS = 15  # along the longer side of a patch
WIDTH = 3.5  # inches, of a panel of all patches
LEFT, ABOVE, BELOW = 0.75, 0.35, 0.95  # inches beside a panel, for the labels of its axes, its title and notes
BAR = 1.0  # inches, width of the colour bar with its label
MARGIN = 1.15  # drawn length over that of the longest patch
LOWEST = 0.5  # height over width of a panel of all patches: room for the label of its axis
EDGE = "#D55E00"
ALONG, ACROSS = "longitudinal, positive forward [mm]", "lateral, positive to the left [mm]"


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
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

    patches = touching(data)
    if not patches:
        raise ValueError("the bodies are not in contact: no patch to draw")
    sides = list(dict.fromkeys(side for side, _ in patches))
    rows = 1 + max(patch for _, patch in patches)
    cells = {key: PatchCells.of(data, *key) for key in patches}
    half_width = max(_half_extents(patch_cells)[0] for patch_cells in cells.values())
    half_heights = [
        max(_half_extents(patch_cells)[1] for (_, patch), patch_cells in cells.items() if patch == row)
        for row in range(rows)
    ]
    half_heights = [max(half, LOWEST * half_width) for half in half_heights]
    figure = Figure() if figure is None else figure
    heights = [WIDTH * half / half_width for half in half_heights]
    axes, bar_axes = _panels(figure, len(sides), heights)
    shade = _scene_shade(data)
    for column, side in zip(axes.T, sides, strict=True):
        for patch, ax in enumerate(column):
            if (side, patch) not in cells:
                ax.set_axis_off()
                continue
            ax.set_title(title(data, side, patch))
            patch_cells = cells[side, patch]
            _shaded(ax, patch_cells, shade)
            _finish(
                ax,
                patch_cells,
                [*_arrows(ax, patch_cells, patch_cells.traction, "white"), *_stick_line(ax, patch_cells)],
            )
            _centre(ax, patch_cells, half_width, half_heights[patch])
    figure.colorbar(ScalarMappable(shade, PRESSURE_MAP), cax=bar_axes, label="pressure [MPa]")
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
    cells = PatchCells.of(data, *chosen(data, side, patch))
    ax = axes_of(ax)
    shaded = _shaded(ax, cells, _scene_shade(data))
    ax.figure.colorbar(shaded, ax=ax, label="pressure [MPa]")
    ax.set_title(title(data, *chosen(data, side, patch)))
    _finish(ax, cells, _stick_line(ax, cells))
    return ax


def traction_map(
    data: Dataset, side: str | None = None, patch: int = 0, ax: Axes | None = None, *, slip: bool = True
) -> Axes:
    """Stick and slip areas of one patch, with arrows of the traction on the wheel or upper body and of the slip.

    Parameters:
        data, side, patch, ax: as for `pressure_map`.
        slip: whether to draw arrows of the slip velocity.

    Raises ValueError for a missing patch.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    cells = PatchCells.of(data, *chosen(data, side, patch))
    ax = axes_of(ax)
    colours = np.where(cells.sticks, REGIONS["stick"], REGIONS["slip"])
    ax.add_collection(PolyCollection(list(1e3 * cells.corners), facecolors=list(colours), edgecolors="face"))
    notes = _arrows(ax, cells, cells.traction, "0.1")
    slips = ~cells.sticks
    if slip and slips.any() and notes:
        moving = np.where(slips[:, None], cells.slip, 0.0)
        notes += _arrows(
            ax, cells, moving, EDGE, only=slips, note="orange: slip velocity, largest {:.3g} of the rolling speed"
        )
    area = {name: float(cells.areas[cells.sticks == (name == "stick")].sum()) for name in REGIONS}
    handles = [
        Patch(color=colour, label=f"{name}, {significant(1e6 * area[name])} mm²")
        for name, colour in REGIONS.items()
        if area[name] > 0.0
    ]
    ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    ax.set_title(title(data, *chosen(data, side, patch)))
    _finish(ax, cells, notes)
    return ax


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


def _scene_shade(data: Dataset) -> Normalize:
    """Colour scale of the pressure, MPa, of all patches of a scene."""
    from matplotlib.colors import Normalize

    return Normalize(0.0, 1e-6 * float(data["patch_max_pressure"].max()))


def _half_extents(cells: PatchCells) -> tuple[float, float]:
    """Half of the drawn length and width of a patch, mm, with a margin."""
    length, width = MARGIN * 0.5e3 * np.ptp(cells.corners, axis=(0, 1))
    return float(length), float(width)


def _centre(ax: Axes, cells: PatchCells, half_width: float, half_height: float) -> None:
    """Set the limits of the axes, mm, about the middle of a patch."""
    corners = 1e3 * cells.corners.reshape(-1, 2)
    x, y = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    ax.set_xlim(x - half_width, x + half_width)
    ax.set_ylim(y - half_height, y + half_height)


def _shaded(ax: Axes, cells: PatchCells, shade: Any) -> Any:
    from matplotlib.collections import PolyCollection

    patch = PolyCollection(list(1e3 * cells.corners), cmap=PRESSURE_MAP, norm=shade, edgecolors="face", linewidths=0.3)
    patch.set_array(1e-6 * cells.pressure)
    ax.add_collection(patch)
    return patch


def _finish(ax: Axes, cells: PatchCells, notes: list[str]) -> None:
    """Axes of equal scale, with notes below."""
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.margins(0.08)
    ax.grid(False)
    ax.set_xlabel("\n".join([ALONG, *notes]))
    ax.set_ylabel(ACROSS)


def _arrows(
    ax: Axes,
    cells: PatchCells,
    vectors: Array,
    colour: str,
    *,
    only: NDArray[np.bool_] | None = None,
    note: str = "",
) -> list[str]:
    """Draw arrows of vectors (n, 2), tractions, Pa, by default; returns a note on their length."""
    size = np.hypot(*vectors.T)
    largest = float(size.max())
    if not largest > 0.0:
        return []
    at = cells.spread(ARROWS, only)
    (x, y), (u, v) = 1e3 * cells.middle[at].T, vectors[at].T / largest
    length = float(np.ptp(1e3 * cells.corners.reshape(-1, 2), axis=0).max()) / ARROWS
    ax.quiver(
        x,
        y,
        u,
        v,
        angles="xy",
        scale_units="xy",
        scale=0.7 / length,
        color=colour,
        width=0.004,
        edgecolor="0.2",
        linewidth=0.3 if colour == "white" else 0.0,
    )
    return [
        note.format(largest)
        if note
        else f"longest arrow: traction of {significant(1e-6 * largest)} MPa on the {cells.on}"
    ]


def _stick_line(ax: Axes, cells: PatchCells) -> list[str]:
    """Draw the stick-slip boundary and return a note on full stick or full slip; nothing without friction."""
    if not cells.traction.any():
        return []
    if cells.sticks.all() or not cells.sticks.any():
        return ["full stick" if cells.sticks.all() else "full slip"]
    from matplotlib.collections import LineCollection

    ax.add_collection(LineCollection(list(1e3 * cells.stick_edge()), colors=EDGE, linewidths=1.6))
    return ["orange: stick-slip boundary"]
