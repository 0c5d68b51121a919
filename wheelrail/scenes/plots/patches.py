"""Pictures of contact patches from above: pressure, tractions and slip on the wheel, where the surfaces stick."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wheelrail.scenes.plots.patch_cells import PatchCells, chosen, title, touching
from wheelrail.scenes.plots.style import PRESSURE_MAP, REGIONS, STYLE, axes_of, save
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset


ARROWS = 15  # over the longer side of a patch
EDGE = "#D55E00"
ALONG, ACROSS = "along, forward [mm]", "across, to the left [mm]"


def draw_patches(data: Dataset, file: Path) -> None:
    """Write the picture; its format is that of the file's ending. Raises ValueError when nothing touches, or for an
    ending that is no picture's.
    """
    from matplotlib import rc_context

    with rc_context(STYLE):
        save(patches_figure(data), file)


def patches_figure(data: Dataset, figure: Figure | None = None) -> Figure:
    """Pressure, arrows of traction and the edge of stick of all patches of a Dataset of
    `wheelrail.scenes.datasets.contact`: a column for every side, its patches below one another, on one scale of
    pressure.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    there = touching(data)
    if not there:
        raise ValueError("nothing touches: there is no patch to draw")
    sides = list(dict.fromkeys(side for side, _ in there))
    rows = 1 + max(patch for _, patch in there)
    cells = {place: PatchCells.of(data, *place) for place in there}
    heights = [
        1.3 + 3.4 * min(max(_tall(own) for (_, patch), own in cells.items() if patch == row), 1.6)
        for row in range(rows)
    ]
    figure = Figure() if figure is None else figure
    figure.set_size_inches(1.2 + 4.4 * len(sides), sum(heights))
    figure.set_layout_engine("constrained", h_pad=0.1)  # inch; less cuts titles at a low resolution
    axes = figure.subplots(rows, len(sides), squeeze=False, gridspec_kw={"height_ratios": heights})
    shade = Normalize(0.0, 1e-6 * float(data["patch_max_pressure"].max()))
    for column, side in zip(axes.T, sides, strict=True):
        for patch, ax in enumerate(column):
            if (side, patch) not in cells:
                ax.set_axis_off()
                continue
            ax.set_title(title(data, side, patch))
            own = cells[side, patch]
            _shaded(ax, own, shade)
            _finish(ax, own, [*_arrows(ax, own, own.traction, "white"), *_stick_line(ax, own)])
    figure.colorbar(ScalarMappable(shade, PRESSURE_MAP), ax=axes[0], aspect=25, label="pressure [MPa]")
    return figure


def pressure_map(data: Dataset, side: str | None = None, patch: int = 0, ax: Axes | None = None) -> Axes:
    """Pressure MPa of one patch over its plane, and the edge between stick and slip; the first side that touches
    unless one is named. Raises ValueError for a patch that is not there.
    """
    from matplotlib.colors import Normalize

    cells = PatchCells.of(data, *chosen(data, side, patch))
    ax = axes_of(ax)
    shaded = _shaded(ax, cells, Normalize(0.0, 1e-6 * float(cells.pressure.max())))
    ax.figure.colorbar(shaded, ax=ax, label="pressure [MPa]")
    ax.set_title(title(data, *chosen(data, side, patch)))
    _finish(ax, cells, _stick_line(ax, cells))
    return ax


def traction_map(
    data: Dataset, side: str | None = None, patch: int = 0, ax: Axes | None = None, *, slip: bool = True
) -> Axes:
    """Where one patch sticks and slips, with arrows of the traction on the wheel, or the upper body, and of the slip
    where it slips.

    Raises ValueError for a patch that is not there.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    cells = PatchCells.of(data, *chosen(data, side, patch))
    ax = axes_of(ax)
    colours = np.where(cells.sticks, REGIONS["stick"], REGIONS["slip"])
    ax.add_collection(PolyCollection(list(1e3 * cells.corners), facecolors=list(colours), edgecolors="face"))
    notes = _arrows(ax, cells, cells.traction, "0.1")
    slides = ~cells.sticks
    if slip and slides.any() and notes:
        moving = np.where(slides[:, None], cells.slip, 0.0)
        notes += _arrows(ax, cells, moving, EDGE, only=slides, says="orange: slip, longest {:.3g} of the speed")
    share = {name: float(cells.areas[cells.sticks == (name == "stick")].sum()) for name in REGIONS}
    handles = [
        Patch(color=colour, label=f"{name}s, {1e6 * share[name]:.3g} mm²")
        for name, colour in REGIONS.items()
        if share[name] > 0.0
    ]
    ax.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=8)
    ax.set_title(title(data, *chosen(data, side, patch)))
    _finish(ax, cells, notes)
    return ax


def _tall(cells: PatchCells) -> float:
    """Height over width."""
    return float(np.divide(*np.ptp(cells.corners, axis=(0, 1))[::-1]))


def _shaded(ax: Axes, cells: PatchCells, shade: Any) -> Any:
    from matplotlib.collections import PolyCollection

    patch = PolyCollection(list(1e3 * cells.corners), cmap=PRESSURE_MAP, norm=shade, edgecolors="face", linewidths=0.3)
    patch.set_array(1e-6 * cells.pressure)
    ax.add_collection(patch)
    return patch


def _finish(ax: Axes, cells: PatchCells, notes: list[str]) -> None:
    """Axes in true proportion, with notes below."""
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
    says: str = "",
) -> list[str]:
    """Arrows of vectors (n, 2), tractions [Pa] unless something else is said, and a word on their length."""
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
    return [says.format(largest) if says else f"longest arrow: traction of {1e-6 * largest:.3g} MPa on the {cells.on}"]


def _stick_line(ax: Axes, cells: PatchCells) -> list[str]:
    """The line between cells that stick and cells that slip, and a word on it; nothing without friction."""
    if not cells.traction.any():
        return []
    if cells.sticks.all() or not cells.sticks.any():
        return ["all sticks" if cells.sticks.all() else "all slips"]
    from matplotlib.collections import LineCollection

    ax.add_collection(LineCollection(list(1e3 * cells.stick_edge()), colors=EDGE, linewidths=1.6))
    return ["orange: edge between stick and slip"]
