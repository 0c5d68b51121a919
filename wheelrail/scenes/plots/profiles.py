"""Figure of the profiles of wheel and rail with contact points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.plots.patch_cells import touching
from wheelrail.scenes.plots.style import axes_of
from wheelrail.scenes.quantity import significant
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import Dataset

WHEEL, RAIL, MARK = "#0072B2", "0.25", "#D55E00"


def profiles_in_contact(data: Dataset, side: str | None = None, ax: Axes | None = None) -> Axes:
    """Plot the profiles of one side in their computed position, mm in the frame of the rail, with patch centres.

    Parameters:
        data: Dataset of `wheelrail.scenes.datasets.solution`.
        side: "left" or "right"; the first side in contact by default.
        ax: Matplotlib axes; new ones by default.

    Raises ValueError for a Hertz pair, which has no profiles, and for a missing side.
    """
    if "wheel_profile" not in data:
        raise ValueError("profiles: a Hertz pair has none")
    sides = [str(name) for name in data["side"].values]
    if side is None:
        side = next((name for name, _ in touching(data)), sides[0])
    if side not in sides:
        raise ValueError(f"side = {side!r}: must be {' or '.join(map(repr, sides))}")
    side_data = data.sel(side=side)
    sign = -1.0 if side == "right" else 1.0  # profile coordinates are positive to the field side
    wheel, rail = (
        side_data[f"{body}_profile"].dropna(f"{body}_point").values * (sign, 1.0) for body in ("wheel", "rail")
    )
    radius = float(data.attrs.get(f"radius_{side}", data.attrs["nominal_radius"]))
    rotation, origin = side_data["wheel_rotation"].values, side_data["wheel_origin"].values
    wheel_outline = _placed(wheel, origin, rotation, radius)
    points = [_resultant(data, side, k) for k in range(int(side_data["patches"]))]
    force = [1e-3 * float(side_data["patch_normal_force"][k]) for k in range(len(points))]
    labels = [f"contact, {significant(value)} kN" for value in force]
    return draw_profiles(wheel_outline, rail, points, labels, title=f"{side} wheel and rail", ax=ax)


def draw_profiles(
    wheel: Array, rail: Array, points: Sequence[Array], labels: Sequence[str], *, title: str, ax: Axes | None = None
) -> Axes:
    """Plot profiles and contact points, mm, to scale.

    Parameters:
        wheel, rail: (n, 2) curves, m, y to the left and z up, in one frame.
        points: (2,) contact points, m, in the same frame.
        labels: of the points.
        title: of the axes.
        ax: Matplotlib axes; new ones by default.
    """
    ax = axes_of(ax, (7.2, 4.0))
    for curve, colour, name in ((rail, RAIL, "rail"), (wheel, WHEEL, "wheel")):
        ax.plot(*(1e3 * curve.T), color=colour, label=name, lw=1.3)
    for index, (point, label) in enumerate(zip(points, labels, strict=True)):
        y, z = 1e3 * point
        ax.plot([y], [z], "oD^v"[index % 4], color=MARK, ms=6, mec="white", mew=0.8, label=label, zorder=5)
    ax.set_aspect("equal")
    ax.set_title(title)
    ax.set_xlabel("y from the top of the rail, positive to the left [mm]")
    ax.set_ylabel("z, positive upwards [mm]")
    ax.legend(loc="lower center", ncols=2 + len(points), bbox_to_anchor=(0.5, 0.02), fontsize=8)
    ax.set_ylim(1e3 * min(rail[:, 1].min(), wheel[:, 1].min()) - 9.0, 1e3 * wheel[:, 1].max() + 3.0)
    return ax


def _placed(wheel: Array, origin: Array, rotation: Array, radius: float) -> Array:
    """Lowest line of the wheel (n, 2), m, in the frame of the rail, from its profile points (n, 2), m."""
    points = np.column_stack([np.zeros(len(wheel)), wheel[:, 0], -(radius + wheel[:, 1])])
    return np.asarray((points @ rotation.T + origin)[:, 1:])


def _resultant(data: Dataset, side: str, patch: int) -> Array:
    """Point of application of the pressure (2,), m, in the frame of the rail."""
    of_patch = ((data["point_side"] == side) & (data["point_patch"] == patch)).values
    weight = data["pressure"].values[of_patch] * data["area"].values[of_patch]
    return np.asarray(weight @ data["position"].values[of_patch][:, 1:] / weight.sum())
