"""Run of a vehicle in three dimensions: equations of motion of a scene and a vehicle file, and its Dataset."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.builders.vehicle import applied_loads, track_before, vehicle_on
from wheelrail.scenes.runs.steady import failures_as_run_failed
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.contact.results.vehicle_contact import VehicleContact
    from wheelrail.vehicle.multibody.vehicle import Vehicle
    from wheelrail.vehicle.simulation.history import History
    from wheelrail.vehicle.simulation.time_run import Progress, Recording


def vehicle_for_run(scene: RunScene, file: Path) -> Vehicle:
    """Vehicle of a file, for a run of a scene. Raises SceneError, also for an explicit method or a kick of no body."""
    if scene.solver.method not in ("rosenbrock", "rosenbrock4"):
        text = f'solver.method = "{scene.solver.method}": must be "rosenbrock" or "rosenbrock4" with a vehicle file'
        raise SceneError(f"{text}: the spin of its wheelsets on the creep forces is stiff")
    vehicle = vehicle_on(scene, file)
    for body in scene.kick or {}:
        if body not in vehicle.names:
            raise SceneError(f"kick.{body}: must be one of {', '.join(vehicle.names)}, the bodies of {file}")
    applied_loads(scene, vehicle)  # validates them
    return replace(vehicle, speed_hold=None) if scene.vehicle.free_speed else vehicle


def simulate_on_track(
    scene: RunScene, vehicle: Vehicle, contact: VehicleContact, end: float, recording: Recording, progress: Progress
) -> History:
    """Motion of a vehicle along the track of a scene.

    Parameters:
        scene: of the run.
        vehicle: from `vehicle_for_run`.
        contact: of its wheels.
        end: s, at which the reference motion reaches the end of the track.
        recording: rows and checkpoints.
        progress: called at each accepted step.

    A vehicle that runs free does so until it reaches the end of the track itself, or stops. Raises RunFailed when a
    kicked vehicle has no equilibrium to start from, and SceneError as `track_before`.
    """
    from wheelrail.vehicle.integration.integrate import StepSettings
    from wheelrail.vehicle.multibody.equations import VehicleDynamics
    from wheelrail.vehicle.simulation.limit_cycle import kicked
    from wheelrail.vehicle.simulation.limits import SLOWEST
    from wheelrail.vehicle.simulation.simulate import simulate
    from wheelrail.vehicle.steady.start_state import start_state

    rails, initial, until = track_before(scene, vehicle), None, inf
    loads = applied_loads(scene, vehicle)
    dynamics = VehicleDynamics(vehicle, rails, contact, scene.vehicle.speed_profile, loads=loads)
    if dynamics.runs_free:
        until = scene.track.length
        end = until / SLOWEST
    resumed = recording.checkpoints is not None and recording.checkpoints.latest is not None
    if scene.kick and not resumed:
        with failures_as_run_failed():
            at_start = replace(dynamics, speed=scene.vehicle.first_speed)
            initial = kicked(dynamics.coordinates, start_state(at_start), scene.kick)
    return simulate(
        dynamics,
        (0.0, end),
        initial=initial,
        steps=StepSettings(scene.solver.method, scene.solver.rtol, scene.solver.atol),
        recording=recording,
        progress=progress,
        until=until,
    )


def vehicle_run_dataset(history: History, text: str, scene: RunScene, file: Path) -> Dataset:
    """Dataset of a run with wear and forces of running safety.

    Parameters:
        history: of the run.
        text: of the scene file.
        scene: the same, validated.
        file: of the vehicle.
    """
    from wheelrail.scenes.datasets.vehicle_run import vehicle_dataset
    from wheelrail.scenes.schema.toml import read_text

    return vehicle_dataset(history, scene=text, vehicle=read_text(file), shear_yield=scene.output.shear_yield)
