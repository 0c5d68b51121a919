"""Picture of the patches of a contact solve: pressure, tractions on the wheel, where the surfaces stick."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from scenes.pictures.style import PRESSURE_MAP, STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contact.laws import Laws
    from contact.result import ContactResult, Fields

Array = NDArray[np.float64]

ARROWS = 15  # over the longer side of a patch


@dataclass(frozen=True)
class PatchCells:
    """Loaded cells of one patch seen from above in its contact plane, forward and to the left of its resultant:
    corners (n, 4, 2) m, pressure (n,) Pa, traction (n, 2) Pa on the wheel, sticks (n,).
    """

    corners: Array
    pressure: Array
    traction: Array
    sticks: NDArray[np.bool_]

    @property
    def middle(self) -> Array:
        return np.asarray(self.corners.mean(axis=1))

    def stick_edge(self) -> Array:
        """Pieces (k, 2, 2) m of the sides that cells which stick share with cells which slip."""
        low, high = self.corners.min(axis=1), self.corners.max(axis=1)
        size = high - low
        pieces: list[Array] = []
        for one, other in ((self.sticks, ~self.sticks), (~self.sticks, self.sticks)):
            a, b = np.flatnonzero(one), np.flatnonzero(other)
            for axis in (0, 1):  # a side of the first cell across this axis, and the cell beyond it
                across = 1 - axis
                apart = np.abs(high[a, None, axis] - low[b, axis])
                start = np.maximum(low[a, None, across], low[b, across])
                stop = np.minimum(high[a, None, across], high[b, across])
                near = apart < 0.2 * np.minimum(size[a, None, axis], size[b, axis])
                least = np.minimum(size[a, None, across], size[b, across])
                i, j = np.nonzero(near & (stop - start > 1e-2 * least))
                side = 0.5 * (high[a[i], axis] + low[b[j], axis])
                ends = np.empty((len(i), 2, 2))
                ends[..., axis] = side[:, None]
                ends[:, 0, across], ends[:, 1, across] = start[i, j], stop[i, j]
                pieces.append(ends)
        return np.concatenate(pieces)

    @classmethod
    def of(cls, fields: Fields, patch: int, laws: Laws, *, mirrored: bool = False) -> PatchCells:
        """Cells in their true lengths; mirrored for a right-hand pair, whose fields are those of its mirror image."""
        own = fields.patch == patch
        weight = (fields.pressure * fields.area)[own]
        up = -(weight @ fields.axes[own, 2])
        up /= np.linalg.norm(up)
        forward = np.array([1.0, 0.0, 0.0]) - up[0] * up
        forward /= np.linalg.norm(forward)
        plane = np.column_stack([forward, np.cross(up, forward) * (-1.0 if mirrored else 1.0)])
        point = fields.point[own] - weight @ fields.point[own] / weight.sum()
        step = fields.step[own]
        half = 0.5 * np.stack([step, fields.area[own] / step], axis=1)[..., None] * fields.axes[own, :2]
        signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        corners = (point[:, None] + np.einsum("ks,nsc->nkc", signs, half)) @ plane
        traction = np.einsum("ns,nsc->nc", fields.traction[own], fields.axes[own, :2]) @ plane
        return cls(corners, fields.pressure[own], traction, _sticks(fields, own, laws))


def _sticks(fields: Fields, own: NDArray[np.bool_], laws: Laws) -> NDArray[np.bool_]:
    """Where the surfaces stick, if the model does not say so: traction below its bound, or no slip where that falls."""
    if fields.sticks is not None:
        return fields.sticks[own]
    if laws.falling is None:
        return np.asarray(np.hypot(*fields.traction[own].T) < (1 - 1e-6) * laws.friction * fields.pressure[own])
    slip = np.hypot(*fields.slip[own].T)
    return np.asarray(slip <= max(laws.regularisation, 1e-6 * float(slip.max(initial=0.0))))


def draw_patches(results: Mapping[str, ContactResult], laws: Laws, file: Path) -> None:
    """Write the picture; its format is that of the file's ending. Raises ValueError when nothing touches, or for an
    ending that is no picture's.
    """
    from matplotlib import rc_context

    with rc_context(STYLE):
        patches_figure(results, laws).savefig(file)


def patches_figure(results: Mapping[str, ContactResult], laws: Laws) -> Figure:
    """A column for every side, its patches below one another, on one scale of pressure."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    shown = {side: result for side, result in results.items() if result.ok and result.patches}
    if not shown:
        raise ValueError("nothing touches: there is no patch to draw")
    rows = max(len(result.patches) for result in shown.values())
    cells = {side: _cells(side, result, laws) for side, result in shown.items()}
    tall = [
        max(float(np.divide(*np.ptp(own[k].corners, axis=(0, 1))[::-1])) for own in cells.values() if k < len(own))
        for k in range(rows)
    ]
    heights = [1.3 + 3.4 * min(ratio, 1.6) for ratio in tall]
    figure = Figure(figsize=(1.2 + 4.4 * len(shown), sum(heights)), layout="constrained")
    axes = figure.subplots(rows, len(shown), squeeze=False, gridspec_kw={"height_ratios": heights})
    peak = max(patch.max_pressure for result in shown.values() for patch in result.patches)
    shade = Normalize(0.0, 1e-6 * peak)
    for column, (side, result) in zip(axes.T, shown.items(), strict=True):
        name = "contact" if side == "contact" else f"{side} wheel"
        for index, ax in enumerate(column):
            if index >= len(result.patches):
                ax.set_axis_off()
                continue
            which = f", patch {index + 1}" if len(result.patches) > 1 else ""
            ax.set_title(f"{name}{which}: {1e-3 * result.patches[index].normal_force:.3g} kN")
            _draw(ax, cells[side][index], shade)
    figure.colorbar(ScalarMappable(shade, PRESSURE_MAP), ax=axes[0], aspect=25, label="pressure [MPa]")
    return figure


