"""3D view of one instant of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.views.animation import Animation

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.kinematics.wheelset_state import Mounting
    from wheelrail.meshes.profiles.profile import Profile


def hardest(data: Dataset) -> int:
    """Index of the sample with the largest absolute lateral force on a wheel."""
    force = np.abs(data["lateral_force"].transpose("time", "side").values).max(axis=1)
    return int(np.argmax(np.where(np.isfinite(force), force, -1.0)))


def moment_view(
    data: Dataset,
    index: int,
    *,
    wheel: Profile,
    rail: Profile,
    mounting: Mounting,
    title: str = "",
    scale: float = 1.0,
) -> Any:
    """Off-screen PyVista plotter of one sample, as in `animation.animate_run`.

    Parameters:
        data: Dataset of the run.
        index: of the sample.
        wheel, rail: profiles, the rail inclined.
        mounting: positions of wheels on the axle and rails in the track.
        title: of the view.
        scale: displacement magnification factor of the wheelset in the upper pane.

    Raises IndexError for a missing sample.
    """
    count = data.sizes["time"]
    if not -count <= index < count:
        raise IndexError(f"index = {index}: the run has {count} samples")
    animation = Animation(data, wheel, rail, mounting, scale)
    animation.show(index % count)
    animation.view.title = title
    return animation.view
