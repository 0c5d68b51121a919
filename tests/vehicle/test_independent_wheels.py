"""Wheelsets whose wheels turn by themselves: spins, torsion between them, mirror image, energy, invalid input."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
from linear_creep import LinearCreep
from plane import mirror_signs

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle import vehicle_on
from wheelrail.scenes.builders.vehicle_file import MANCHESTER, load_vehicle, parse_vehicle
from wheelrail.scenes.builders.wheelset import run_contact
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import RunScene, parse_scene
from wheelrail.scenes.wear.lifted import LiftedContact
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.loads import AppliedLoads, BodyForce, WheelsetTorque
from wheelrail.vehicle.multibody.coordinates import X, Y
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.simulation.energy_balance import energy_balance
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.modes import modes
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

V = 20.0
SCENE = (MANCHESTER.parent / "vehicle.toml").read_text(encoding="utf-8")
PADS = "[track.pads]\nvertical = 100e6\nlateral = 40e6\n"


def vehicle(**wheels: object) -> Vehicle:
    """The Manchester vehicle with values of its wheelsets."""
    found = load_vehicle()
    bodies = {name: replace(b, **wheels) if b.wheelset else b for name, b in found.bodies.items()}  # type: ignore
    return replace(found, bodies=bodies)


def dynamics(of: Vehicle, track: Track, contact: VehicleContact, loads: AppliedLoads | None = None) -> VehicleDynamics:
    return VehicleDynamics(of, track, contact, V, loads=loads or AppliedLoads())


def linear(of: Vehicle, conicity: float = 0.15) -> LinearCreep:
    return LinearCreep(radius=of.radius, load=of.mean_wheel_load, conicity=conicity)


def test_shifted_wheels_roll_on_their_own_radii_without_creep_forces() -> None:
    """Creep is zero where spin times radius is the speed; the cones' radii are known."""
    own = vehicle(independent=True)
    aside = tuple(BodyForce(name, (body.x, 0.0, 0.46), lateral=1800.0)
                  for name, body in own.bodies.items() if body.wheelset)  # fmt: skip
    at = equilibrium(dynamics(own, Track(), linear(own), AppliedLoads(forces=aside)))
    for name, state in at.dynamics.wheelset_states(0.0, at.state).items():
        left, right = (state.pitch_rate + way * state.twist_rate for way in (1.0, -1.0))
        radii = 0.46 + 0.15 * state.y, 0.46 - 0.15 * state.y
        assert 2e-3 < state.y < 6e-3
        assert left * radii[0] == pytest.approx(right * radii[1], rel=1e-6)
        assert max(abs(result.force[0]) for result in at.contacts[name].values()) < 20.0


@pytest.mark.parametrize(("radius", "curvature"), [(25.0, 1.0), (40.0, -1.0), (15.0, 1.0)])
def test_in_a_curve_each_wheel_has_the_speed_of_its_rail(radius: float, curvature: float) -> None:
    own = vehicle(independent=True)
    bodies = {name: replace(b, held=("x", "y", "roll", "yaw")) for name, b in own.bodies.items()}
    track = ConstantCurve(V, curvature / radius, 0.0).track
    at = equilibrium(dynamics(replace(own, bodies=bodies), track, linear(own, conicity=0.0)))
    for state in at.dynamics.wheelset_states(0.0, at.state).values():
        for way in (1.0, -1.0):
            spin = state.pitch_rate + way * state.twist_rate
            assert spin == pytest.approx(V / radius * (radius - way * curvature * 0.75) / 0.46, rel=1e-4)


def test_a_stiff_axle_between_independent_wheels_is_a_rigid_wheelset() -> None:
    """A run through a transition: the twist is the moment over the stiffness."""
    track = Track.of([Segment("transition", 30.0), Segment("arc", 100.0, 1 / 900)])
    runs = []
    for own in (vehicle(), vehicle(independent=True, torsion=(1e10, 1e6))):
        steps = StepSettings("rosenbrock", 1e-4, 1e-7)
        runs.append(simulate(dynamics(own, track, linear(own)), (0.0, 1.0), steps=steps))
    rigid, stiff = runs
    assert (rigid.status, stiff.status) == ("completed", "completed")
    for body in rigid.dynamics.vehicle.names:
        assert stiff.position(body)[-1] == pytest.approx(rigid.position(body)[-1], rel=1e-3, abs=1e-6)
    c = stiff.dynamics.coordinates
    moments = stiff.rows[-1].moment
    assert np.abs(moments[:, 0, 1] - moments[:, 1, 1]).max() > 1e3
    expected = (moments[:, 0, 1] - moments[:, 1, 1]) / 4e10
    assert stiff.state[-1, c.twists] == pytest.approx(expected, rel=0.05)


@dataclass(frozen=True)
class Smooth(LinearCreep):
    """Without creep forces: wheels turn as they like."""

    longitudinal_creep: float = 0.0


