"""Track and wagon of a run's scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from wheelrail.vehicle.track.track import Track
    from wheelrail.vehicle.wagon.wagon import Wagon


def track(scene: RunScene) -> Track:
    """The scene's track, with irregularities if it has any."""
    return scene.track.track()


def wagon(scene: RunScene) -> Wagon:
    """The scene's wagon on the scene's wheels."""
    return scene.vehicle.on(scene.wheelset.radius)
