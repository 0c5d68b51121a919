"""Pressure and traction along a line through the centre of a patch, compared with the Hertz pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from wheelrail.scenes.plots.patch_cells import PatchCells, chosen, title, upper_body
from wheelrail.scenes.plots.style import axes_of
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

    from wheelrail.contact.analytical.hertz import Hertz

PRESSURE, TRACTION, CLOSED = "#0072B2", "#009E73", "#D55E00"
LABELS = {
    "x": "x from the resultant of the patch, positive forward [mm]",
    "y": "y from the resultant of the patch, positive to the left [mm]",
}


def section(
    data: Dataset,
    along: Literal["x", "y"] = "x",
    *,
    side: str | None = None,
    patch: int = 0,
    hertz: bool = True,
    ax: Axes | None = None,
) -> Axes:
    """Plot pressure and traction, MPa, in the cells next to the line x or y through the resultant of a patch, mm.

    Parameters:
        data: Dataset of `wheelrail.scenes.datasets.solution`.
        along: "x" or "y".
        side: of the patch; the first side in contact by default.
        patch: index by decreasing load.
        hertz: whether to add the Hertz pressure for the same normal force and the curvatures at the patch centre, if
            both are known and positive.
        ax: Matplotlib axes; new ones by default.

    Raises ValueError for another line or a missing patch.
    """
    if along not in LABELS:
        raise ValueError(f'along = {along!r}: must be "x" or "y"')
    side, patch = chosen(data, side, patch)
    cells, axis = PatchCells.of(data, side, patch), "xy".index(along)
    ax = axes_of(ax)
    at, row = through(cells, axis)
    ax.plot(1e3 * at, 1e-6 * cells.pressure[row], "o-", ms=3.5, color=PRESSURE, label="pressure")
    if cells.traction.any():
        traction = np.hypot(*cells.traction[row].T)
        ax.plot(1e3 * at, 1e-6 * traction, "s", ms=3, ls=(0, (5, 1.5)), color=TRACTION, label="traction")
        friction = data.attrs.get("friction", 0.0)
        bound = (np.nan if isinstance(friction, str) else friction) * cells.pressure[row]  # a law: bound not constant
        ax.plot(1e3 * at, 1e-6 * bound, color="0.45", lw=0.9, ls=(0, (1, 1)), label="friction bound")
    solution = closed_form(data, side, patch) if hertz else None
    if solution is not None:
        half = solution.semi_axes[axis]
        line = half * np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 201))
        zero = np.zeros_like(line)
        values = solution.pressure(*((line, zero) if axis == 0 else (zero, line)))
        label = f"Hertz, {1e-6 * solution.peak:.0f} MPa, semi-axis {1e3 * half:.2f} mm"
        ax.plot(1e3 * line, 1e-6 * values, color=CLOSED, ls=(0, (4, 1.5)), label=label)
    ax.set_ylim(bottom=0.0)
    ax.set_title(title(data, side, patch))
    ax.set_xlabel(LABELS[along])
    ax.set_ylabel(f"on the {upper_body(side)} [MPa]")
    ax.legend(loc="best")
    return ax


def through(cells: PatchCells, axis: int) -> tuple[Array, NDArray[np.int64]]:
    """Coordinates (k,), m, along an axis (0 forward, 1 left), increasing, and indices (k,) of the nearest cells.

    Of each line of cells across the axis the nearest cell is taken, if the line reaches the axis.
    """
    low, high = cells.corners.min(axis=1), cells.corners.max(axis=1)
    normal_axis = 1 - axis
    middle = cells.middle
    if axis == 0:  # the strip of cells that lies under the axis
        strip = np.flatnonzero((low[:, 1] <= 0.0) & (high[:, 1] >= 0.0))
        if not strip.size:
            strip = np.array([int(np.abs(middle[:, 1]).argmin())])
        row = (
            np.abs(middle[:, 1] - middle[strip[np.abs(middle[strip, 1]).argmin()], 1])
            < 1e-3 * np.ptp(low[:, 1]) + 1e-12
        )
        cells_near = np.flatnonzero(row)
    else:
        cells_near = np.flatnonzero((low[:, normal_axis] <= 0.0) & (high[:, normal_axis] > 0.0))
    cells_near = cells_near[np.argsort(middle[cells_near, axis], kind="stable")]
    return middle[cells_near, axis], cells_near


def closed_form(data: Dataset, side: str, patch: int) -> Hertz | None:
    """Hertz solution for the normal force and curvatures of a patch; None if these are unknown or not positive."""
    from wheelrail.contact.analytical.hertz import hertz

    if "patch_gap_curvature_x" not in data:
        return None
    patch_data = data.sel(side=side).isel(patch=patch)
    A, B, force = (
        float(patch_data[f"patch_{name}"]) for name in ("gap_curvature_x", "gap_curvature_y", "normal_force")
    )
    if not (A > 0.0 and B > 0.0 and force > 0.0):
        return None
    return hertz(A, B, float(data.attrs["contact_modulus"]), force=force)
