"""Traction and brake torques, drawbar and wind forces: equations, closed forms, limits of adhesion."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
from linear_creep import LinearCreep
from newton_euler import accelerations

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.loads import AppliedLoads, BodyForce, LoadTable, WheelsetTorque
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, X, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.track.alignment import Segment
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