def test_wheels_on_a_spring_swing_against_each_other() -> None:
    """Two wheels of J / 2 each with the spring k: the angular frequency is sqrt(4 k / J), the damping c / k of it."""
    stiffness, damping = 2e5, 300.0
    own = vehicle(independent=True, torsion=(stiffness, damping))
    contact = Smooth(radius=own.radius, load=own.mean_wheel_load)
    rest = np.zeros(dynamics(own, Track(), contact).size)
    d = dynamics(own, Track(), contact)
    matrix = VehicleJacobian(d, StepStatistics())(0.0, rest, d(0.0, rest)).by_state
    places = np.r_[d.coordinates.twists, d.coordinates.twist_rates]
    values = np.linalg.eigvals(matrix[np.ix_(places, places)])
    expected = sqrt(4.0 * stiffness / own.bodies["wheelset_1"].inertia[1])
    assert np.abs(values) == pytest.approx(np.full(8, expected), rel=1e-9)
    assert -values.real == pytest.approx(np.full(8, 0.5 * damping / stiffness * expected**2), rel=1e-9)


def test_modes_name_the_twist() -> None:
    own = vehicle(independent=True, torsion=(2e5, 0.0))
    found = modes(dynamics(own, Track(), linear(own)))
    assert any("wheelset_1_twist" in mode.main_coordinates for mode in found)


def case(number: int) -> tuple[VehicleDynamics, Array]:
    """A random vehicle and a state in a curve."""
    random = np.random.default_rng(number)
    own = vehicle(independent=True, torsion=tuple(random.uniform(0.0, 1e6, 2) * random.integers(0, 2, 2)))
    bodies = dict(own.bodies)
    bodies["wheelset_2"] = replace(bodies["wheelset_2"], independent=False, torsion=(0.0, 0.0))
    turn = random.uniform(50.0, 300.0)
    bodies["wheelset_3"] = replace(bodies["wheelset_3"], mass=random.uniform(500, 2000), inertia=(900.0, turn, 900.0))
    d = dynamics(replace(own, bodies=bodies), ConstantCurve(V, 1 / random.uniform(50, 500)).track, linear(own))
    scale = np.full(d.size, 1e-2)
    return d, scale * random.normal(size=d.size)


@pytest.mark.parametrize("number", range(4))
def test_jacobian_against_differences(number: int) -> None:
    d, state = case(number)
    at = d(0.0, state)
    matrix = VehicleJacobian(d, StepStatistics(), central=True)(0.0, state, at).by_state
    steps = 1e-5 * np.eye(d.size)
    found = np.array([(d(0.0, state + s).rate - d(0.0, state - s).rate) / 2e-5 for s in steps]).T
    rows = d.coordinates.twist_rates
    assert matrix[rows] == pytest.approx(found[rows], rel=1e-5, abs=1e-4 * np.abs(found[rows]).max())
    assert matrix[:, rows] == pytest.approx(found[:, rows], rel=1e-5, abs=1e-4 * np.abs(found[:, rows]).max())


def test_jacobian_on_pads_with_the_standard_contact() -> None:
    scene, own = parse_scene(SCENE + PADS, "pads.toml"), vehicle(independent=True, torsion=(0.0, 50.0))
    assert isinstance(scene, RunScene)
    contact, structures = run_contact(scene, own.wheelsets)
    d = VehicleDynamics(own, Track(), contact, V, structures)
    state = equilibrium(d).state
    state[d.coordinates.twist_rates] = 0.02, -0.01, 0.03, 0.01
    at = d(0.0, state)
    matrix = VehicleJacobian(d, StepStatistics())(0.0, state, at).by_state
    columns = np.arange(d.size)[d.coordinates.twist_rates]
    for column in [*columns.tolist(), d.coordinates.count + d.coordinates.index("wheelset_3", X)]:
        step = np.zeros(d.size)
        step[column] = 1e-6
        found = (d(0.0, state + step, at).rate - d(0.0, state - step, at).rate) / 2e-6
        assert matrix[:, column] == pytest.approx(found, rel=1e-3, abs=1e-4 * np.abs(found).max())


@pytest.mark.parametrize("number", range(4))
def test_acceleration_of_each_wheel_is_that_of_its_own_rotor(number: int) -> None:
    """J / 2 times the rate of a wheel's angular velocity about the axle is the moment on it, see `LinearCreep`."""
    d, state = case(number)
    at = d(0.0, state)
    c, rates = d.coordinates, dict(zip(d.coordinates.names, at.rate[d.coordinates.count :], strict=False))
    states = d.wheelset_states(0.0, state)
    for i, name in enumerate(d.vehicle.independent):
        own, body = states[name], d.vehicle.bodies[name]
        axle = np.array([-np.sin(own.yaw) * np.cos(own.roll), np.cos(own.yaw) * np.cos(own.roll), np.sin(own.roll)])
        twist, rate = state[c.twists][i], state[c.twist_rates][i]
        spring = body.torsion[0] * 2.0 * twist + body.torsion[1] * 2.0 * rate
        left, right = (at.contacts[name][side].moment @ axle for side in ("left", "right"))
        wheels = (left - spring) / (0.5 * body.inertia[1]), (right + spring) / (0.5 * body.inertia[1])
        assert 2.0 * rates[f"{name}_twist"] == pytest.approx(wheels[0] - wheels[1], rel=1e-9)