def _cells(side: str, result: ContactResult, laws: Laws) -> list[PatchCells]:
    assert result.fields is not None
    fields = result.fields
    return [PatchCells.of(fields, k, laws, mirrored=side == "right") for k in range(len(result.patches))]


def _draw(ax: Axes, cells: PatchCells, shade: object) -> None:
    from matplotlib.collections import PolyCollection

    patch = PolyCollection(list(1e3 * cells.corners), cmap=PRESSURE_MAP, norm=shade, edgecolors="face", linewidths=0.3)
    patch.set_array(1e-6 * cells.pressure)
    ax.add_collection(patch)
    notes = []
    largest = float(np.hypot(*cells.traction.T).max())
    if largest > 0:
        at = _spread(cells)
        (x, y), (u, v) = 1e3 * cells.middle[at].T, cells.traction[at].T / largest
        length = float(np.ptp(1e3 * cells.corners.reshape(-1, 2), axis=0).max()) / ARROWS
        ax.quiver(
            x,
            y,
            u,
            v,
            angles="xy",
            scale_units="xy",
            scale=0.7 / length,
            color="white",
            width=0.004,
            edgecolor="0.2",
            linewidth=0.3,
        )
        notes.append(f"longest arrow: traction of {1e-6 * largest:.3g} MPa on the wheel")
        notes.append(_stick_line(ax, cells))
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.margins(0.06)
    ax.set_xlabel("\n".join(["along, forward [mm]", *notes]))
    ax.set_ylabel("across, to the left [mm]")


def _stick_line(ax: Axes, cells: PatchCells) -> str:
    """The line between cells that stick and cells that slip, and a word on it."""
    if cells.sticks.all() or not cells.sticks.any():
        return "all sticks" if cells.sticks.all() else "all slips"
    from matplotlib.collections import LineCollection

    ax.add_collection(LineCollection(list(1e3 * cells.stick_edge()), colors="#D55E00", linewidths=1.6))
    return "orange: edge between stick and slip"


def _spread(cells: PatchCells) -> NDArray[np.int64]:
    """Some cells, about evenly over the patch."""
    middle = cells.middle
    box = float(np.ptp(middle, axis=0).max()) / ARROWS or 1.0
    _, first = np.unique(np.floor(middle / box), axis=0, return_index=True)
    return np.asarray(first)
