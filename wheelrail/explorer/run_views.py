"""Pictures of a run at one instant: forces with a cursor, and the patches of every wheel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wheelrail.explorer.views import COLOURS, PRESENT, Panel
from wheelrail.scenes.plots.drawing import Drawing, Line, Segments
from wheelrail.scenes.plots.style import SERIES, SIDES
from wheelrail.scenes.quantities import RUN
from wheelrail.scenes.quantity import significant

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.support.arrays import Array

# Quantities with a curve of each wheel, or of each wheelset.
CURVES = (
    *("vertical_force", "lateral_force", "derailment_quotient", "t_gamma", "patch_max_pressure"),
    "track_shifting_force",
)
FIRST_CURVES = ("vertical_force", "lateral_force")
MOST = 1000  # points of a curve on the page
ELLIPSE = np.linspace(0.0, 2.0 * np.pi, 41)


def values(data: Dataset, name: str) -> Array:
    """Values (time, wheelset, side), or (time, wheelset, 1): of a patch quantity the largest of all patches."""
    own = data[name]
    if "patch" in own.dims:
        own = own.max("patch")
    found = own.transpose("time", "wheelset", ...).values
    return np.asarray(found if found.ndim == 3 else found[..., None])


def largest(data: Dataset, name: str) -> tuple[int, int]:
    """Sample and number of the wheelset with the largest absolute value. Raises ValueError where there is none."""
    size = np.abs(values(data, name)).max(axis=2, initial=-1.0, where=np.isfinite(values(data, name)))
    sample, wheelset = np.unravel_index(int(np.argmax(size)), size.shape)
    if size[sample, wheelset] < 0.0:
        raise ValueError(f"{RUN[name].title}: has no values")
    return int(sample), int(wheelset)


@dataclass(frozen=True)
class Curves:
    """Curves of a run over the distance, with few enough points for a page; extremes between them are kept.

    Parameters:
        data: Dataset of the run.
        names: in CURVES.
        wheelset: number of the wheelset.
    """

    data: Dataset
    names: tuple[str, ...]
    wheelset: int

    def panels(self, sample: int) -> list[Panel]:
        """Pictures with the cursor at a sample."""
        distance = self.data["distance"].values
        return [self._panel(name, distance, sample) for name in self.names]

    def _panel(self, name: str, distance: Array, sample: int) -> Panel:
        quantity, own = RUN[name], RUN[name].scale * values(self.data, name)[:, self.wheelset]
        sides = tuple(SIDES) if own.shape[1] == len(SIDES) else ("",)
        lines = []
        for number, side in enumerate(sides):
            style = SIDES.get(side, SERIES[0])
            kept = thinned(own[:, number])
            text = significant(float(own[sample, number]), 4) if np.isfinite(own[sample, number]) else "–"
            label = " ".join(filter(None, (side, text)))
            lines.append(Line(np.column_stack([distance, own[:, number]])[kept], style["color"], label, number > 0))
        good = own[np.isfinite(own)]
        low, high = (float(good.min()), float(good.max())) if good.size else (0.0, 1.0)
        cursor = Segments(np.array([[[distance[sample], low], [distance[sample], high]]]), PRESENT)
        title = f"{quantity.title}, {self.data['wheelset'].values[self.wheelset]}"
        drawing = Drawing(title, RUN["distance"].caption, quantity.axis, (*lines, cursor))
        return Panel(name, "", drawing)


def thinned(own: Array) -> NDArray[np.intp]:
    """Indices of at most MOST values, with the smallest and the largest one of every interval."""
    if len(own) <= MOST:
        return np.arange(len(own))
    parts = np.array_split(np.arange(len(own)), MOST // 2)
    filled = np.nan_to_num(own, nan=0.0)
    ends = np.array([part[pick(filled[part])] for part in parts for pick in (np.argmin, np.argmax)])
    return np.asarray(np.unique(ends))


def patch_panels(data: Dataset, sample: int) -> list[Panel]:
    """Patches of every wheel at a sample: ellipses of their second moments in plan view, on a common scale."""
    now = data.isel(time=sample)
    panels = []
    reach = 1e3 * float(np.nanmax([data[f"patch_semi_axis_{axis}"].max() for axis in "xy"], initial=1e-3))
    for wheelset in data["wheelset"].values.tolist():
        for side in SIDES:
            own = now.sel(wheelset=wheelset, side=side)
            lines = []
            for patch in np.flatnonzero(np.isfinite(own["patch_normal_force"].values)):
                one = own.isel(patch=patch)
                x, y, a, b, force = (
                    float(one[name])
                    for name in ("patch_x", "rail_y", "patch_semi_axis_x", "patch_semi_axis_y", "patch_normal_force")
                )
                sign = -1.0 if side == "right" else 1.0
                ellipse = [x + a * np.cos(ELLIPSE), sign * y + b * np.sin(ELLIPSE)]
                quantity = RUN["patch_normal_force"]
                label = f"{quantity.texts([force])} {quantity.shown}"
                lines.append(Line(1e3 * np.column_stack(ellipse), COLOURS[patch % len(COLOURS)], label))
            middle = 42.0
            drawing = Drawing(
                f"{wheelset}, {side} wheel{'' if lines else ': no contact'}",
                "longitudinal, positive forward [mm]",
                "from the top of the rail, positive to the left [mm]",
                tuple(lines),
                equal=True,
                x_limits=(-2.0 * reach, 2.0 * reach),
                y_limits=(-middle, middle),
            )
            panels.append(Panel("patches", side, drawing))
    return panels
