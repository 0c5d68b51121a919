"""Track, wagon and vehicle of a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from wheelrail.vehicle.multibody.vehicle import Vehicle
    from wheelrail.vehicle.track.track import Track
    from wheelrail.vehicle.wagon.wagon import Wagon


def track(scene: RunScene) -> Track:
    """Track of the scene, with its irregularities."""
    return scene.track.track()


def track_before(scene: RunScene, vehicle: Vehicle) -> Track:
    """Track of a scene whose irregularities begin at the front wheelset, as runs start in equilibrium.

    Raises SceneError where they are too short.
    """
    try:
        return scene.track.track(max(vehicle.bodies[name].x for name in vehicle.wheelsets))
    except ValueError as error:
        raise SceneError(f"track.irregularities: {error}") from error


def wagon(scene: RunScene) -> Wagon:
    """Wagon of the scene, with the wheel radius of the scene."""
    return scene.vehicle.on(scene.wheelset.radius)


def vehicle_on(scene: RunScene, file: Path) -> Vehicle:
    """Vehicle of a file on the wheels of a scene.

    Parameters:
        scene: of a run; its wagon is not used.
        file: vehicle file.

    Raises SceneError, also for wheels of another radius than those of the scene, and for elastic axles or pads.
    """
    if scene.is_flexible:
        raise SceneError("wheelset.axle, track.pads: not allowed with a vehicle file, whose axles and track are rigid")
    vehicle = load_vehicle(file)
    if vehicle.radius != scene.wheelset.radius:
        text = f"must be {scene.wheelset.radius:g} m, wheelset.radius of the scene"
        raise SceneError(f"{file}: bodies.{vehicle.wheelsets[0]}.height = {vehicle.radius:g}: {text}")
    return vehicle
