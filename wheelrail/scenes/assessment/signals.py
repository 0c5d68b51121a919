"""Signals of a stored run that are assessed: forces of the wheels, accelerations on the floor, track."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.scenes.builders.vehicle import applied_loads, floor_points, run_track, vehicle_on
from wheelrail.scenes.builders.vehicle_file import parse_vehicle
from wheelrail.scenes.datasets.input_files import scene_of_run
from wheelrail.scenes.runs.safety_table import with_forces
from wheelrail.support.arrays import Array
from wheelrail.vehicle.evaluation.on_track import RunSignals, constant_parts
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.vehicle import COORDINATES
from wheelrail.vehicle.track.speed_profile import SpeedProfile

if TYPE_CHECKING:
    from xarray import Dataset

    from wheelrail.scenes.schema.scene import RunScene
    from wheelrail.vehicle.multibody.vehicle import Vehicle
    from wheelrail.vehicle.track.track import Track

STATION = 0.25  # m, between places at which curvature and cant are compared
FASTEST = 100.0  # Hz, of the weightings of comfort
BAND = 10.0  # Hz, of accelerations


def signals_of(data: Dataset, file: Path, name: str, floor: float) -> tuple[RunSignals, list[str]]:
    """Signals of a run, and remarks.

    Parameters:
        data: Dataset of the run.
        file: its place, for errors.
        name: of the run, for readers.
        floor: height of the floor of car bodies above top of rail, m.

    Raises SceneError for a run without forces over more than 2 m, or whose vehicle cannot be read.
    """
    section, remarks = with_forces(data, file)
    scene = scene_of_run(data, file)
    text = str(data.attrs["vehicle"])
    vehicle = parse_vehicle(text, file) if text else vehicle_on(scene)
    track = run_track(scene, vehicle)
    points = floor_points(vehicle, floor)
    if not points:
        remarks.append("No accelerations: no car body moves freely in all directions")
    states, complete = _states(section, Coordinates(vehicle))
    if points and not complete:
        points = {}
        remarks.append("No accelerations: the results lack internal variables of the suspension elements")
    acceleration, roll = _accelerations(vehicle, scene, track, section["time"].values, states, points)
    stations = np.arange(0.0, scene.track.length + STATION, STATION)
    curvature, lift = (
        np.array([function(s)[0] for s in stations.tolist()]) for function in (track.curvature, track.superelevation)
    )
    remarks += _resolution(section["time"].values, bool(points))
    signals = RunSignals(
        name=name,
        time=section["time"].values,
        distance=section["distance"].values,
        wheelsets={wheelset: vehicle.bodies[wheelset].x for wheelset in vehicle.wheelsets},
        guiding=section["guiding_force"].values,
        load=section["vertical_force"].values,
        points={label: point[0] for label, (_, point) in points.items()},
        acceleration=acceleration,
        roll_rate=roll,
        parts=constant_parts(stations, curvature, lift),
        base=track.base,
        gravity=vehicle.gravity,
        wheel_load=float(data.attrs["mean_wheel_load"]),
    )
    return signals, [f"{name}: {remark}" for remark in remarks]


def _states(section: Dataset, coordinates: Coordinates) -> tuple[Array, bool]:
    """States (n, 2 c + m) without motions of structures, and whether internal variables are known."""
    names = [f"body_{name}{rate}" for rate in ("", "_rate") for name in COORDINATES]
    moving = np.stack([section[name].transpose("time", "body").values for name in names], axis=-1)
    count = len(moving)
    parts = [moving[..., :6].reshape(count, -1)[:, coordinates.free], moving[..., 6:].reshape(count, -1)]
    parts[1] = parts[1][:, coordinates.free]
    inner = len(coordinates.internal)
    known = inner == section.sizes.get("series", 0)
    values = section["series_deflection"].values if known and inner else np.zeros((count, inner))
    parts.append(values @ coordinates.from_series.T)
    return np.concatenate(parts, axis=1), known


def _accelerations(
    vehicle: Vehicle,
    scene: RunScene,
    track: Track,
    time: Array,
    states: Array,
    points: dict[str, tuple[str, tuple[float, float, float]]],
) -> tuple[Array, Array]:
    """Accelerations minus gravity (n, p, 3) m/s2 of points, and roll rates (n, p) rad/s of their bodies."""
    from wheelrail.vehicle.multibody.applied_forces import AppliedForces
    from wheelrail.vehicle.multibody.body_equations import BodyEquations
    from wheelrail.vehicle.multibody.suspension_arrays import SuspensionArrays
    from wheelrail.vehicle.simulation.accelerometer import body_motion
    from wheelrail.vehicle.track.section_poses import TrackSections

    coordinates, profile = Coordinates(vehicle), SpeedProfile.of(scene.vehicle.speed_profile)
    applied = AppliedForces(coordinates, applied_loads(scene, vehicle))
    bodies = BodyEquations(SuspensionArrays(coordinates), TrackSections(track), applied)
    levers = {
        label: np.array(point) - (vehicle.bodies[name].x, 0.0, vehicle.bodies[name].height)
        for label, (name, point) in points.items()
    }
    acceleration, roll = np.empty((len(time), len(points), 3)), np.empty((len(time), len(points)))
    names = list(dict.fromkeys(name for name, _ in points.values()))
    for i, (t, state) in enumerate(zip(time.tolist(), states, strict=True)):
        motions = {name: body_motion(bodies, profile(t), state, name) for name in names}
        for k, (label, (name, _)) in enumerate(points.items()):
            acceleration[i, k], roll[i, k] = motions[name].at(levers[label]), motions[name].rate[0]
    return acceleration, roll


def _resolution(time: Array, accelerations: bool) -> list[str]:
    """Remark on frequencies that the samples of a run do not resolve."""
    resolved = 0.5 / float(np.max(np.diff(time)))
    if not accelerations or resolved >= 0.99 * FASTEST:
        return []
    text = f"samples are up to {1e3 * np.max(np.diff(time)):.0f} ms apart: accelerations above {resolved:.0f} Hz are"
    worst = " and the band up to 10 Hz is incomplete" if resolved < BAND else ""
    return [f"{text} interpolated{worst}; output.interval of the scene sets them"]
