"""One moment of a run in three dimensions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.views.animation import Animation

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.kinematics.wheelset_state import Mounting
    from wheelrail.meshes.profiles.profile import Profile


def hardest(data: Dataset) -> int:
    """The sample with the largest lateral force on a wheel, either way."""
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
    """A pyvista plotter as a film of the run shows that sample, see `animation.animate_run`, off screen: the wheelset
    on its rails with the forces, and both contacts close up.

    scale: of the wheelset's displacements in the upper pane, true unless given. Raises IndexError for a sample that is
    not there.
    """
    count = data.sizes["time"]
    if not -count <= index < count:
        raise IndexError(f"sample {index}: the run has {count}")
    film = Animation(data, wheel, rail, mounting, scale)
    film.show(index % count)
    film.view.title = title
    return film.view
