"""Traction and brake torques, drawbar and wind forces: equations, closed forms, limits of adhesion."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from linear_creep import LinearCreep
from newton_euler import accelerations
from numpy_vehicle import applied_state, hold_force, kinematics, mechanical_energy, power, rotate
from scipy.integrate import trapezoid
from scipy.interpolate import CubicSpline
from standard_pair import wheel_on_rail

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.loads import AppliedLoads, BodyForce, LoadTable, WheelsetTorque
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, X, Y, Z
from wheelrail.vehicle.multibody.elements import InvalidVehicle
from wheelrail.vehicle.multibody.equations import VehicleDynamics, wheelset_wrenches
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.limits import SLOWEST
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.steady.start_state import start_state
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.irregularity import Irregularities
from wheelrail.vehicle.track.irregularity_spectrum import ERRI
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track


@cache
def manchester() -> Vehicle:
    return load_vehicle()


@cache
def free() -> Vehicle:
    return replace(manchester(), speed_hold=None)


EVERY = AppliedLoads(
    (
        WheelsetTorque("wheelset_1", LoadTable(((0.5, 0.0), (1.5, -4e4)))),
        WheelsetTorque("wheelset_2", 3e3, "car_body"),
        WheelsetTorque("wheelset_3", LoadTable(((0.0, 1e3), (20.0, 2e4), (60.0, 5e3)), by_distance=True), brake=True),
        WheelsetTorque("wheelset_4", 5e3, brake=True),
    ),
    (
        BodyForce("car_body", (12.5, 0.1, 1.0), -2e4, LoadTable(((0.0, 0.0), (2.0, 1e4))), 500.0),
        BodyForce("rear_bogie", (-9.0, -1.0, 0.5), lateral=LoadTable(((5.0, 0.0), (50.0, 1e4)), by_distance=True)),
        BodyForce("wheelset_2", (8.22, 1.0, 0.6), 1e3, 2e3, -3e3),
    ),
)


def in_a_transition() -> VehicleDynamics:
    """Of curvature, cant and gradient, while the speed of the reference changes."""
    segments = [Segment("transition", 60.0), Segment("arc", 200.0, 1 / 300, 0.1, gradient=0.01, vertical_radius=2000.0)]
    speed = SpeedProfile.through((0.0, 2.0), (10.0, 30.0))
    track = Track.of([Segment("tangent", 5.0, gradient=0.0), *segments])
    return VehicleDynamics(manchester(), track, LinearCreep(), speed, loads=EVERY)


def samples(dynamics: VehicleDynamics) -> list[tuple[float, Array, Array]]:
    """Times, random states and contact forces; the last wheelset is nearly held in its brake."""
    random, c, result = np.random.default_rng(5), dynamics.coordinates.count, []
    for time in (0.3, 1.0, 1.8):
        state = np.concatenate([np.full(c, 1e-2), np.full(c, 0.1)]) * random.normal(size=dynamics.size)
        rolling = dynamics.speed_profile(time).speed / dynamics.vehicle.radius
        spin = c + dynamics.coordinates.index("wheelset_4", PITCH)
        state[spin] = 0.03 - rolling + state[c + dynamics.coordinates.index("rear_bogie", PITCH)]
        result.append((time, state, 1e4 * random.normal(size=(4, 6))))
    return result


def test_compiled_equations_are_those_in_numpy() -> None:
    dynamics = in_a_transition()
    unloaded = replace(dynamics, loads=AppliedLoads())
    for time, state, wrenches in samples(dynamics):
        expected = accelerations(dynamics, time, state, wrenches)
        actual = dynamics.accelerations(time, state, wrenches).rates
        np.testing.assert_allclose(actual, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
        assert np.abs(actual - unloaded.accelerations(time, state, wrenches).rates).max() > 1.0


def test_derivatives_are_those_of_differences() -> None:
    """By the state, of which brakes depend on rates and tables on x, and by time, at constant contact forces."""
    dynamics, step = in_a_transition(), 1e-6
    for time, state, wrenches in samples(dynamics)[1:]:
        travel, (_, _, jerk) = dynamics.speed_profile(time), dynamics.speed_profile.speeds(time)
        actual = dynamics.bodies.derivatives(travel, jerk, state, wrenches)
        steps = step * np.eye(dynamics.size)
        plus, minus = (accelerations(dynamics, time, state + s, wrenches) for s in (steps, -steps))
        by_state = (plus - minus).T / (2 * step)
        np.testing.assert_allclose(actual.by_state, by_state, rtol=0.0, atol=1e-7 * np.abs(by_state).max())
        plus, minus = (accelerations(dynamics, time + h, state, wrenches) for h in (1e-5, -1e-5))
        by_time = (plus - minus) / 2e-5
        np.testing.assert_allclose(actual.by_time, by_time, rtol=0.0, atol=1e-6 * np.abs(by_time).max())
        none = replace(dynamics, loads=AppliedLoads()).bodies.derivatives(travel, jerk, state, wrenches)
        assert np.abs(actual.by_state - none.by_state).max() > 1e-5 * np.abs(by_state).max()
        assert np.abs(actual.by_time - none.by_time).max() > 1e-3 * np.abs(by_time).max()


def test_mirrored_loads_have_mirrored_accelerations_bit_for_bit() -> None:
    """A pair of forces at both sides, brakes, and a wind from the other side."""
    sides = tuple(BodyForce("car_body", (-3.0, y, 1.1), 1e3, vertical=2e3) for y in (0.7, -0.7))
    torques = EVERY.torques
    loads = [AppliedLoads(torques, (*sides, BodyForce("car_body", (1.0, 0.0, 2.0), 0.0, wind))) for wind in (1e4, -1e4)]
    left, right = (
        VehicleDynamics(manchester(), Track.of([Segment("arc", 200.0, k, 0.1)]), LinearCreep(), 30.0, loads=load)
        for k, load in zip((1 / 600, -1 / 600), loads, strict=True)
    )
    sign = np.where(np.tile(np.isin(np.arange(6), (Y, ROLL, YAW)), 14), -1.0, 1.0)
    time, state, wrenches = samples(left)[1]
    mirrored = wrenches * [1.0, -1.0, 1.0, -1.0, 1.0, -1.0]
    expected = left.accelerations(time, state, wrenches).rates
    np.testing.assert_array_equal(right.accelerations(time, sign * state, mirrored).rates, sign[:42] * expected)
    there = left.bodies.derivatives(left.speed_profile(time), 0.0, state, wrenches)
    here = right.bodies.derivatives(right.speed_profile(time), 0.0, sign * state, mirrored)
    np.testing.assert_array_equal(here.by_state, sign[:42, None] * there.by_state * sign)
    np.testing.assert_array_equal(here.by_time, sign[:42] * there.by_time)


def test_a_far_drift_changes_nothing() -> None:
    """The same motion counted from a reference that is 460 m behind, and slower."""
    dynamics = replace(in_a_transition(), vehicle=free(), speed=20.0, loads=AppliedLoads(EVERY.torques[:2]))
    segments = [Segment("transition", 60.0), Segment("arc", 200.0, 1 / 300, 0.1, gradient=0.01, vertical_radius=2000.0)]
    later = Track.of([Segment("tangent", 450.0, gradient=0.0), *segments])
    time, state, wrenches = samples(dynamics)[1]
    behind, c, drift = replace(dynamics, track=later, speed=5.0), dynamics.coordinates.count, state.copy()
    along = [dynamics.coordinates.index(name, X) for name in dynamics.vehicle.names]
    spins = [dynamics.coordinates.index(name, PITCH) for name in dynamics.vehicle.wheelsets]
    drift[along] += 445.0 + 15.0 * time
    drift[np.add(c, along)] += 15.0
    drift[np.add(c, spins)] += 15.0 / dynamics.vehicle.radius
    expected = dynamics.accelerations(time, state, wrenches).rates
    atol = 1e-11 * np.abs(expected).max()
    np.testing.assert_allclose(behind.accelerations(time, drift, wrenches).rates, expected, rtol=0.0, atol=atol)
    np.testing.assert_allclose(accelerations(behind, time, drift, wrenches), expected, rtol=0.0, atol=atol)
    travels = [d.speed_profile(time) for d in (dynamics, behind)]
    one = dynamics.bodies.derivatives(travels[0], 0.0, state, wrenches).by_state
    two = behind.bodies.derivatives(travels[1], 0.0, drift, wrenches).by_state
    np.testing.assert_allclose(two, one, rtol=0.0, atol=1e-11 * np.abs(one).max())


NAMES = tuple(manchester().wheelsets)
WHEEL = 112.0  # kg m2, of each wheelset about its axle


def on_all(torque: float | LoadTable, *, brake: bool = False) -> AppliedLoads:
    return AppliedLoads(tuple(WheelsetTorque(name, torque, brake=brake) for name in NAMES))


def at_end(run: History) -> tuple[Array, Array]:
    """Longitudinal and vertical forces (4,) N of the wheelsets at the end of a run."""
    return run.force[-1, :, :, 0].sum(axis=1), run.force[-1, :, :, 2].sum(axis=1)


def slope(run: History, values: Array, since: float) -> float:
    """Mean slope over time of values (n,) from a time s to the end."""
    return float((values[-1] - np.interp(since, run.time, values)) / (run.time[-1] - since))


@pytest.mark.parametrize("torque", [4e3, -3e3])
def test_acceleration_of_a_vehicle_that_runs_free(torque: float) -> None:
    """T/r = F + J a (1 + c)/r^2 and m a = 4 F, with the creepage c of wheels that turn faster or slower by it."""
    ramp = LoadTable(((0.5, 0.0), (1.5, torque)))
    dynamics = VehicleDynamics(free(), Track(), LinearCreep(), 20.0, loads=on_all(ramp))
    run = simulate(dynamics, (0.0, 8.0), steps=StepSettings("rosenbrock", 1e-4, 1e-6))
    assert run.status == "completed"
    assert {0.5, 1.5} <= set(run.time.tolist())
    mass, radius, creep = dynamics.mass.sum(), 0.46, 2 * LinearCreep().longitudinal_creep
    share = WHEEL / radius**2
    creepage = torque / radius / (1 + 4 * share / mass) / creep  # to first order
    expected = 4 * torque / radius / (mass + 4 * share * (1 + creepage))
    assert slope(run, run.speeds, 5.0) == pytest.approx(expected, rel=2e-6)
    assert at_end(run)[0].sum() == pytest.approx(mass * expected, rel=2e-6)
    rate = run.rate("wheelset_1")[-1]
    spin, speed = rate[PITCH] + 20.0 / radius, 20.0 + rate[X]
    assert spin * radius / speed - 1.0 == pytest.approx(creepage, rel=1e-3)
    assert run.distance[-1] == pytest.approx(trapezoid(run.speeds, run.time), rel=1e-3)
    assert abs(run.distance[-1] - 160.0) > 10.0


def test_loads_move_from_axle_to_axle_as_in_statics() -> None:
    """Steady braking: moments about the y axis of the vehicle, its car body and a bogie, with inertial forces."""
    dynamics = VehicleDynamics(free(), Track(), LinearCreep(), 30.0, loads=on_all(LoadTable(((0.5, 0.0), (2.5, -8e3)))))
    run = simulate(dynamics, (0.0, 12.0), steps=StepSettings("rosenbrock", 1e-4, 1e-6))
    deceleration, load = slope(run, run.speeds, 10.0), at_end(run)[1]
    motion = kinematics(dynamics)(dynamics.speed_profile(run.time[-1]), run.state[-1])
    place = motion.position - [motion.position[0, 0], 0.0, 0.0]
    spins = 4 * WHEEL * deceleration / 0.46  # N m, of the wheels' rotation
    # By height over distance: the vehicle, about the rail below its car body.
    inertial = dynamics.mass * deceleration * place[:, 2]
    weight = dynamics.mass * 9.81 * place[:, 0]
    assert (load * place[3:, 0]).sum() - weight.sum() == pytest.approx(-inertial.sum() - spins, rel=1e-4)
    # Forces of rods and secondary springs on the car body, at their points.
    moments, names = np.zeros(7), dynamics.vehicle.names
    for (name, element), own in zip(dynamics.vehicle.elements.items(), run.suspension()[1][-1], strict=True):
        if not name.startswith("primary"):
            lower, body = names.index(element.lower), dynamics.vehicle.bodies["car_body"]
            arm = np.array(element.point) - [body.x, 0.0, body.height]
            force, at = motion.axes[lower] @ own, place[0] + motion.axes[0] @ arm
            moments[[0, lower]] += np.array([1.0, -1.0]) * (at[2] * force[0] - at[0] * force[2])
    assert moments[0] == pytest.approx(inertial[0], rel=1e-4)
    bogie = [1, 3, 4]  # with its wheelsets
    carried = weight[bogie].sum() + moments[1] - inertial[bogie].sum() - 0.5 * spins
    assert (load[:2] * place[3:5, 0]).sum() == pytest.approx(carried, rel=1e-5)
    # By nominal heights: forces of the car body at the rods, whose springs carry most of them.
    height = np.array([body.height for body in dynamics.vehicle.bodies.values()])
    moment = (dynamics.mass[bogie] @ height[bogie] + 0.5 * dynamics.mass[0] * 0.60) * -deceleration - 0.5 * spins
    assert load[0] - load[1] == pytest.approx(moment / 1.28, rel=0.05)
    assert load[0] - load[1] > 1e4


def test_a_drawbar_is_balanced_by_creep_at_held_speed() -> None:
    """A braked wagon with a drawbar force at its front: all forces balance, in a curve and along straight track."""
    pull = 60e3
    curve = ConstantCurve(15.0, 1 / 400, 0.05)
    drawbar = BodyForce("car_body", (13.0, 0.0, 1.06), pull)
    held = VehicleDynamics(
        manchester(),
        curve.track,
        wheel_on_rail(),
        curve.speed,
        loads=replace(on_all(5e3, brake=True), forces=(drawbar,)),
    )
    found = equilibrium(held)
    wrenches = wheelset_wrenches(found.contacts)
    motion = kinematics(held)(held.speed_profile(0.0), found.state)
    applied = applied_state(held.applied, held.speed_profile(0.0), motion, found.state)
    np.testing.assert_allclose(applied.torque, -5e3, rtol=1e-12)
    along = [rotate(motion.sections.axes[i], wrenches[k, :3]) for k, i in enumerate(held.coordinates.wheelset_bodies)]
    hold = hold_force(held, motion, found.state)
    weight = np.zeros((len(held.mass), 3))
    weight[:, 2] = -9.81 * held.mass
    # Sum of all forces on the vehicle, less those of the bodies' own circular motion.
    total = np.sum(along, axis=0) + (applied.force + hold + weight).sum(axis=0)
    centre = (motion.position * held.mass[:, None]).sum(axis=0) / held.mass.sum()
    turn = np.array([0.0, 0.0, curve.speed / 400])
    radius = centre - np.array([0.0, 400.0, 0.0])
    inward = held.mass.sum() * np.cross(turn, np.cross(turn, radius))
    np.testing.assert_allclose(total, inward, atol=1e-6 * held.vehicle.weight)
    straight = equilibrium(replace(held, track=Track()))
    force = wheelset_wrenches(straight.contacts)[:, 0].sum()
    at = kinematics(straight.dynamics)(held.speed_profile(0.0), straight.state)
    hold = hold_force(straight.dynamics, at, straight.state)[:, 0].sum()
    assert force + hold == pytest.approx(-pull, rel=1e-6)
    assert force == pytest.approx(-4 * 5e3 / 0.46, rel=2e-3)


def test_wind_loads_the_wheels_of_the_other_side() -> None:
    """On straight track: Delta Q b = F h, with the roll of the car body."""
    wind = AppliedLoads(forces=(BodyForce("car_body", (0.0, 0.0, 2.2), lateral=10e3),))
    found = equilibrium(VehicleDynamics(manchester(), Track(), wheel_on_rail(), 30.0, loads=wind))
    wrenches = wheelset_wrenches(found.contacts)
    assert wrenches[:, 1].sum() == pytest.approx(-10e3, rel=1e-6)
    motion = kinematics(found.dynamics)(found.dynamics.speed_profile(0.0), found.state)
    sides = {n: np.array([c[s].force[2] for s in ("left", "right")]) for n, c in found.contacts.items()}
    shift = (9.81 * found.dynamics.mass * motion.position[:, 1]).sum()
    moments = sum(wrenches[k, 3] + np.cross(motion.position[i], wrenches[k, :3])[0] for k, i in enumerate(range(3, 7)))
    height = 2.2 + found.dynamics.coordinates.split(found.state).position[0, Z]
    assert moments == pytest.approx(10e3 * height + shift, rel=1e-3)
    assert all(left > right for left, right in sides.values())


@pytest.mark.parametrize("brake", [False, True], ids=["motor", "brake"])
def test_torque_above_adhesion(brake: bool) -> None:
    """Force mu N; the wheel spins up by (T - F r)/J, or is held by its brake and slides."""
    loads = AppliedLoads((WheelsetTorque("wheelset_1", LoadTable(((0.2, 0.0), (0.6, 2e4))), brake=brake),))
    dynamics = VehicleDynamics(free(), Track(), wheel_on_rail(), 20.0, loads=loads)
    run = simulate(dynamics, (0.0, 3.0))
    assert run.status == "completed"
    spin = run.rate("wheelset_1")[:, PITCH] + 20.0 / 0.46
    along, up = run.force[:, 0, :, 0].sum(axis=1), run.force[:, 0, :, 2].sum(axis=1)
    assert abs(along[-1]) / up[-1] == pytest.approx(0.3, rel=2e-3)
    if brake:
        assert spin[-1] * 0.46 == pytest.approx(0.05 * abs(along[-1]) * 0.46 / 2e4, rel=1e-2)
        assert run.applied()[0][-1, 0] == pytest.approx(along[-1] * 0.46, rel=2e-3)
        falling = (run.time > 0.8) & (spin > 1.0)
        gained = slope_of(run.time[falling], spin[falling])
        assert gained == pytest.approx(-(2e4 - np.abs(along[falling]).mean() * 0.46) / WHEEL, rel=5e-3)
    else:
        late = run.time > 1.5
        assert slope_of(run.time[late], spin[late]) == pytest.approx(
            (2e4 - along[late].mean() * 0.46) / WHEEL, rel=5e-3
        )
        assert spin[-1] * 0.46 > 70.0
    assert np.abs(run.force[:, 3, :, 0].sum(axis=1)).max() < 1e3


def slope_of(x: Array, y: Array) -> float:
    return float(np.polyfit(x, y, 1)[0])


def test_brakes_bring_the_vehicle_to_a_halt() -> None:
    run = simulate(VehicleDynamics(free(), Track(), wheel_on_rail(), 10.0, loads=on_all(8e3, brake=True)), (0.0, 60.0))
    assert run.status == "completed"
    assert 0.0 < run.speeds[-1] < SLOWEST < run.speeds[-2]
    deceleration = 4 * 8e3 / 0.46 / (run.dynamics.mass.sum() + 4 * WHEEL / 0.46**2)
    assert run.time[-1] == pytest.approx(10.0 / deceleration, rel=0.02)
    assert run.distance[-1] == pytest.approx(50.0 / deceleration, rel=0.02)
    spins = np.array([run.rate(name)[:, PITCH] for name in NAMES]) + 10.0 / 0.46
    assert spins.min() > 0.0


@pytest.mark.parametrize("method", ["rosenbrock", "rosenbrock4"])
def test_long_steps_of_a_braking_vehicle_meet_a_dip_where_it_is(method: str) -> None:
    """A dip of 0.25 mm over 4.7 m is static at 2 m/s; stages without the deceleration met it 0.2 m too early."""
    half, vehicle = 2.37, free()
    x = np.linspace(-half, half, 101)
    values = np.zeros((101, 4))
    values[:, 1] = -2.5e-4 * (1.0 - np.abs(x) / half) ** 2
    dip, brakes = Irregularities(39.2 + x, values), on_all(LoadTable(((0.5, 0.0), (0.8, 2e3))), brake=True)
    dynamics = VehicleDynamics(vehicle, Track(irregularities=dip), wheel_on_rail(), 4.4, loads=brakes)
    run = simulate(dynamics, (0.0, 34.0), steps=StepSettings(method, 4.7e-3, 4.7e-5))
    assert run.status == "completed"
    assert run.distance[-1] + vehicle.bodies["wheelset_1"].x > 39.2
    force = run.force[run.time > 1.0][..., 2]
    np.testing.assert_allclose(force, np.broadcast_to(force[0], force.shape), rtol=0.03)


def test_rows_of_a_braking_vehicle_are_as_good_as_its_steps() -> None:
    """Steps end at the rows: creep forces of interpolated rates at low speed were wrong by some kN."""
    brakes = on_all(LoadTable(((0.5, 0.0), (1.0, 8e3))), brake=True)
    dynamics = VehicleDynamics(free(), Track(), wheel_on_rail(), 6.0, loads=brakes)
    run = simulate(dynamics, (0.0, 60.0), recording=Recording(0.1))
    np.testing.assert_array_equal(run.time, 0.1 * np.arange(len(run)))
    late, share = run.time > 3.0, 4 * WHEEL / 0.46**2 / dynamics.mass.sum()
    force = run.force[late][..., 0].sum(axis=2)
    np.testing.assert_allclose(force, -8e3 / 0.46 / (1 + share), rtol=3e-3)
    assert run.speeds[late].min() < 0.3


def test_a_free_run_ends_at_its_distance() -> None:
    dynamics = VehicleDynamics(free(), Track(), LinearCreep(), 20.0, loads=on_all(4e3))
    run = simulate(dynamics, (0.0, 100.0), until=100.0)
    assert run.status == "completed"
    assert run.distance[-2] < 100.0 <= run.distance[-1] < 140.0
    slow = simulate(replace(dynamics, speed=20.0, loads=AppliedLoads()), (0.0, 1.0))
    np.testing.assert_allclose(slow.speeds, 20.0, rtol=1e-5)  # coasts


def test_energy_balance_of_a_run_with_motors_brakes_and_wind() -> None:
    forces = (BodyForce("car_body", (2.0, 0.5, 2.0), -4e3, LoadTable(((0.1, 0.0), (0.35, 8e3))), 2e3),)
    motors = tuple(WheelsetTorque(name, LoadTable(((0.05, 0.0), (0.45, 3e3)))) for name in NAMES[:2])
    brakes = tuple(
        WheelsetTorque(name, LoadTable(((0.25, 0.0), (0.75, 2e3))), "car_body", brake=True) for name in NAMES[2:]
    )
    track = Track.curve(curvature=1 / 500, cant=0.0, transition=7.5, length=25.0)
    dynamics = VehicleDynamics(free(), track, LinearCreep(), 20.0, loads=AppliedLoads((*motors, *brakes), forces))
    run = simulate(dynamics, (0.0, 1.0), steps=StepSettings("rosenbrock", 3e-5, 3e-8))
    assert run.status == "completed"
    energy = [mechanical_energy(dynamics, row.time, row.state) for row in run.rows]
    powers = np.array(
        [
            power(dynamics, row.time, row.state, np.concatenate([row.force, row.moment], axis=2).sum(axis=1))
            for row in run.rows
        ]
    )
    work = CubicSpline(run.time, powers).integrate(0.0, run.time[-1])
    assert energy[-1] - energy[0] == pytest.approx(work.sum(), abs=1e-3 * np.abs(work).max())
    assert np.abs(work[3]) > 1e4


def test_energy_of_random_states_changes_by_the_power_of_all_loads() -> None:
    level = Track.of([Segment("transition", 60.0), Segment("arc", 200.0, 1 / 300, 0.1)])
    dynamics = replace(in_a_transition(), track=level)
    c = dynamics.coordinates.count
    for time, state, wrenches in samples(dynamics):
        rate = np.concatenate([state[c : 2 * c], dynamics.accelerations(time, state, wrenches).rates])
        h = 3e-6
        after, before = (mechanical_energy(dynamics, time + d, state + d * rate) for d in (h, -h))
        powers = power(dynamics, time, state, wrenches)
        assert (after - before) / (2 * h) == pytest.approx(sum(powers), abs=3e-8 * sum(map(abs, powers)))
        assert abs(powers.applied) > 1e3


def test_a_resumed_run_is_the_same_bit_for_bit() -> None:
    """From every checkpoint, also before and behind kinks."""
    loads = on_all(LoadTable(((0.103, 0.0), (0.25, -6e3))))
    dynamics = VehicleDynamics(
        free(), Track.curve(curvature=1 / 500, transition=10.0, length=20.0), LinearCreep(), 25.0, loads=loads
    )
    written: list[Checkpoint] = []
    whole = simulate(dynamics, (0.0, 0.5), recording=Recording(checkpoints=Checkpoints(3, written.append)))
    assert len(written) > 3
    for start in written[1:]:
        kept = replace(start, rows=[row for row in whole.rows if row.time <= start.time])
        again = simulate(dynamics, (0.0, 0.5), recording=Recording(checkpoints=Checkpoints(3, lambda at: None, kept)))
        np.testing.assert_array_equal(again.time, whole.time)
        np.testing.assert_array_equal(again.state, whole.state)


def test_mirrored_run() -> None:
    sign, runs = np.tile([1.0, -1.0, 1.0, -1.0, 1.0, -1.0], 14), []
    for side in (1.0, -1.0):
        wind = BodyForce("car_body", (1.0, 0.0, 2.0), lateral=LoadTable(((0.05, 0.0), (0.1, side * 1e4))))
        loads = replace(on_all(LoadTable(((0.1, 0.0), (0.2, 9e3))), brake=True), forces=(wind,))
        track = Track.curve(curvature=side / 500, cant=0.06, transition=15.0, length=50.0)
        runs.append(simulate(VehicleDynamics(free(), track, wheel_on_rail(), 25.0, loads=loads), (0.0, 0.3)))
    left, right = runs
    assert left.status == right.status == "completed"
    np.testing.assert_array_equal(right.time, left.time)
    np.testing.assert_array_equal(right.state, sign * left.state)
    assert np.abs(left.state[-1, 1]) > 1e-4


def test_free_run_on_irregular_rails_follows_them_where_it_is() -> None:
    """The same run from a reference that is slower by half, with hardly more steps."""
    rails = ERRI["low"].irregularities(80.0, seed=1, start=10.78)
    dynamics = VehicleDynamics(free(), Track(irregularities=rails), wheel_on_rail(), 20.0, loads=on_all(-2e3))
    start = start_state(dynamics)
    slow, c = replace(dynamics, speed=10.0), dynamics.coordinates.count
    drift = start.copy()
    drift[np.add(c, [dynamics.coordinates.index(name, X) for name in dynamics.vehicle.names])] += 10.0
    drift[np.add(c, [dynamics.coordinates.index(name, PITCH) for name in NAMES])] += 10.0 / 0.46
    steps = StepSettings("rosenbrock", 1e-3, 1e-5)
    one = simulate(dynamics, (0.0, 0.8), initial=start, steps=steps, recording=Recording(0.01))
    two = simulate(slow, (0.0, 0.8), initial=drift, steps=steps, recording=Recording(0.01))
    assert one.status == two.status == "completed"
    assert two.cost.steps.accepted < 1.1 * one.cost.steps.accepted
    np.testing.assert_allclose(two.distance, one.distance, rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(two.motion.position[..., Z], one.motion.position[..., Z], rtol=0.0, atol=2e-5)


def test_jacobian_has_the_slope_of_irregular_rails_by_place_and_time() -> None:
    rails = ERRI["high"].irregularities(80.0, seed=1, start=10.78)
    dynamics = VehicleDynamics(free(), Track(irregularities=rails), wheel_on_rail(friction=0.0), 20.0)
    state, time, h = start_state(dynamics), 1.0, 1e-5
    at = dynamics(time, state)
    linear = VehicleJacobian(dynamics, StepStatistics())(time, state, at)
    for name in NAMES:
        step = np.zeros_like(state)
        step[dynamics.coordinates.index(name, X)] = h
        change = dynamics(time, state + step, at).rate - dynamics(time, state - step, at).rate
        expected = change / (2 * h)
        np.testing.assert_allclose(linear.by_state @ step / h, expected, rtol=0.0, atol=1e-3 * np.abs(expected).max())
    change = dynamics(time + h, state, at).rate - dynamics(time - h, state, at).rate
    expected = change / (2 * h)
    np.testing.assert_allclose(linear.by_time, expected, rtol=0.0, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("loads", "message"),
    [
        (AppliedLoads((WheelsetTorque("axle", 1.0),)), r"torque\.0\.wheelset: must be one of wheelset_1, "),
        (AppliedLoads((WheelsetTorque("car_body", 1.0),)), r"torque\.0\.wheelset: must be one of wheelset_1, "),
        (
            AppliedLoads((WheelsetTorque("wheelset_1", 1.0, "wheelset_2"),)),
            r"reaction: must be one of car_body, .*no wh",
        ),
        (AppliedLoads((WheelsetTorque("wheelset_1", -1.0, brake=True),)), "of a friction brake must not be negative"),
        (AppliedLoads(forces=(BodyForce("engine", (0.0, 0.0, 1.0)),)), r"force\.0\.body: must be one of car_body, "),
        (AppliedLoads(forces=(BodyForce("car_body", (0.0, np.nan, 1.0)),)), r"force\.0\.point: must be three finite"),
    ],
)
def test_loads_that_do_not_fit(loads: AppliedLoads, message: str) -> None:
    with pytest.raises(InvalidVehicle, match=message):
        VehicleDynamics(manchester(), Track(), LinearCreep(), 30.0, loads=loads)


@pytest.mark.parametrize("points", [(), ((0.0, np.inf),), ((1.0, 2.0), (1.0, 3.0)), ((0.0,),)])
def test_wrong_tables(points: tuple[tuple[float, float], ...]) -> None:
    with pytest.raises(ValueError, match="must"):
        LoadTable(points)


def test_a_reaction_is_required_below_two_bodies() -> None:
    vehicle = manchester()
    primary = vehicle.elements["primary_1_1"]
    both = replace(vehicle, elements=vehicle.elements | {"other": replace(primary, upper="car_body")})
    with pytest.raises(
        InvalidVehicle, match=r"torque\.0\.reaction: required, as elements join wheelset_1 to car_body and"
    ):
        VehicleDynamics(both, Track(), LinearCreep(), 30.0, loads=AppliedLoads((WheelsetTorque("wheelset_1", 1.0),)))
