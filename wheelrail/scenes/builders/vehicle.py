"""Track and wagon of a run's scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from wheelrail.vehicle.track.track import Track
    from wheelrail.vehicle.wagon.wagon import Wagon


def track(scene: RunScene) -> Track:
    """Track of the scene, with its irregularities."""
    return scene.track.track()


def wagon(scene: RunScene) -> Wagon:
    """Wagon of the scene, with the wheel radius of the scene."""
    return scene.vehicle.on(scene.wheelset.radius)
