"""Random states of vehicles and of the plane wagon: the compiled core against the equations in NumPy.

python tests/helpers/random_states.py [NUMBER OF EACH KIND]
python tests/helpers/random_states.py digest|everything
"""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from linear_creep import LinearCreep
from newton_euler import with_reactions

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.loads import AppliedLoads, BodyForce, LoadTable, WheelsetTorque
from wheelrail.vehicle.multibody.coordinates import X
from wheelrail.vehicle.multibody.elements import SuspensionElement
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.force_law import ForceLaw
from wheelrail.vehicle.wagon.wagon import PRIMARY, SECONDARY, Wagon

DAMPER = ForceLaw(((0.0, 0.0), (0.05, 1500.0), (0.3, 4000.0)))  # odd
STOP = ForceLaw(((-0.02, -500.0), (0.0, 0.0), (0.004, 0.0), (0.01, 3000.0)))
TRACK = Track.of(
    [
        Segment("tangent", 5.0, gradient=0.0),
        Segment("transition", 60.0),
        Segment("arc", 300.0, 1 / 300, 0.1, gradient=0.01, vertical_radius=2000.0),
    ]
)
SPEED = SpeedProfile.through((0.0, 2.0), (10.0, 30.0))
BRAKES = AppliedLoads(
    (
        WheelsetTorque("wheelset_1", LoadTable(((0.5, 0.0), (1.5, -4e4)))),
        WheelsetTorque("wheelset_2", 3e3, "car_body"),
        WheelsetTorque("wheelset_3", LoadTable(((0.0, 1e3), (20.0, 2e4), (60.0, 5e3)), by_distance=True), brake=True),
        WheelsetTorque("wheelset_4", 5e3, brake=True),
    ),
    (
        BodyForce("car_body", (12.5, 0.1, 1.0), -2e4, LoadTable(((0.0, 0.0), (2.0, 1e4))), 500.0),
        BodyForce("wheelset_2", (8.22, 1.0, 0.6), 1e3, 2e3, -3e3),
    ),
)
HELD = {"front_bogie": ("roll", "pitch"), "wheelset_1": ("y", "yaw"), "wheelset_2": ("x", "pitch"), "car_body": ("x",)}


def changed(element: SuspensionElement, kind: str) -> SuspensionElement:
    if kind == "turned in part":
        return replace(element, turn=0.3)
    if kind == "Maxwell elements":
        series = tuple(6e6 if not isinstance(c, ForceLaw) and c > 0.0 else np.inf for c in element.damping)
        return replace(element, series_stiffness=series)
    if kind == "laws":
        stiffness, series = (1e6, STOP, element.stiffness[2]), (np.inf, np.inf, 5e6)
        return replace(element, stiffness=stiffness, damping=(DAMPER, 1e3, DAMPER), series_stiffness=series)
    if kind == "friction" and element.damping[2]:  # about half of the sliders move
        limits: Any = {"friction": (800.0, 5e3, 3e3), "friction_coefficient": (0.3, 0.1, 0.05)}
        return replace(element, **limits, friction_stiffness=(1e6, 5e5, 1e6), series_stiffness=(np.inf, np.inf, 5e6))
    if kind == "rods, bushings, surge":
        surge: Any = {"series_stiffness": (np.inf, 4e6, 9e5), "surge_mass": (0.0, 300.0, 700.0)}
        if element.stiffness[0] == 5e6:  # the traction rod
            x, y, z = element.point
            return replace(element, lower_point=(x - 0.7, y + 0.2, z - 0.1), stiffness=(5e6, 0.0, 0.0))
        if element.damping[2]:
            return replace(element, damping=(0.0, DAMPER, 2e4), **surge, surge_exponent=(1.0, 1.0, 1.8))
    return element


@cache
def vehicle(kind: str) -> Vehicle:
    found = load_vehicle()
    elements = {name: changed(element, kind) for name, element in found.elements.items()}
    if kind == "held coordinates":
        bodies = {name: replace(body, held=HELD.get(name, ())) for name, body in found.bodies.items()}
        return replace(found, bodies=bodies)
    if kind == "rods, bushings, surge":
        springs = {n: replace(s, damping=(3e3, 2e3, 5e3)) for n, s in found.rotational_springs.items()}
        return replace(found, elements=elements, rotational_springs=springs)
    return replace(found, elements=elements, speed_hold=None if kind == "free speed" else found.speed_hold)


def dynamics_of(kind: str) -> VehicleDynamics:
    """Through transitions of curvature, cant and gradient while the speed of the reference changes."""
    if kind in WAGONS:
        return wagon_dynamics(WAGONS[kind], TRACK, LinearCreep(), SPEED)
    loads = BRAKES if kind == "brakes and forces" else AppliedLoads()
    return VehicleDynamics(vehicle(kind), TRACK, LinearCreep(), SPEED, loads=loads)


WAGONS = {
    "plane wagon": replace(Wagon(), secondary=replace(SECONDARY, turn=0.5)),
    "plane wagon, Maxwell elements": replace(
        Wagon(),
        primary=replace(PRIMARY, lateral_series_stiffness=7e6, vertical_series_stiffness=1e6),
        secondary=replace(SECONDARY, lateral_series_stiffness=6e6),
    ),
}
KINDS = (
    "as it is",
    "turned in part",
    "Maxwell elements",
    "laws",
    "friction",
    "rods, bushings, surge",
    "held coordinates",
    "brakes and forces",
    "free speed",
    *WAGONS,
)


