"""The vehicle in three dimensions beside the same one in Exudyn: largest differences.

    pip install exudyn; python -m benchmarks.exudyn_vehicle [--end S] [--step S] [--curve | --tracks]

Manchester vehicle 1 with S1002 wheels on 60E1 rails at 1/40, standard contact by its element, starts from its
equilibrium with a lateral velocity of the front bogie, on straight track or at once in a canted curve of 600 m, without
a force that keeps the speed. --tracks: a smooth law of contact, on a co-running track with mass below each wheelset.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from math import asin
from pathlib import Path
from time import process_time

import numpy as np

import wheelrail as wr
from benchmarks.common.machine import machine_description
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.scenes.builders.wheelset import wheelset_contact
from wheelrail.scenes.schema.scene import RunScene, load_scene
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.multibody.coordinates import PITCH, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

SCENE = Path(__file__).parents[1] / "scenes" / "vehicle.toml"
PAIR = {"wheel": "S1002", "rail": "60E1", "laying_angle": 0.025, "friction": 0.3, "model": "standard"}
SPEED, RADIUS, CANT, CANT_BASE = 25.0, 600.0, 0.1, 1.5  # m/s, m, m, m
KICK = 0.05  # m/s, lateral velocity of the front bogie


def dynamics(*, curve: bool) -> VehicleDynamics:
    """Equations of motion of this package."""
    scene = load_scene(SCENE)
    if not isinstance(scene, RunScene):
        raise TypeError(f"{SCENE}: must be a run")
    track = ConstantCurve(SPEED, 1.0 / RADIUS, CANT).track if curve else Track()
    vehicle = replace(load_vehicle(), speed_hold=None)
    return VehicleDynamics(vehicle, track, wheelset_contact(scene), SPEED)


def initial_state() -> Array:
    """Equilibrium on straight track with the lateral velocity."""
    held = VehicleDynamics(load_vehicle(), Track(), dynamics(curve=False).contact, SPEED)
    state = np.array(equilibrium(held).state)
    state[held.coordinates.count + held.coordinates.index("front_bogie", Y)] += KICK
    return state


def ours(state: Array, end: float, *, curve: bool) -> Array:
    """Coordinates (n, 6) of the bodies at the end by this package, pitch as zero."""
    settings = StepSettings("ode45", rtol=1e-7, atol=1e-10)
    *_, last = integrate(dynamics(curve=curve), 0.0, state, end, settings)
    position = last.x[: len(state) // 2].reshape(-1, 6).copy()
    position[:, PITCH] = 0.0
    return np.asarray(position)


def theirs(state: Array, end: float, step: float, *, curve: bool) -> Array:
    """Coordinates (n, 6) of the bodies at the end by Exudyn at a fixed step s."""
    from benchmarks.exudyn.vehicle_model import CircularTrack, ElementForces, TimeSteps, trajectory

    vehicle = replace(load_vehicle(), speed_hold=None)
    wheelset = wr.Wheelset(**PAIR, speed=SPEED)
    elements = [wheelset.element() for _ in vehicle.wheelsets]
    track = CircularTrack(1.0 / RADIUS, asin(CANT / CANT_BASE)) if curve else CircularTrack()
    rows = trajectory(ElementForces(vehicle, track, elements), state, SPEED, TimeSteps(end, step, end))
    return np.asarray(rows[-1])


def difference(first: Array, second: Array) -> tuple[float, float]:
    """Largest difference of lengths, m, and of angles, rad."""
    change = np.abs(first - second)
    return float(change[..., :3].max()), float(change[..., 3:].max())


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--end", type=float, default=0.5, help="duration [s]")
    parser.add_argument("--step", type=float, default=1e-4, help="Exudyn's step [s]; twice the step is compared")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--curve", action="store_true", help="a curve of 600 m instead of straight track")
    where.add_argument("--tracks", action="store_true", help="straight track with mass, smooth contact")
    given = parser.parse_args()
    by_exudyn: Callable[[float, float], Array]
    if given.tracks:
        from benchmarks.exudyn.on_tracks import OnTracks
        from benchmarks.exudyn.tracks_model import theirs as on_tracks

        by_us, by_exudyn = (case := OnTracks()).ours, partial(on_tracks, case)
    else:
        state = initial_state()
        by_us = partial(ours, state, curve=given.curve)
        by_exudyn = partial(theirs, state, curve=given.curve)
    start = process_time()
    fine = by_exudyn(given.end, given.step)
    middle = process_time()
    own = by_us(given.end)
    seconds = middle - start, process_time() - middle
    coarse = by_exudyn(given.end, 2 * given.step)
    print(machine_description())
    print(
        f"Exudyn {version('exudyn')}, RK44 at {given.step:g} s, {given.end:g} s: {seconds[0]:.0f} s of processor time,"
    )
    print(f"this package {seconds[1]:.0f} s. Motion of the leading wheelset: y = {1e3 * own[3, Y]:.4f} mm.")
    print("| compared | lengths, m | angles, rad |\n|---|---|---|")
    for name, values in {"this package": own, f"Exudyn at {2 * given.step:g} s": coarse}.items():
        lengths, angles = difference(values, fine)
        print(f"| {name} and Exudyn at {given.step:g} s | {lengths:.1e} | {angles:.1e} |")


if __name__ == "__main__":
    main()
