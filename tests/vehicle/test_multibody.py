"""The vehicle in three dimensions: loads, modes, energy, and runs against Exudyn and closed forms."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from linear_creep import LinearCreep
from numpy_vehicle import mechanical_energy, power
from scipy.linalg import eigvals
from scipy.optimize import brentq
from track_frame import heading

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.multibody.coordinates import PITCH, Coordinates
from wheelrail.vehicle.multibody.elements import InvalidVehicle, SuspensionElement
from wheelrail.vehicle.multibody.equations import VehicleDynamics, wheelset_wrenches
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.multibody.suspension_arrays import SuspensionArrays
from wheelrail.vehicle.multibody.vehicle import SpeedHold, Vehicle, VehicleBody
from wheelrail.vehicle.simulation.limit_cycle import (
    CycleSearch,
    bisected_fold,
    fold_bracket,
    frequency_of,
    limit_cycles,
)
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.critical_speed import critical_speed, least_damped
from wheelrail.vehicle.steady.equilibrium import EquilibriumError, equilibrium
from wheelrail.vehicle.steady.modes import Mode, held_wheelset_modes, modes
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track, centre_line
from wheelrail.vehicle.wagon.wagon import Wagon

EXUDYN = json.loads(Path(__file__).with_name("exudyn_vehicle.json").read_text(encoding="utf-8"))


@cache
def manchester() -> Vehicle:
    return load_vehicle()


def with_turn(vehicle: Vehicle, turn: float) -> Vehicle:
    return replace(vehicle, elements={name: replace(e, turn=turn) for name, e in vehicle.elements.items()})


def test_track_sections_follow_the_centre_line_of_the_track() -> None:
    segments = [Segment("tangent", 40.0, gradient=0.0), Segment("transition", 100.0, shape="clothoid")]
    segments += [Segment("arc", 200.0, 1 / 600, 0.1, gradient=0.01, vertical_radius=2000.0)]
    track = Track.of(segments)
    sections, (stations, points) = TrackSections(track), centre_line(track, 340.0)
    for reference in (40.0, 100.0, 141.0, 200.0):
        s = np.linspace(reference - 30.0, reference + 30.0, 61)
        poses = sections.at(s, reference)
        psi = heading(track, reference)
        level = np.array([[np.cos(psi), np.sin(psi), 0], [-np.sin(psi), np.cos(psi), 0], [0, 0, 1]])
        line = points[np.isin(stations, s)] - points[np.isclose(stations, reference)]
        np.testing.assert_allclose(poses.position, line @ level.T, atol=2e-11)


def test_static_loads_of_the_benchmark_vehicle() -> None:
    """A quarter of the car body on each secondary spring; an eighth of it and of two bogies on each primary spring."""
    dynamics = VehicleDynamics(manchester(), Track(), LinearCreep(), 30.0)
    np.testing.assert_allclose(dynamics.suspension.static_loads[:8], 45653.2875, rtol=1e-12)
    np.testing.assert_allclose(dynamics.suspension.static_loads[8:12], 78480.0, rtol=1e-12)
    wrenches = np.zeros((4, 6))
    wrenches[:, 2] = 2 * 54546.0525
    assert np.abs(dynamics.accelerations(0.0, np.zeros(dynamics.size), wrenches).rates).max() < 1e-9


def test_a_turned_vehicle_bears_its_loads_at_the_other_end() -> None:
    """Lateral and longitudinal laws are mirrored, and places in x and y."""
    vehicle = manchester()
    bodies = vehicle.bodies | {"car_body": replace(vehicle.bodies["car_body"], x=0.5)}
    vehicle = replace(vehicle, bodies=bodies)
    assert vehicle.turned.turned == vehicle
    loads, turned = (SuspensionArrays(Coordinates(own)).static_loads for own in (vehicle, vehicle.turned))
    points = [[own.point for own in v.elements.values()] for v in (vehicle, vehicle.turned)]
    np.testing.assert_allclose(turned, loads, rtol=1e-9)
    np.testing.assert_array_equal(points[1], np.multiply(points[0], [-1.0, -1.0, 1.0]))
    assert vehicle.turned != vehicle


def test_held_wheelsets_have_the_modes_of_the_plane_wagon() -> None:
    """Where both bogies move alike: sway and bounce of the car body, bounce, roll and lateral motion of the bogies."""
    dynamics = VehicleDynamics(with_turn(manchester(), 0.0), Track(), LinearCreep(), 30.0)
    whole = np.array([mode.eigenvalue for mode in held_wheelset_modes(dynamics)])
    plane = np.array(
        [mode.eigenvalue for mode in held_wheelset_modes(wagon_dynamics(Wagon(), Track(), LinearCreep(), 1.0))]
    )
    nearest = whole[np.abs(whole[:, None] - plane).argmin(axis=0)]
    np.testing.assert_allclose(nearest, plane, rtol=3e-6)
    assert len(plane) == 6


@pytest.mark.parametrize("kind", ["straight", "circle"])
def test_runs_are_those_of_exudyn(kind: str) -> None:
    """Random start, 0.05 s, without a force that keeps the speed; in the circle both bumpstops are compressed."""
    case = EXUDYN[kind]
    track = ConstantCurve(case["speed"], 1 / case["radius"], 0.1).track if case["radius"] else Track()
    dynamics = VehicleDynamics(replace(manchester(), speed_hold=None), track, LinearCreep(), case["speed"])
    settings = StepSettings("ode45", rtol=1e-7, atol=1e-10)
    *_, last = integrate(dynamics, 0.0, np.array(case["initial"]), case["time"][0], settings)
    position = last.x[:42].reshape(7, 6).copy()
    position[3:, PITCH] = 0.0
    np.testing.assert_allclose(position, case["position"][0], rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("series", [False, True])
def test_energy_changes_by_the_power_of_contacts_dampers_and_speed_hold(series: bool) -> None:
    """In a transition with cant while the speed changes, at random states."""
    vehicle = manchester()
    if series:
        stiff = {
            name: replace(e, series_stiffness=(6e6, 6e6, 6e6)) if min(e.damping) > 0.0 else e
            for name, e in vehicle.elements.items()
        }
        vehicle = replace(vehicle, elements=stiff)
    track = Track.of([Segment("transition", 60.0), Segment("arc", 200.0, 1 / 300, 0.1)])
    dynamics = VehicleDynamics(vehicle, track, LinearCreep(), SpeedProfile.through((0.0, 2.0), (10.0, 30.0)))
    random, size = np.random.default_rng(3), dynamics.size
    assert (size > 84) == series
    scale = np.concatenate([np.full(42, 1e-2), np.full(42, 0.1), np.full(size - 84, 1e-3)])
    for time in (1.0, 1.5, 1.8):
        state = scale * random.normal(size=size)
        wrenches = wheelset_wrenches(dynamics.solve_contacts(time, state, None))
        rate = np.concatenate([state[42:84], dynamics.accelerations(time, state, wrenches).rates])
        h = 3e-6
        after, before = (mechanical_energy(dynamics, time + d, state + d * rate) for d in (h, -h))
        powers = power(dynamics, time, state, wrenches)
        assert (after - before) / (2 * h) == pytest.approx(sum(powers), abs=3e-8 * sum(map(abs, powers)))
        assert powers.dampers < 0.0


WHEELSET = VehicleBody(1800.0, (1100.0, 110.0, 1100.0), 0.0, 0.46, wheelset=True)
SPRINGS = (4e6, 3e6, 1e6)  # N/m at each axle box
VERTICAL_DAMPING = 1e4  # N s/m at each axle box


def suspended(stiffness: tuple[float, float, float] = SPRINGS) -> Vehicle:
    """One wheelset below a frame so heavy that it stays at rest; hardly any gravity."""
    frame = VehicleBody(1e9, (1e9, 1e9, 1e9), 0.0, 0.6)
    boxes = {
        name: SuspensionElement("frame", "wheelset", (0.0, y, 0.46), stiffness, (0.0, 0.0, VERTICAL_DAMPING), turn=1.0)
        for name, y in (("left", 1.0), ("right", -1.0))
    }
    steady = {
        name: SuspensionElement("frame", "wheelset", (x, 0.0, 0.46), (0.0, 0.0, 1e-3), turn=1.0)
        for name, x in (("before", 1.0), ("behind", -1.0))
    }
    return Vehicle({"frame": frame, "wheelset": WHEELSET}, boxes | steady, {}, SpeedHold("frame"), gravity=1e-6)


def suspended_dynamics(speed: float, stiffness: tuple[float, float, float] = SPRINGS) -> VehicleDynamics:
    vehicle = suspended(stiffness)
    return VehicleDynamics(vehicle, Track(), LinearCreep(load=vehicle.mean_wheel_load, lateral=0.0), speed)


def closed_form(speed: float, stiffness: tuple[float, float, float] = SPRINGS) -> np.ndarray:
    """Eigenvalues of y, roll and yaw of a wheelset with linear creep on conical wheels, with its gyroscopic moments."""
    c, r, b = LinearCreep(), 0.46, 0.75
    kx, ky, kz = stiffness
    along, across = 2 * c.longitudinal_creep, 2 * c.lateral_creep
    turns = WHEELSET.inertia[1] * speed / r
    damping = np.array(
        [
            [across / speed, across * r / speed, 0.0],
            [across * r / speed, across * r**2 / speed + 2 * VERTICAL_DAMPING, -turns],
            [0.0, turns, along * b**2 / speed],
        ]
    )
    springs = np.array(
        [
            [2 * ky, 0.0, -across],
            [0.0, 2 * c.vertical * b**2 + 2 * kz, -across * r],
            [along * b * c.conicity / r, 0.0, 2 * kx],
        ]
    )
    mass = np.diag([WHEELSET.mass, WHEELSET.inertia[0], WHEELSET.inertia[2]])
    one, zero = np.eye(3), np.zeros((3, 3))
    return eigvals(np.block([[zero, one], [-springs, -damping]]), np.block([[one, zero], [zero, mass]]))


def test_a_suspended_wheelset_has_the_eigenvalues_of_the_closed_form() -> None:
    for speed in (20.0, 60.0):
        found = np.array([mode.eigenvalue for mode in modes(suspended_dynamics(speed))])
        expected = closed_form(speed)
        expected = expected[expected.imag >= 0.0]
        nearest = found[np.abs(found[:, None] - expected).argmin(axis=0)]
        np.testing.assert_allclose(nearest, expected, rtol=2e-5)


def test_critical_speed_of_a_suspended_wheelset() -> None:
    growth = brentq(lambda v: max(x.real for x in closed_form(v) if x.imag > 5.0), 20.0, 150.0, xtol=1e-9)
    found = critical_speed(suspended_dynamics(10.0), (20.0, 150.0), interval=40.0)
    assert found is not None
    assert found.speed == pytest.approx(growth, abs=0.02)
    assert critical_speed(suspended_dynamics(10.0), (0.3 * growth, 0.6 * growth), interval=100.0) is None


def test_a_free_wheelset_follows_klingels_wavelength() -> None:
    """2 pi sqrt(b r / conicity), of a slow wheelset that is hardly held."""
    found = modes(suspended_dynamics(1.0, (1.0, 1.0, 1e6)))
    wavelength = 2 * np.pi * np.sqrt(0.75 * 0.46 / 0.15)
    slow = [m for m in found if m.oscillates and m.energy_fraction[6:].sum() > 0.9 and m.frequency < 1.0]
    assert [1.0 / m.frequency for m in slow] == pytest.approx([wavelength], rel=2e-3)


@dataclass(frozen=True)
class CubicSpring(LinearCreep):
    """With a lateral force of each wheel that grows with the cube of y."""

    cubic: float = 0.0  # N/m3

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return replace(self, lateral=self.lateral + self.cubic * state.y**2).linear(state, side)

    def linear(self, state: WheelsetState, side: Side) -> ContactResult:
        return super().__call__(state, side)


def test_a_cubic_spring_limits_hunting_to_the_amplitude_of_its_describing_function() -> None:
    """A harmonic y of amplitude a feels a spring of stiffness 3/4 c a^2: that of neutral stability at this speed."""
    vehicle, amplitude = suspended(), 2e-3
    critical = critical_speed(suspended_dynamics(10.0), (20.0, 150.0), interval=40.0)
    assert critical is not None
    speed = 1.06 * critical.speed

    def mode(lateral: float, at: float = speed) -> Mode:
        contact = LinearCreep(load=vehicle.mean_wheel_load, lateral=lateral)
        return least_damped(modes(VehicleDynamics(vehicle, Track(), contact, at)))

    neutral = brentq(lambda lateral: mode(lateral).eigenvalue.real, 0.0, 4e6, xtol=1e3)
    contact = CubicSpring(load=vehicle.mean_wheel_load, lateral=0.0, cubic=neutral / (0.75 * amplitude**2))
    dynamics = VehicleDynamics(vehicle, Track(), contact, speed)
    search = CycleSearch(window=0.2, tolerance=0.015, smallest=0.5 * amplitude, rtol=1e-3, atol=1e-6)
    speeds, kick = (speed, 0.3 * critical.speed), 2 * np.pi * mode(neutral).frequency * amplitude
    steady, dying = limit_cycles(dynamics, speeds, {"wheelset": kick}, search)
    assert (steady.status, dying.status) == ("limit cycle", "dies out")
    assert steady.amplitude == pytest.approx([amplitude], rel=0.03)
    assert steady.frequency == pytest.approx(mode(neutral).frequency, rel=0.01)
    assert steady.track_shifting.shape == (1,)
    assert dying.amplitude[0] < search.smallest
    # a cycle of the smallest amplitude has a quarter of the stiffness
    fold = brentq(lambda v: mode(0.25 * neutral, v).eigenvalue.real, speeds[1], speed, xtol=0.1)
    cycles = [steady, dying]
    cycles += bisected_fold(dynamics, cycles, 0.06 * speed, search)
    bracket = fold_bracket(cycles)
    assert bracket is not None
    assert bracket[0].speed - bracket[1].speed <= 0.06 * speed
    assert bracket[1].speed - 0.01 * speed < fold < bracket[0].speed + 0.01 * speed
    assert fold_bracket([steady]) is None
    with pytest.raises(ValueError, match='no body "bogie"'):
        next(limit_cycles(dynamics, speeds, {"bogie": 0.1}))


def test_cycles_that_grow_from_zero_vanish_at_the_linear_critical_speed() -> None:
    """A stiffening spring: amplitudes grow with the root of the speed above it, from a motion below `smallest`; all of
    them are below atol.
    """
    vehicle = suspended()
    critical = critical_speed(suspended_dynamics(10.0), (20.0, 150.0), interval=40.0)
    assert critical is not None
    contact = CubicSpring(load=vehicle.mean_wheel_load, lateral=0.0, cubic=5e11)
    dynamics = VehicleDynamics(vehicle, Track(), contact, 10.0)
    search = CycleSearch(window=0.25, smallest=1e-4, rtol=1e-3, atol=1e-2)
    speeds = (1.03 * critical.speed, 0.985 * critical.speed)
    cycles = list(limit_cycles(dynamics, speeds, {"wheelset": 3e-3}, search))
    assert [cycle.status for cycle in cycles] == ["limit cycle", "dies out"]
    cycles += bisected_fold(dynamics, cycles, 0.015 * critical.speed, search)
    bracket = fold_bracket(cycles)
    assert bracket is not None
    assert bracket[1].speed < critical.speed < bracket[0].speed
    assert bracket[1].growth < 0.0 < bracket[0].growth
    assert bracket[0].speed - bracket[1].speed < 0.02 * critical.speed


def test_frequency_of_a_sampled_sine() -> None:
    time = np.arange(0.0, 1.0, 1e-3)
    assert frequency_of(time, 3.0 + np.sin(2 * np.pi * 6.2 * time + 1.0)) == pytest.approx(6.2, abs=1e-3)
    assert np.isnan(frequency_of(time, np.sin(2 * np.pi * 1.2 * time)))


def test_a_run_keeps_its_equilibrium_and_its_energy_balance() -> None:
    """A kicked bogie: the energy changes by the work of contacts, dampers and speed hold, by the trapezoidal rule."""
    dynamics = VehicleDynamics(manchester(), Track(), LinearCreep(), 30.0)
    rest = equilibrium(dynamics).state
    still = simulate(dynamics, (0.0, 0.1), initial=rest)
    angles = dynamics.coordinates.rolling_angles
    assert np.abs(np.delete(still.state - rest, angles, axis=1)).max() < 1e-7
    kicked = rest.copy()
    kicked[42 + 6 + 1] = 0.1  # lateral rate of the front bogie, m/s
    run = simulate(dynamics, (0.0, 0.3), initial=kicked, steps=StepSettings("rosenbrock", 1e-5, 1e-8))
    assert run.status == "completed"
    energy = [mechanical_energy(dynamics, t, x) for t, x in zip(run.time.tolist(), run.state, strict=True)]
    powers = [
        sum(power(dynamics, t, x, wheelset_wrenches(dynamics.solve_contacts(t, x, None))))
        for t, x in zip(run.time.tolist(), run.state, strict=True)
    ]
    work = (0.5 * (np.array(powers[1:]) + powers[:-1]) * np.diff(run.time)).sum()
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda v: replace(v, bodies={"car_body": v.bodies["car_body"]}), "bodies: one of them at least"),
        (lambda v: replace(v, elements={}), "bodies.car_body: must be connected to a wheelset"),
        (lambda v: replace(v, bodies=v.bodies | {"car_body": replace(v.bodies["car_body"], mass=-1.0)}), "mass"),
        (lambda v: replace(v, gravity=0.0), "gravity: must be positive"),
        (lambda v: replace(v, speed_hold=SpeedHold("engine")), "speed_hold.body"),
        (
            lambda v: replace(
                v, elements=v.elements | {"rod": SuspensionElement("car_body", "bogie", (0.0, 0.0, 1.0))}
            ),
            'elements.rod.lower: no body "bogie"',
        ),
        (
            lambda v: replace(v, elements=v.elements | {"rod": SuspensionElement("wheelset_1", "car_body", (0, 0, 1))}),
            "elements.rod.upper: must not be a wheelset",
        ),
    ],
)
def test_invalid_vehicles(change, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InvalidVehicle, match=message):
        change(manchester())


def test_a_body_without_vertical_springs_is_refused() -> None:
    vehicle = manchester()
    weak = {name: e for name, e in vehicle.elements.items() if not name.startswith("front_secondary")}
    with pytest.raises(InvalidVehicle, match=r"bodies\.car_body: must be carried by vertical springs"):
        VehicleDynamics(replace(vehicle, elements=weak), Track(), LinearCreep(), 30.0)
    held = vehicle.bodies | {"car_body": replace(vehicle.bodies["car_body"], held=("z", "pitch"))}
    VehicleDynamics(replace(vehicle, bodies=held, elements=weak), Track(), LinearCreep(), 30.0)


def test_without_a_speed_hold_there_is_no_equilibrium() -> None:
    coasting = VehicleDynamics(replace(manchester(), speed_hold=None), Track(), LinearCreep(), 30.0)
    with pytest.raises(EquilibriumError, match="speed_hold"):
        equilibrium(coasting)
