"""Figure of the profiles of wheel and rail with contact points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.drawing import Drawing, Line, Marker
from wheelrail.scenes.plots.patch_cells import touching
from wheelrail.scenes.plots.render import draw
from wheelrail.scenes.plots.style import axes_of
from wheelrail.scenes.quantity import significant
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

WHEEL, RAIL, MARK = "#0072B2", "#404040", "#D55E00"
MARKERS: tuple[Marker, ...] = ("o", "D", "^", "v")


def profiles_in_contact(data: Dataset, side: str | None = None, ax: Axes | None = None) -> Axes:
    """Plot the profiles of one side in their computed position, mm in the frame of the rail, with patch centres.

    Parameters:
        data: Dataset of `wheelrail.scenes.datasets.solution`.
        side: "left" or "right"; the first side in contact by default.
        ax: Matplotlib axes; new ones by default.

    Raises ValueError for a Hertz pair, which has no profiles, and for a missing side.
    """
    return draw(profiles_drawing(data, side), axes_of(ax, (7.2, 4.0)))


def profiles_drawing(data: Dataset, side: str | None = None) -> Drawing:
    """Drawing of `profiles_in_contact`, with its parameters."""
    if "wheel_profile" not in data:
        raise ValueError("profiles: a Hertz pair has none")
    sides = [str(name) for name in data.variables["side"].values]
    if side is None:
        side = next((name for name, _ in touching(data)), sides[0])
    if side not in sides:
        raise ValueError(f"side = {side!r}: must be {' or '.join(map(repr, sides))}")
    names = ("wheel_profile", "rail_profile", "wheel_origin", "wheel_rotation", "patches", "patch_normal_force")
    at = {"side": sides.index(side)}
    wheel, rail, origin, rotation, count, force = (
        data.variables[name].isel(at, missing_dims="ignore").values for name in names
    )
    sign = -1.0 if side == "right" else 1.0  # profile coordinates are positive to the field side
    wheel, rail = (curve[np.isfinite(curve).all(axis=1)] * (sign, 1.0) for curve in (wheel, rail))
    radius = float(data.attrs.get(f"radius_{side}", data.attrs["nominal_radius"]))
    points = [_resultant(data, side, k) for k in range(int(count))]
    labels = [f"contact, {significant(1e-3 * value)} kN" for value in force[: len(points)]]
    title = f"{side} wheel and rail"
    return outlines_drawing(title, _placed(wheel, origin, rotation, radius), rail, points, labels)


def outlines_drawing(title: str, wheel: Array, rail: Array, points: Sequence[Array], labels: Sequence[str]) -> Drawing:
    """Drawing of profiles and contact points, mm, to scale.

    Parameters:
        title: of the drawing.
        wheel, rail: (n, 2) curves, m, y to the left and z up, in one frame.
        points: (2,) contact points, m, in the same frame.
        labels: of the points.
    """
    return Drawing(
        title,
        "y from the top of the rail, positive to the left [mm]",
        "z, positive upwards [mm]",
        (
            Line(1e3 * rail, RAIL, "rail"),
            Line(1e3 * wheel, WHEEL, "wheel"),
            *(
                Line(1e3 * point[None], MARK, label, width=0.0, marker=MARKERS[index % len(MARKERS)])
                for index, (point, label) in enumerate(zip(points, labels, strict=True))
            ),
        ),
        equal=True,
        y_limits=(1e3 * float(min(rail[:, 1].min(), wheel[:, 1].min())) - 9.0, 1e3 * float(wheel[:, 1].max()) + 3.0),
    )


def _placed(wheel: Array, origin: Array, rotation: Array, radius: float) -> Array:
    """Lowest line of the wheel (n, 2), m, in the frame of the rail, from its profile points (n, 2), m."""
    points = np.column_stack([np.zeros(len(wheel)), wheel[:, 0], -(radius + wheel[:, 1])])
    return np.asarray((points @ rotation.T + origin)[:, 1:])


def _resultant(data: Dataset, side: str, patch: int) -> Array:
    """Point of application of the pressure (2,), m, in the frame of the rail."""
    fields = data.variables
    of_patch = (fields["point_side"].values == side) & (fields["point_patch"].values == patch)
    weight = fields["pressure"].values[of_patch] * fields["area"].values[of_patch]
    return np.asarray(weight @ fields["position"].values[of_patch][:, 1:] / weight.sum())
