"""3D view of one instant of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.views.animation import Animation, RunBodies

if TYPE_CHECKING:
    from xarray import Dataset


def largest_force(data: Dataset) -> tuple[int, str]:
    """Index of the sample, and the wheelset, with the largest absolute lateral force on a wheel."""
    force = np.abs(data["lateral_force"].transpose("time", "wheelset", "side").values).max(axis=2)
    index, wheelset = np.unravel_index(np.argmax(np.where(np.isfinite(force), force, -1.0)), force.shape)
    return int(index), str(data["wheelset"].values[wheelset])


def sample_view(
    data: Dataset,
    index: int,
    bodies: RunBodies,
    wheelset: str,
    *,
    title: str = "",
    scale: float = 1.0,
) -> Any:
    """Off-screen PyVista plotter of one sample, as in `animation.Animation`.

    Parameters:
        data: Dataset of the run.
        index: of the sample.
        bodies: profiles and mounting of wheel and rail.
        wheelset: its name.
        title: of the view.
        scale: displacement magnification factor of the wheelset in the upper pane.

    Raises IndexError for a missing sample.
    """
    count = data.sizes["time"]
    if not -count <= index < count:
        raise IndexError(f"index = {index}: the run has {count} samples")
    animation = Animation(data, bodies, wheelset, scale)
    animation.show(float(data["time"].values[index]))
    animation.view.title = title
    return animation.view
