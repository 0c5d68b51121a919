"""3D view of one instant of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.views.animation import Animation, RunBodies

if TYPE_CHECKING:
    from xarray import Dataset


def largest_force_sample(data: Dataset) -> int:
    """Index of the sample with the largest absolute lateral force on a wheel."""
    force = np.abs(data["lateral_force"].transpose("time", "side").values).max(axis=1)
    return int(np.argmax(np.where(np.isfinite(force), force, -1.0)))


def sample_view(
    data: Dataset,
    index: int,
    bodies: RunBodies,
    *,
    title: str = "",
    scale: float = 1.0,
) -> Any:
    """Off-screen PyVista plotter of one sample, as in `animation.animate_run`.

    Parameters:
        data: Dataset of the run.
        index: of the sample.
        bodies: profiles and mounting of wheel and rail.
        title: of the view.
        scale: displacement magnification factor of the wheelset in the upper pane.

    Raises IndexError for a missing sample.
    """
    count = data.sizes["time"]
    if not -count <= index < count:
        raise IndexError(f"index = {index}: the run has {count} samples")
    animation = Animation(data, bodies, scale)
    animation.show(index % count)
    animation.view.title = title
    return animation.view
