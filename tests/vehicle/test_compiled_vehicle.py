"""Compiled equations of motion of a vehicle: elements, exact derivatives, constraints and mirror images.

Accelerations: tests/bindings.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from linear_creep import LinearCreep
from newton_euler import accelerations
from numpy_vehicle import NumpySuspension, kinematics
from random_states import dynamics_of

from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import ROLL, YAW, Y
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.vehicle import Vehicle
from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track


@cache
def manchester() -> Vehicle:
    return load_vehicle()


def samples(dynamics: VehicleDynamics) -> list[tuple[float, Array, Array]]:
    """Times, random states and contact forces."""
    random, c, size = np.random.default_rng(5), dynamics.coordinates.count, dynamics.size
    scale = np.concatenate([np.full(c, 1e-2), np.full(c, 0.1), np.full(size - 2 * c, 1e-3)])
    wheelsets = len(dynamics.vehicle.wheelsets)
    return [(t, scale * random.normal(size=size), 1e4 * random.normal(size=(wheelsets, 6))) for t in (0.3, 1.0, 1.8)]


KINDS = ("as it is", "turned in part", "Maxwell elements", "laws", "friction", "rods, bushings, surge")


@pytest.mark.parametrize("speed", [64, SpeedProfile.through((0, 1), (64, 64))], ids=["number", "profile"])
def test_a_speed_of_whole_numbers_is_that_of_decimals(speed: float | SpeedProfile) -> None:
    """A whole speed was refused before."""
    whole = VehicleDynamics(manchester(), Track(), LinearCreep(), speed)
    for time, state, wrenches in samples(whole):
        expected = replace(whole, speed=64.0).accelerations(time, state, wrenches).rates
        np.testing.assert_array_equal(whole.accelerations(time, state, wrenches).rates, expected)


@pytest.mark.parametrize("kind", KINDS)
def test_elements_of_many_rows_are_those_in_numpy(kind: str) -> None:
    dynamics = dynamics_of(kind)
    times, states, _ = zip(*samples(dynamics), strict=True)
    travels = [dynamics.speed_profile(time) for time in times]
    deflection, force = dynamics.bodies.element_states(travels, np.array(states))
    for i, (travel, state) in enumerate(zip(travels, states, strict=True)):
        expected = NumpySuspension(dynamics.suspension)(
            kinematics(dynamics)(travel, state), dynamics.coordinates.split(state).series
        )
        np.testing.assert_allclose(deflection[i], expected.deflection, rtol=0.0, atol=1e-13)
        largest = np.abs(expected.element_force).max()
        np.testing.assert_allclose(force[i], expected.element_force, rtol=0.0, atol=1e-12 * largest)


@pytest.mark.parametrize("kind", KINDS)
def test_derivatives_are_those_of_differences(kind: str) -> None:
    """Central differences, whose error is some 1e-8 of the largest derivatives."""
    dynamics, step, unit = dynamics_of(kind), 1e-6, 1e3
    size, c = dynamics.size, dynamics.coordinates.count
    for time, state, wrenches in samples(dynamics)[1:2]:
        travel, (_, _, jerk) = dynamics.speed_profile(time), dynamics.speed_profile.speeds(time)
        actual = dynamics.bodies.derivatives(travel, jerk, state, wrenches)
        steps = step * np.eye(size)
        plus, minus = (accelerations(dynamics, time, state + s, wrenches) for s in (steps, -steps))
        by_state = (plus - minus).T / (2 * step)
        by_state[:, dynamics.coordinates.slider_components] = 0.0  # they move at ends of steps only
        np.testing.assert_allclose(actual.by_state, by_state, rtol=0.0, atol=1e-7 * np.abs(by_state).max())
        plus, minus = (accelerations(dynamics, time + h, state, wrenches) for h in (1e-5, -1e-5))
        by_time = (plus - minus) / 2e-5
        np.testing.assert_allclose(actual.by_time, by_time, rtol=0.0, atol=1e-6 * np.abs(by_time).max())
        loads = unit * np.eye(6)[:, None, :]
        plus, minus = (accelerations(dynamics, time, np.tile(state, (6, 1)), wrenches + s) for s in (loads, -loads))
        by_wrench = (plus - minus)[:, :c] / (2 * unit)
        np.testing.assert_allclose(actual.by_wrench, by_wrench, rtol=0.0, atol=1e-10 * np.abs(by_wrench).max())


def test_derivatives_of_a_vehicle_with_held_coordinates() -> None:
    """By differences of the compiled accelerations, in a transition."""
    free = dynamics_of("Maxwell elements")
    held = {"front_bogie": ("roll", "pitch"), "wheelset_1": ("y", "yaw"), "wheelset_2": ("x", "pitch")}
    bodies = {name: replace(body, held=held.get(name, ())) for name, body in free.vehicle.bodies.items()}
    dynamics, step = replace(free, vehicle=replace(free.vehicle, bodies=bodies)), 1e-6
    time, state, wrenches = samples(dynamics)[1]
    travel, (_, _, jerk) = dynamics.speed_profile(time), dynamics.speed_profile.speeds(time)
    actual = dynamics.bodies.derivatives(travel, jerk, state, wrenches)
    steps = step * np.eye(dynamics.size)
    plus, minus = (
        np.array([dynamics.accelerations(time, state + s, wrenches).rates for s in sign * steps]) for sign in (1, -1)
    )
    by_state = (plus - minus).T / (2 * step)
    np.testing.assert_allclose(actual.by_state, by_state, rtol=0.0, atol=1e-7 * np.abs(by_state).max())
    plus, minus = (dynamics.accelerations(time + h, state, wrenches).rates for h in (1e-5, -1e-5))
    by_time = (plus - minus) / 2e-5
    np.testing.assert_allclose(actual.by_time, by_time, rtol=0.0, atol=1e-6 * np.abs(by_time).max())


def test_derivatives_at_rest_have_no_error_of_differences() -> None:
    """At the nominal position linear springs give the same stiffness between both bogies and the car body."""
    dynamics = VehicleDynamics(manchester(), Track(), LinearCreep(), 30.0)
    wrenches, c = np.zeros((4, 6)), dynamics.coordinates.count
    matrix = dynamics.bodies.derivatives(dynamics.speed_profile(0.0), 0.0, np.zeros(dynamics.size), wrenches).by_state
    body, front = dynamics.coordinates.index("car_body", 2), dynamics.coordinates.index("front_bogie", 2)
    stiffness = 2 * 430e3  # N/m, of the secondary springs of a bogie
    assert matrix[body, body] == pytest.approx(-2 * stiffness / 32000.0, rel=1e-12)
    assert matrix[front, body] == pytest.approx(stiffness / 2615.0, rel=1e-12)
    assert matrix[body, c + body] == pytest.approx(-2 * 2 * 20e3 / 32000.0, rel=1e-12)


def test_elements_at_both_sides_are_pairs() -> None:
    pairs = np.array(manchester().mirror_pairs)
    elements = list(manchester().elements.values())
    assert sorted(pairs[pairs >= 0].tolist()) == list(range(len(elements)))
    for left, right in pairs.tolist():
        x, y, z = elements[left].point
        assert right < 0 if y == 0.0 else elements[right].point == (x, -y, z)


def test_reactions_hold_the_coordinates() -> None:
    """Applied as a force and a moment on the same wheelset without constraints, on straight track."""
    free = VehicleDynamics(manchester(), Track(), LinearCreep(), 30.0)
    wheelset = replace(manchester().bodies["wheelset_1"], held=("y", "yaw"))
    bodies = manchester().bodies | {"wheelset_1": wheelset}
    held = replace(free, vehicle=replace(manchester(), bodies=bodies))
    time, state, wrenches = samples(free)[0]
    y, yaw = (free.coordinates.index("wheelset_1", k) for k in (Y, YAW))
    c, roll = free.coordinates.count, state[free.coordinates.index("wheelset_1", ROLL)]
    state[[y, yaw, c + y, c + yaw]] = 0.0
    expected, reactions = held.accelerations(time, np.delete(state, [y, yaw, c + y, c + yaw]), wrenches)
    force, moment = reactions[held.coordinates.wheelset_bodies[0], [Y, YAW]]
    wrenches[0, 1] += force
    wrenches[0, 3:] += moment / np.cos(roll) * np.array([0.0, -np.sin(roll), np.cos(roll)])  # about its own vertical
    found = free.accelerations(time, state, wrenches).rates
    scale = np.abs(found).max()
    np.testing.assert_allclose(found[[y, yaw]], 0.0, atol=1e-11 * scale)
    np.testing.assert_allclose(np.delete(found, [y, yaw]), expected, rtol=0.0, atol=1e-11 * scale)
    assert abs(force) > 1e3


def test_mirrored_motion_has_mirrored_accelerations_bit_for_bit() -> None:
    """In a curve to the right instead of to the left."""
    odd = np.isin(np.arange(6), (Y, ROLL, YAW))
    sign = np.where(np.tile(odd, 14), -1.0, 1.0)
    left, right = (
        VehicleDynamics(manchester(), Track.of([Segment("arc", 200.0, k, 0.1)]), LinearCreep(), 30.0)
        for k in (1 / 600, -1 / 600)
    )
    time, state, wrenches = samples(left)[0]
    mirrored = wrenches * [1.0, -1.0, 1.0, -1.0, 1.0, -1.0]
    expected = left.accelerations(time, state, wrenches).rates
    np.testing.assert_array_equal(right.accelerations(time, sign * state, mirrored).rates, sign[:42] * expected)
    travel = left.speed_profile(time)
    there = left.bodies.derivatives(travel, 0.0, state, wrenches)
    here = right.bodies.derivatives(travel, 0.0, sign * state, mirrored)
    np.testing.assert_array_equal(here.by_state, sign[:42, None] * there.by_state * sign)
    np.testing.assert_array_equal(here.by_time, sign[:42] * there.by_time)