class Differences(NamedTuple):
    """Largest differences over the largest values of their state.

    Parameters:
        rates: of accelerations and springs of Maxwell elements.
        reactions: of forces and moments of constraints.
        beyond: of both what the last bit of the farthest position does not explain, whose difference to another one is
            the deflection of the stiffest spring.
    """

    rates: float
    reactions: float
    beyond: float


def samples(kind: str, number: int) -> Iterator[tuple[VehicleDynamics, float, Array, Array]]:
    """A vehicle, a time, random states and contact forces, a quarter of the number at each of four times."""
    dynamics, random = dynamics_of(kind), np.random.default_rng(5)
    coordinates, size, c = dynamics.coordinates, dynamics.size, dynamics.coordinates.count
    scale = np.concatenate([np.full(c, 1e-2), np.full(c, 0.1), np.full(size - 2 * c, 1e-3)])
    along = np.flatnonzero(coordinates.free % 6 == X)
    spin = c + coordinates.rolling_angles
    for time in (0.3, 0.9, 1.4, 1.9):
        states = scale * random.normal(size=(-(-number // 4), size))
        if kind == "free speed":
            states[:, along] += 130.0
        if kind == "brakes and forces":  # wheels that are nearly held by their brakes, too
            rolling = dynamics.speed_profile(time).speed / dynamics.vehicle.radius
            states[1::2, spin] = 0.1 * random.normal(size=states[1::2, spin].shape) - rolling
        yield dynamics, time, states, 1e4 * random.normal(size=(len(states), len(coordinates.wheelset_bodies), 6))


def differences(kind: str, number: int) -> Differences:
    """Differences of a number of states of one of `KINDS`."""
    worst = np.zeros(3)
    for dynamics, time, states, wrenches in samples(kind, number):
        rates, reactions = with_reactions(dynamics, time, states, wrenches)
        held, c, travel = dynamics.coordinates.held == 1, dynamics.coordinates.count, dynamics.speed_profile(time)
        matrix = np.abs(dynamics.bodies.derivatives(travel, 0.0, states[0], wrenches[0]).by_state[:c, :c])
        bit = np.spacing(np.abs(dynamics.bodies.motions(travel, states[0])[0][:, 0, X]).max())
        stiffness = (matrix * dynamics.coordinates.inertia[:, None]).max()
        for state, wrench, *expected in zip(states, wrenches, rates, reactions, strict=True):
            found = dynamics.accelerations(time, state, wrench)
            largest, force = (max(np.abs(part).max(), 1.0) for part in expected)
            rates_error = np.abs(found.rates - expected[0]).max()
            error = np.abs(found.reactions - expected[1])[held].max(initial=0.0)
            beyond = max((rates_error - matrix.max() * bit) / largest, (error - stiffness * bit) / force)
            worst = np.maximum(worst, [rates_error / largest, error / force, beyond])
    return Differences(*worst.tolist())


def digest(number: int) -> str:
    """Of all bits of accelerations and their derivatives in states of all kinds."""
    found = hashlib.sha256()
    for kind in KINDS:
        for dynamics, time, states, wrenches in samples(kind, number):
            travel, (_, _, jerk) = dynamics.speed_profile(time), dynamics.speed_profile.speeds(time)
            for state, wrench in zip(states, wrenches, strict=True):
                parts = dynamics.accelerations(time, state, wrench)
                for part in (*parts, *dynamics.bodies.derivatives(travel, jerk, state, wrench)):
                    found.update(np.ascontiguousarray(part).tobytes())
    return found.hexdigest()


def evaluate_everything(factor: float) -> int:
    """Number of evaluations by all functions of the core at random states times a factor, which may be wild."""
    count = 0
    for kind in KINDS:
        for dynamics, time, states, wrenches in samples(kind, 8):
            travel, bodies, state, wrench = (
                dynamics.speed_profile(time),
                dynamics.bodies,
                factor * states[0],
                wrenches[0],
            )
            bodies.accelerations(travel, state, wrench, bodies.sections(travel, state))
            bodies.derivatives(travel, 0.0, state, wrench)
            bodies.element_states([travel], state[None])
            bodies.motions(travel, state)
            bodies.load_values(travel, state)
            bodies.energy_rates(travel, state, wrench)
            bodies.track.at(state[:3], travel.distance)
            count += 1
    return count


if __name__ == "__main__":
    if sys.argv[1:2] == ["digest"]:
        print(digest(40))
    elif sys.argv[1:2] == ["everything"]:
        print(sum(evaluate_everything(factor) for factor in (1.0, 1e3, 1e300, np.inf, np.nan)))
    else:
        print("| vehicle | accelerations | reactions | beyond rounding |\n|---|---|---|---|")
        for kind in KINDS:
            print(f"| {kind} |" + "".join(f" {x:.1e} |" for x in differences(kind, int(*sys.argv[1:] or [2000]))))