def mirrored(of: VehicleDynamics) -> Array:
    signs, c = mirror_signs(replace(of, vehicle=vehicle()).coordinates), of.coordinates
    result = np.full(of.size, -1.0)
    result[c.of_bodies] = signs
    return result


def test_a_run_is_the_mirror_image_bit_by_bit() -> None:
    histories = []
    for way in (1.0, -1.0):
        own = vehicle(independent=True, torsion=(0.0, 200.0))
        track = Track.of([Segment("transition", 10.0), Segment("arc", 60.0, way / 400)])
        d = dynamics(own, track, replace(linear(own), lateral=4e6))
        histories.append(simulate(d, (0.0, 0.6), steps=StepSettings("rosenbrock", 1e-2, 1e-5)))
    left, right = histories
    signs = mirrored(left.dynamics)
    assert (left.status, right.status) == ("completed", "completed")
    assert np.abs(left.state[:, left.dynamics.coordinates.twist_rates]).max() > 0.01
    assert np.array_equal(left.time, right.time)
    assert np.array_equal(left.state, signs * right.state)


def test_the_energy_changes_by_the_work() -> None:
    own = vehicle(independent=True, torsion=(1e5, 200.0))
    held = {name: replace(body, held=("x",)) for name, body in own.bodies.items()}
    own = replace(own, bodies=held)
    d = dynamics(own, Track(), linear(own))
    kicked, c = np.zeros(d.size), d.coordinates
    kicked[c.twist_rates] = 0.3, -0.2, 0.1, 0.0
    kicked[c.count + c.index("wheelset_1", Y)] = 0.1
    run = simulate(d, (0.0, 0.15), initial=kicked, steps=StepSettings("rosenbrock", 1e-4, 1e-7))
    assert run.status == "completed"
    balance = energy_balance(run)
    assert 0.2 * np.ptp(balance.energy) < 0.5 * 112.0 * (0.3**2 + 0.2**2 + 0.1**2)
    assert balance.error < 1e-3


@dataclass(frozen=True)
class Spins(LinearCreep):
    """Contact that keeps the spins it is called with."""

    seen: dict[Side, float] = field(default_factory=dict)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        self.seen[side] = state.pitch_rate
        return super().__call__(state, side, guess)


def test_each_contact_sees_the_spin_of_its_wheel_in_runs_and_in_wear() -> None:
    contact = Spins()
    d = dynamics(vehicle(independent=True), Track(), contact)
    state = np.zeros(d.size)
    state[d.coordinates.twist_rates] = 0.25
    at, expected = d(0.0, state), {"left": V / 0.46 + 0.25, "right": V / 0.46 - 0.25}
    assert contact.seen == expected
    contact.seen.clear()
    scene = parse_scene(SCENE, "vehicle.toml")
    assert isinstance(scene, RunScene)
    lifted = LiftedContact(scene, dict.fromkeys(d.vehicle.wheelsets, contact), contact).motion()
    assert all(
        result.ok for sides in lifted.results(at.states or {}, at.contacts).values() for result in sides.values()
    )
    assert contact.seen == expected


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"independent": True, "held": ("pitch",)}, "independent: must be false but for a wheelset"),
        ({"torsion": (1e5, 0.0)}, "torsion: must be zero but between independent wheels"),
        ({"independent": True, "torsion": (-1.0, 0.0)}, "torsion: must be zero or positive"),
    ],
)
def test_invalid_wheels(change: dict[str, object], message: str) -> None:
    with pytest.raises(InvalidVehicle, match=message):
        vehicle(**change)


def test_a_car_body_has_no_wheels_and_a_friction_brake_needs_an_axle() -> None:
    found = load_vehicle()
    with pytest.raises(InvalidVehicle, match=r"bodies.car_body.independent: must be false"):
        replace(found, bodies=found.bodies | {"car_body": replace(found.bodies["car_body"], independent=True)})
    brake = AppliedLoads((WheelsetTorque("wheelset_1", 5e3, brake=True),))
    with pytest.raises(InvalidVehicle, match="rigid axle"):
        dynamics(vehicle(independent=True), Track(), linear(found), brake)


def test_a_vehicle_file_with_independent_wheels_and_its_mistakes(tmp_path: Path) -> None:
    text = MANCHESTER.read_text(encoding="utf-8")
    own = text.replace("wheelset = true\n", "wheelset = true\nindependent = true\ntorsion = [1e5, 20]\n")
    assert parse_vehicle(own, "own.toml").bodies["wheelset_2"].torsion == (1e5, 20.0)
    with pytest.raises(SceneError, match=r"bodies.car_body.independent = true: must be false but for a wheelset"):
        parse_vehicle(text.replace("height = 1.80\n", "height = 1.80\nindependent = true\n"), "own.toml")
    file = tmp_path / "own.toml"
    file.write_text(own, encoding="utf-8")
    elastic = parse_scene(SCENE + "[wheelset.axle]\ndiameter = 0.16\n", "scene.toml")
    assert isinstance(elastic, RunScene)
    with pytest.raises(SceneError, match=r"wheelset_1.independent = true: must be false with an elastic wheelset.axle"):
        vehicle_on(elastic, file)
