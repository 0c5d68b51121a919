"""Manchester 1 on elastic axles and co-running tracks: equilibria, modes, critical speeds and joints.

python -m benchmarks.vehicle_complete [--check plane|table|jacobian|gauge|wheels|check_rails|joint|energy|tables ...]
    [--quick] [--json]

A plane run against the same wagon as a vehicle file; rigid and elastic vehicles against values measured before;
derivatives against differences and the energy balance; the gauge on rigid sleepers; independent wheels; a tram on
check rails; P2 of a dipped joint against a linear model; energy balances of vehicles; runs on tables of forces beside
elastic contact.
--quick: a rigid vehicle and an elastic one, one place of the strips and one speed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import chain, product, starmap
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.common.machine import machine_description
from benchmarks.paper.tables import markdown
from benchmarks.table_runs import border, irregular
from benchmarks.track_models import RAIL
from wheelrail.contact.kinematics.frames import MIRROR
from wheelrail.contact.loading.co_running_structure import CoRunningStructure
from wheelrail.contact.models.strip_places import at_places
from wheelrail.contact.structure.ballast import Ballast, CoRunningTrack, Layers, co_running, of_both_sides
from wheelrail.contact.structure.pads import RailCompliance, RailPads, wavenumber_samples
from wheelrail.scenes.builders.vehicle import run_track, vehicle_on
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, parse_vehicle
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.schema.scene import RunScene, checked, load_scene
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import Y, Z
from wheelrail.vehicle.multibody.elements import SuspensionElement
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.multibody.wheel_forces import check_rail_force, wheelset_forces
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.critical_speed import critical_speed
from wheelrail.vehicle.steady.equilibrium import Equilibrium, equilibrium
from wheelrail.vehicle.steady.modes import modes
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.force_law import ForceLaw, Law

SCENES = MANCHESTER.parent
TRAM = """
wheel_y = 0.75
[speed_hold]
body = "bogie"
[bodies.bogie]
mass = 12000.0
inertia = [6000.0, 4000.0, 8000.0]
x = 0.0
height = 0.9
[body_types.axle]
mass = 1200.0
inertia = [700.0, 80.0, 700.0]
height = 0.46
wheelset = true
independent = true
[bodies]
front = { type = "axle", x = 0.9 }
rear = { type = "axle", x = -0.9 }
[element_types.primary]
upper = "bogie"
stiffness = [10e6, 4e6, 1.2e6]
damping = [5e3, 5e3, 10e3]
turn = 1.0
[elements]
front = { type = "primary", lower = "front", points = [[0.9, 1.0, 0.46], [0.9, -1.0, 0.46]] }
rear = { type = "primary", lower = "rear", points = [[-0.9, 1.0, 0.46], [-0.9, -1.0, 0.46]] }
"""
ELASTIC = {"model": "condensed", "laws": "exact", "surface_size": 1e-3, "strips": 6, "cells": 10}
AXLE, PADS, HALVES = {"diameter": 0.160}, {"vertical": 100e6, "lateral": 40e6}, {"length": "halves"}
BODIES: dict[str, tuple[dict[str, object], dict[str, object]]] = {
    "rigid": ({}, {}),
    "axle": ({"axle": AXLE}, {}),
    "pads": ({}, {"pads": PADS}),
    "mass": ({}, {"pads": PADS, "ballast": HALVES}),
    "axle and mass": ({"axle": AXLE}, {"pads": PADS, "ballast": HALVES}),
}
CURVE = ConstantCurve(25.0, 1 / 600, 0.1, 1.5)
SPEEDS, PLACES = (60.0, 110.0), 4
LOAD = 436368.4  # N, of all wheels
# On halves of sleepers, by bodies: z mm, Y inwards of a centred wheel N, y of axles 1, 2 mm and Y of the outer wheels
# of axles 1, 4 kN in the curve, critical speed and its standard error m/s, and of the standard contact before strips
# slid with their own loads, which alone moved that of the rigid vehicle from 63.7 to 70.7 m/s.
EXPECTED = {
    "rigid": (-0.2474, 341.0, (-6.24, -1.62), (13.10, 5.18), (82.5, 1.0), 63.73),
    "axle": (-0.2623, 159.0, (-7.18, -2.44), (12.95, 5.28), (83.2, 0.4), 96.33),
    "pads": (-0.5248, 333.0, (-6.48, -1.80), (12.91, 5.23), (82.7, 0.7), None),
    "mass": (-0.7475, 334.0, (-6.61, -1.90), (12.83, 5.25), (83.1, 0.7), 64.28),
    "axle and mass": (-0.7622, 158.0, (-7.53, -2.72), (12.69, 5.33), (83.4, 0.4), 96.31),
}
# Hz, of the lowest oscillation of wheelsets on the rails in a coordinate
BOUNCE = {"pads": ("roll", 58.0), "mass": ("z", 50.0), "axle and mass": ("z", 49.0)}
BENDING_ACROSS = 2.1e11 * 512.3e-8  # N m2, 60E1
HERTZ = 1.08e9  # N/m, of one contact in the linear model
DIP = 2e-3  # rad, half the angle of the joint
MEAN = 1.5e-3  # s, over which forces of joints are averaged


@dataclass(frozen=True)
class Check:
    """A value beside the expected one.

    Parameters:
        name: of the quantity, with its unit.
        value: computed.
        expected: reference.
        tolerance: largest difference.
    """

    name: str
    value: float
    expected: float
    tolerance: float

    @property
    def holds(self) -> bool:
        return bool(abs(self.value - self.expected) <= self.tolerance)

    @property
    def cells(self) -> tuple[str, ...]:
        values = (f"{x:.6g}" for x in (self.value, self.expected, self.tolerance))
        return (self.name, *values, "yes" if self.holds else "**no**")


def scene(file: str, bodies: str, **changes: object) -> RunScene:
    """Scene of a run with elastic bodies of a name; changes: of its contact."""
    path = SCENES / file
    data = {**parse(read_text(path), path), **changes}
    for key, own in zip(("wheelset", "track"), BODIES[bodies], strict=True):
        data[key] = {**data[key], **own}
    found = checked(data, path)
    assert isinstance(found, RunScene)
    return found


@cache
def vehicle(bodies: str, standard: bool = False) -> VehicleDynamics:
    """Manchester 1 on straight track at 25 m/s."""
    own = scene("vehicle.toml", bodies, **({} if standard else ELASTIC))
    body = vehicle_on(own, MANCHESTER)
    contact, structures = run_contact(own, body.wheelsets)
    return VehicleDynamics(body, Track(), contact, 25.0, structures)


def z_and_forces(at: Equilibrium) -> tuple[Array, Array]:
    """Heights (w,) m of the wheelsets and forces (w, 2, 3) N on the wheels."""
    d = at.dynamics
    z = [at.state[d.coordinates.index(name, Z)] for name in d.vehicle.wheelsets]
    return np.array(z), np.array([[result.force for result in sides.values()] for sides in at.contacts.values()])


def steady(bodies: str, places: int = PLACES) -> Iterator[Check]:
    """Equilibria, bounce and critical speeds of Manchester 1 with elastic bodies of a name."""
    depth, centred, curve_y, curve_forces, (speed, deviation), on_points = EXPECTED[bodies]
    at = equilibrium(vehicle(bodies))
    z, force = z_and_forces(at)
    yield Check(f"{bodies}: sum of Q, N", force[..., 2].sum(), LOAD, 1.0)
    yield Check(f"{bodies}: z, mm", 1e3 * z[0], depth, 1e-3)
    yield Check(f"{bodies}: Y of a centred wheel, N", abs(force[0, 0, 1]), centred, 80.0)
    if bodies in BOUNCE:
        name, frequency = BOUNCE[bodies]
        found = [m.frequency for m in modes(at.dynamics, at) if m.oscillates and f"_{name}" in m.main_coordinates]
        yield Check(f"{bodies}: wheelsets on the rails, {name}, Hz", min(f for f in found if f > 30.0), frequency, 0.5)
    curving = equilibrium(replace(vehicle(bodies), track=CURVE.track))
    wheels = list(wheelset_forces(curving.dynamics, curving.state, curving.contacts).values())
    for i, y in zip((0, 1), curve_y, strict=True):
        yield Check(f"{bodies}: R = 600 m, y of axle {i + 1}, mm", 1e3 * wheels[i].y, y, 0.02)
    for i, guiding in zip((0, 3), curve_forces, strict=True):
        yield Check(f"{bodies}: R = 600 m, Y of axle {i + 1}, kN", 1e-3 * wheels[i].right.guiding, guiding, 0.08)
    contacts = at_places(vehicle(bodies).contact, places)
    assert len(contacts) == places
    values = [critical(replace(vehicle(bodies), contact=contact), SPEEDS, 15.0) for contact in contacts]
    spread = np.std(values, ddof=1) / np.sqrt(places) if places > 1 else deviation * np.sqrt(PLACES)
    yield Check(
        f"{bodies}: critical speed, m/s", float(np.mean(values)), speed, 2.0 * float(np.hypot(spread, deviation))
    )
    if on_points is not None:
        value = critical(vehicle(bodies, standard=True), (40.0, 110.0), 10.0)
        yield Check(f"{bodies}, standard contact: critical speed, m/s", value, on_points, 0.1)


def critical(dynamics: VehicleDynamics, speeds: tuple[float, float], interval: float) -> float:
    """Linear critical speed, m/s; NaN if there is none."""
    found = critical_speed(dynamics, speeds, interval=interval, tolerance=0.1)
    return float("nan") if found is None else found.speed


def file_of(own: Vehicle) -> str:
    """Text of a vehicle file."""

    def law(value: Law) -> object:
        return [list(point) for point in value.points] if isinstance(value, ForceLaw) else value

    def element(one: SuspensionElement) -> tuple[dict[str, object], str]:
        laws = {key: [law(value) for value in getattr(one, key)] for key in ("stiffness", "damping")}
        series = ", ".join("inf" if x == np.inf else repr(x) for x in one.series_stiffness)
        return {"upper": one.upper, "lower": one.lower, "points": [list(one.point)], **laws, "turn": one.turn}, series

    lines = [f"gravity = {own.gravity!r}", f"wheel_y = {own.wheel_y!r}"]
    for name, body in own.bodies.items():
        lines += [f"[bodies.{name}]", f"mass = {body.mass!r}", f"inertia = {list(body.inertia)!r}", f"x = {body.x!r}"]
        lines += [
            f"height = {body.height!r}",
            f"wheelset = {json.dumps(body.wheelset)}",
            f"held = {json.dumps(body.held)}",
        ]
    for name, one in own.elements.items():
        keys, series = element(one)
        lines += [f"[elements.{name}]", *(f"{key} = {json.dumps(value)}" for key, value in keys.items())]
        lines.append(f"series_stiffness = [{series}]")
    for name, spring in own.rotational_springs.items():
        lines += [
            f"[rotational_springs.{name}]",
            *(f"{k} = {json.dumps(getattr(spring, k))}" for k in ("upper", "lower", "stiffness")),
        ]
    return "\n".join(lines) + "\n"


@cache
def plane(bodies: str = "axle and mass") -> VehicleDynamics:
    """The plane wagon on `curve.toml`."""
    own = scene("curve.toml", bodies)
    body = vehicle_on(own)
    contact, structures = run_contact(own, body.wheelsets)
    return VehicleDynamics(body, run_track(own, body), contact, own.vehicle.speed_profile, structures)


def plane_wagon(seconds: float = 2.0) -> Iterator[Check]:
    """The plane run and that of its vehicle file, and the energy balance of the run."""
    steps = [StepSettings("rosenbrock", rtol, 1e-3 * rtol) for rtol in (1e-3, 1e-4)]
    run = simulate(plane(), (0.0, seconds), steps=steps[0])
    with TemporaryDirectory() as folder:
        file = Path(folder, "wagon.toml")
        file.write_text(file_of(plane().vehicle), encoding="utf-8")
        same = replace(plane(), vehicle=vehicle_on(scene("curve.toml", "axle and mass"), file))
    other = simulate(same, (0.0, seconds), steps=steps[0])
    alike = run.state.shape == other.state.shape
    yield Check(
        "plane wagon as a vehicle file: states",
        float(np.abs(run.state - other.state).max()) if alike else np.inf,
        0.0,
        1e-9,
    )
    yield Check("energy balance, relative tolerance 1e-3", energy_balance(run).error, 0.0, 5e-3)
    yield Check(
        "energy balance, relative tolerance 1e-4",
        energy_balance(simulate(plane(), (0.0, seconds), steps=steps[1])).error,
        0.0,
        1e-4,
    )


def jacobian() -> Iterator[Check]:
    """Derivatives of the rates of 212 states by some states against central differences."""
    d = vehicle("axle and mass")
    at = equilibrium(d)
    state, random, c = at.state.copy(), np.random.default_rng(4), d.coordinates.count
    state[:c] += 1e-5 * random.normal(size=c)
    state[c : 2 * c] += 1e-2 * random.normal(size=c)
    here = d(0.0, state)
    linear = VehicleJacobian(d, StepStatistics())(0.0, state, here).by_state
    first = d.coordinates.size
    columns = [d.coordinates.index(f"wheelset_{i + 1}", k) for i, k in ((0, Y), (1, Z), (2, Y))]
    worst, step = 0.0, 1e-8  # m: strips come and go within 0.1 um of height
    for column in (*columns, first + 2, *(first + 32 + np.arange(12, 15)), first + 64 + 19, first + 96 + 25):
        h = np.zeros(d.size)
        h[column] = step
        change = (d(0.0, state + h, here).rate - d(0.0, state - h, here).rate) / (2 * step)
        for rows in (slice(c, 2 * c), slice(first, None)):
            error = np.abs(linear[rows, column] - change[rows]).max()
            worst = max(worst, float(error / (np.abs(change[rows]).max() or 1.0)))
    yield Check("number of states", d.size, 212, 0.0)
    yield Check("derivatives against differences, relative", worst, 0.0, 1e-5)


def gauge() -> Iterator[Check]:
    """Gauge under axle 1 in the curve on halves of sleepers and on rigid ones: of beams, and of finite elements."""
    loads = np.array([9750.0, 0.0, 0.0, 12910.0, 0.0, 0.0])  # N outwards
    for name, ballast, expected in (("halves", HALVES, 0.57), ("rigid sleepers", {}, 0.34)):
        beams = of_both_sides(*beam_tracks(rigid=not ballast))
        moved = np.linalg.solve(beams, np.insert(loads, (3, 3, 6, 6), 0.0))
        yield Check(f"gauge, {name}, rails as beams, mm", 1e3 * (moved[0] + moved[5]), expected, 0.01)
        moved = track_of({"pads": PADS, "ballast": ballast}).pairs.flexibility.matrix[12:, 12:] @ loads
        yield Check(f"gauge, {name}, rails by finite elements, mm", 1e3 * (moved[0] + moved[3]), expected, 0.01)
    uniform = {"length": float(np.sqrt(12.0)) * rail_y()}
    loads = np.array([0.0, 0.0, 0.0, 2e4, -1e5, 200.0])  # on even and odd parts
    one, two = (track_of({"pads": PADS, "ballast": own}).compliance[12:22, 12:] @ loads for own in (uniform, HALVES))
    yield Check("same side: rigid sleepers against halves", np.abs(one - two).max() / np.abs(two).max(), 0.0, 1e-12)


def wheels() -> Iterator[Check]:
    """Wheels of Manchester 1 that turn by themselves, on the standard contact: free, and on an axle that is stiff."""
    rigid = replace(vehicle("rigid", standard=True), track=CURVE.track)

    def turning(*torsion: float) -> VehicleDynamics:
        own = {"independent": True, "torsion": torsion}
        bodies = {name: replace(b, **own) if b.wheelset else b for name, b in rigid.vehicle.bodies.items()}  # type: ignore
        return replace(rigid, vehicle=replace(rigid.vehicle, bodies=bodies))

    free, own, names = equilibrium(turning(0.0, 0.0)), equilibrium(rigid), rigid.vehicle.wheelsets
    for name, state in free.dynamics.wheelset_states(0.0, free.state).items():
        moments = [float(result.moment @ state.rotation[:, 1]) for result in free.contacts[name].values()]
        yield Check(f"free wheels of {name}: largest moment, N m", max(map(abs, moments)), 0.0, 0.1)
    expected = [own.state[own.dynamics.coordinates.index(name, Y)] for name in names]
    for torsion, label in (((1e10, 0.0), "spring"), ((0.0, 1e11), "damper")):
        at = equilibrium(turning(*torsion))
        found = [at.state[at.dynamics.coordinates.index(name, Y)] for name in names]
        error = float(np.abs(np.divide(found, expected) - 1.0).max())
        yield Check(f"wheels on a stiff {label}: y over that of rigid axles - 1", error, 0.0, 1e-6)
    tight = ConstantCurve(3.0, 1 / 25).track
    bogie = VehicleDynamics(parse_vehicle(TRAM, "tram bogie"), tight, rigid.contact, 3.0)
    at = equilibrium(bogie)
    lateral = sum(float(result.force[1]) for sides in at.contacts.values() for result in sides.values())
    mass = sum(body.mass for body in bogie.vehicle.bodies.values())
    yield Check("tram bogie of 1.8 m, R = 25 m: sum of Y, N", lateral, mass * 9.0 / 25.0, 0.01 * mass * 9.0 / 25.0)


def check_rails() -> Iterator[Check]:
    """The example of a tram: balance in the curve, a run into it, slip of a wheel that rolls about its lowest point."""
    file = SCENES / "tram_bogie.toml"
    own = load_scene(SCENES / "vehicle_tram.toml")
    assert isinstance(own, RunScene)
    assert own.track.check_rail is not None
    d = VehicleDynamics(vehicle_on(own, file), own.track.track(), run_contact(own, ())[0], 3.0)
    at = equilibrium(replace(d, track=ConstantCurve(3.0, 1 / 25).track))
    lateral = sum(float(result.force[1]) for sides in at.contacts.values() for result in sides.values())
    mass = sum(body.mass for body in d.vehicle.bodies.values())
    yield Check("the same on check rails, wheels of 0.33 m", lateral, mass * 9.0 / 25.0, 0.01 * mass * 9.0 / 25.0)
    run = simulate(d, (0.0, 6.0), steps=StepSettings("rosenbrock", 3e-3, 3e-5)).rows[-1]
    for k, (name, side) in enumerate((("front", "left"), ("rear", "right"))):
        result = at.contacts[name][side]  # type: ignore[index]
        held, end = check_rail_force(result.patches, side), check_rail_force(run.patches[k][k], side)  # type: ignore
        yield Check(f"check rail of the {side} {name} wheel: run over equilibrium", end / held, 1.0, 2e-3)
        patch = max(result.patches, key=lambda patch: abs(patch.contact_angle))
        state = at.dynamics.wheelset_states(0.0, at.state)[name].turning_as(side)  # type: ignore[arg-type]
        normal = np.array([0.0, -np.sin(patch.contact_angle), np.cos(patch.contact_angle)])
        face = own.track.check_rail.height - own.track.check_rail.rounding
        hand = 1.0 if side == "left" else -1.0
        place = np.array([patch.x, hand * (0.7175 - own.track.check_rail.flangeway), face + 0.01 * normal[2]])
        arm = place - [0.0, state.y, 0.33 + state.z]
        slip = state.pitch_rate * np.cross(state.rotation[:, 1], arm)
        slip += 3.0 * np.array([1.0 - place[1] / 25.0, place[0] / 25.0, 0.0])  # of the rail, in the frame that turns
        power = 0.15 * patch.normal_force * float(np.linalg.norm(slip - (slip @ normal) * normal))
        yield Check(
            f"its frictional power over that of rigid slip, {side} {name}", patch.frictional_power / power, 1.0, 1e-2
        )


def beam_tracks(rigid: bool) -> tuple[list[Array], list[Array] | None]:
    """Stiffness (5, 5) of tracks of Euler beams under loads to the same side, and mirrored loads."""
    ballasts = Ballast().rigid(2.6, 0.75) if rigid else (Ballast(),)
    same, *mirrored = ([beam_track(ballast).stiffness] * 2 for ballast in ballasts)
    return same, mirrored[0] if mirrored else None


def beam_track(ballast: Ballast) -> CoRunningTrack:
    """Track of a beam that bends across as a rail 60E1 does."""
    k, pads = wavenumber_samples(), np.array(RailPads().per_length[1:])
    layers = ballast.per_length(RailPads())
    flexibility = 1.0 / (BENDING_ACROSS * k[:, None] ** 4 + pads * layers / (pads + layers))
    compliance = flexibility[:, [0, 1, 1], None] * np.eye(3)
    parts = RAIL * compliance**2, pads[[0, 1, 1], None] * compliance**2, compliance[:, :2]
    own = Layers(k, pads, layers, ballast.masses / RailPads().spacing, compliance, *parts)
    return co_running(own, RailCompliance(own.along(compliance), np.zeros(2), 0.0), ballast.times(RailPads()))


def rail_y() -> float:
    """Half the distance of the rails, m."""
    return track_of({"pads": PADS, "ballast": HALVES}).pairs.mountings[0].rail_y


def track_of(keys: dict[str, object]) -> CoRunningStructure:
    """Track under a wheelset of Manchester 1 with keys of its rails."""
    path = SCENES / "vehicle.toml"
    data = {**parse(read_text(path), path), **ELASTIC}
    data["track"] = {**data["track"], **keys}
    own = checked(data, path)
    assert isinstance(own, RunScene)
    _, structures = run_contact(own, ["wheelset"])
    (structure,) = structures or ()
    assert isinstance(structure, CoRunningStructure)
    return structure


def largest_mean(time: Array, force: Array) -> float:
    """Largest mean N over 1.5 ms of a dynamic force after time zero."""
    grid = np.arange(-0.02, 0.03, 1e-5)
    count = round(MEAN / 1e-5)
    smooth = np.convolve(np.interp(grid, time, force), np.ones(count) / count, "same")
    return float(smooth[grid > 0.0].max())


def linear_joint(track: CoRunningTrack, unsprung: float, speed: float, length: float = 1.0) -> float:
    """The same of a linear model: a wheel of a mass kg on a spring on the track."""
    e, dt = np.eye(5)[1], 2e-6
    time = np.arange(-0.06, 0.04, dt)
    x = speed * time
    level = np.where(np.abs(x) < length, -0.5 * DIP * length * (1 - np.abs(x) / length) ** 2, 0.0)
    mass, stiffness, damping = np.zeros((3, 6, 6))
    mass[0, 0], mass[1:, 1:], damping[1:, 1:] = unsprung, track.mass, track.damping
    across = np.concatenate([[1.0], -e])
    stiffness[1:, 1:] = track.stiffness
    stiffness += HERTZ * np.outer(across, across)
    rates = np.block(
        [[np.zeros((6, 6)), np.eye(6)], [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)]]
    )
    pushed = np.concatenate([np.zeros(6), np.linalg.solve(mass, HERTZ * across)])
    ahead = np.linalg.inv(np.eye(12) - 0.5 * dt * rates)
    step, push = ahead @ (np.eye(12) + 0.5 * dt * rates), 0.5 * dt * ahead @ pushed
    state, force = np.zeros(12), np.zeros(len(time))
    for i in range(1, len(time)):
        state = step @ state + push * (level[i - 1] + level[i])
        force[i] = HERTZ * (level[i] - across @ state[:6])
    return largest_mean(time, force)


def joint(speeds: tuple[float, ...] = (20.0, 30.0), parts: bool = True) -> Iterator[Check]:
    """Dynamic force at a dipped joint over the linear model: plane wagon, and first bogie of Manchester 1."""
    d = plane("mass")
    for speed in speeds:
        own = replace(d, track=Track(irregularities=Irregularities.joints([8.0], 2.0 * DIP, 1.0)), speed=speed)
        ((_, ratio),) = joint_ratios(own, 10.0, StepSettings("rosenbrock", 1e-3, 1e-6))
        yield Check(f"joint at {speed:g} m/s: P2 - P0 over the linear model", ratio, 0.96, 0.05)
    if parts:
        path = SCENES / "vehicle_joint.toml"
        example = checked({**parse(read_text(path), path), **ELASTIC}, path)
        assert isinstance(example, RunScene)
        body = vehicle_on(example, MANCHESTER)
        contact, structures = run_contact(example, body.wheelsets)
        speed = example.vehicle.first_speed
        own = VehicleDynamics(body, run_track(example, body), contact, speed, structures)
        solver = example.solver
        ratios = joint_ratios(own, 6.0, StepSettings(solver.method, solver.rtol, solver.atol))
        for name, ratio in ratios:
            text = f"joint at {speed:g} m/s, Manchester 1, {name}: P2 - P0 over the linear model"
            yield Check(text, ratio, 0.96, 0.05)


def joint_ratios(d: VehicleDynamics, end: float, steps: StepSettings) -> list[tuple[str, float]]:
    """Dynamic force of the wheels of each wheelset that passes the joint up to a distance m, over the linear model."""
    irregularities, speed = d.track.irregularities, d.speed_profile(0.0).speed
    assert irregularities is not None
    place = float(np.mean(irregularities.stations))
    run = simulate(d, (0.0, end / speed), steps=steps)
    assert run.status == "completed"
    ratios = []
    for k, name in enumerate(d.vehicle.wheelsets):
        structure = d.structures.own[k]
        assert isinstance(structure, CoRunningStructure)
        (track, _), body = structure.mirrored_tracks or structure.tracks, d.vehicle.bodies[name]
        arrival, force = (place - body.x) / speed, run.force[:, k, :, 2].mean(axis=1)
        before = np.interp(arrival - 2.0 / speed, run.time, force)
        if arrival + 0.02 < run.time[-1]:
            linear = linear_joint(track, 0.5 * body.mass, speed)
            ratios.append((name, largest_mean(run.time - arrival, force - before) / linear))
    return ratios


def energy(parts: tuple[float, ...] = (1.0, 0.1)) -> Iterator[Check]:
    """Energy balance of vehicles in three dimensions at parts of the tolerances of their scenes."""
    runs = {"curve": ("vehicle", MANCHESTER), "class low": ("vehicle_irregular", MANCHESTER)}
    runs["freight wagon in the curve"] = "vehicle", SCENES / "freight_wagon.toml"
    for (name, (file, body)), part in product(runs.items(), parts):
        own = scene(f"{file}.toml", "rigid")
        wagon = vehicle_on(own, body)
        contact, _ = run_contact(own, wagon.wheelsets)
        d = VehicleDynamics(wagon, run_track(own, wagon), contact, own.vehicle.speed_profile)
        end = own.track.length / own.vehicle.first_speed
        steps = StepSettings(own.solver.method, part * own.solver.rtol, part * own.solver.atol)
        run = simulate(d, (0.0, min(end, 6.0)), steps=steps)
        yield Check(f"energy balance, {name}, {part:g} of the tolerances", energy_balance(run).error, 0.0, 1e-2 * part)


def mirror(end: float = 0.3, standard: tuple[bool, ...] = (True, False)) -> Iterator[Check]:
    """Runs into a curve with elastic axles and co-running tracks, and their mirror images, to a time s."""
    for own in standard:
        force = []
        for hand in (1.0, -1.0):
            track = Track.curve(curvature=hand / 600, cant=0.06, transition=5.0, length=200.0)
            d = replace(vehicle("axle and mass", own), track=track)
            force.append(simulate(d, (0.0, end), steps=StepSettings("rosenbrock", 3e-3, 3e-6)).force)
        name = "standard" if own else "strips"
        yield Check(
            f"mirror images, {name}: forces, N", np.abs(force[1] - MIRROR * force[0][:, :, ::-1]).max(), 0.0, 0.0
        )


CHECKS: dict[str, Callable[[], Iterator[Check]]] = {
    "plane": plane_wagon,
    "table": lambda: (check for bodies in BODIES for check in steady(bodies)),
    "jacobian": jacobian,
    "gauge": gauge,
    "wheels": wheels,
    "check_rails": check_rails,
    "joint": joint,
    "energy": energy,
    "mirror": mirror,
    "tables": lambda: starmap(Check, chain(irregular(), border())),
}
QUICK: dict[str, Callable[[], Iterator[Check]]] = {
    "plane": partial(plane_wagon, 1.5),
    "table": lambda: (check for bodies in ("rigid", "mass") for check in steady(bodies, 1)),
    "joint": partial(joint, (20.0,), False),
    "energy": partial(energy, (1.0,)),
    "mirror": partial(mirror, 0.05, (True,)),
    "tables": lambda: starmap(Check, irregular(0.2)),
}


def main() -> None:
    """Print the checks."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", nargs="+", choices=list(CHECKS), default=list(CHECKS))
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    made = CHECKS | (QUICK if options.quick else {})
    found = [check for name in options.check for check in made[name]()]
    if options.json:
        print(json.dumps([vars(check) | {"holds": check.holds} for check in found]))
        return
    print(machine_description())
    print(markdown("quantity|computed|expected|tolerance|holds", [list(check.cells) for check in found]))


if __name__ == "__main__":
    main()
