"""Contact by a table with a border: weights by their closed form, derivatives by differences, limits inside and out."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
from plane import mirror_signs
from standard_pair import MOUNTING, wheel_on_rail
from test_force_table import STATE, built

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.table.tabulated import TabulatedContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

ELASTIC = wheel_on_rail()
COLUMNS = {"y": 1e-8, "z": 1e-9, "roll": 1e-8, "yaw": 1e-7, "y_rate": 1e-5, "yaw_rate": 1e-5, "pitch_rate": 1e-5}


def tabulated() -> WheelsetContact:
    return WheelsetContact(TabulatedContact(built()[0], ELASTIC.model), MOUNTING)


def wrench(result: ContactResult) -> Array:
    return np.concatenate([result.force, result.moment])


def on_the_rail(y: float, roll: float = 0.0, yaw: float = 0.0, deeper: float = 0.0) -> WheelsetState:
    """State whose left tread is at a place, m deeper than under 60 kN."""
    state = replace(STATE, y=y - MOUNTING.radius * roll, roll=roll, yaw=yaw)
    found = wheel_under_load(ELASTIC, state, "left", 60e3, expected=1e-4).state
    return replace(found, z=found.z - deeper)


def share(state: WheelsetState, side: Side = "left") -> float:
    own = state if side == "left" else state.mirrored()
    pose, motion = MOUNTING.left_pair(own)
    return tabulated().model.inside.table.force(pose, motion).share  # type: ignore[attr-defined, no-any-return]


def smooth(inwards: float, width: float) -> float:
    u = min(max(inwards / width, 0.0), 1.0)
    return float(3.0 * u**2 - 2.0 * u**3)


@pytest.mark.parametrize("seed", range(8))
def test_weights_are_products_of_cubics(seed: int) -> None:
    random = np.random.default_rng(seed)
    y, roll, yaw = random.uniform(-1.0, 1.0, 3) * [1.0e-3, 5e-4, 2e-3]
    state = on_the_rail(y, roll, yaw, random.uniform(0.0, 8e-5))
    pose, motion = MOUNTING.left_pair(state)
    force = built()[0].force(pose, motion)
    expected = smooth(1e-3 - abs(force.position[0]), 5e-4) * smooth(5e-4 - abs(force.position[1]), 5e-5)
    expected *= smooth(2e-3 - abs(force.position[2]), 2e-4)
    top = 90e3 ** (2 / 3)
    expected *= smooth(top - max(force.level, 0.0), top * (1.0 - 0.9 ** (2 / 3)))
    assert share(state) == pytest.approx(expected, abs=1e-12)


def test_inside_is_the_table_and_outside_the_elastic_contact() -> None:
    inside, outside, guess = on_the_rail(1e-4), on_the_rail(1.2e-3), ContactResult.guess("a warm start")
    assert (share(inside), share(outside)) == (1.0, 0.0)
    found = tabulated()(inside, "left", guess)
    pose, motion = MOUNTING.left_pair(inside)
    about = found.moment + np.cross(motion.wheel.reference, found.force)
    expected = built()[0].force(pose, motion).values
    assert np.array_equal(found.force, expected[:3])
    assert about == pytest.approx(expected[3:], rel=1e-12)
    assert found.warm_start == "a warm start"
    assert np.array_equal(wrench(tabulated()(outside, "left")), wrench(ELASTIC(outside, "left")))


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("seed", range(4))
def test_derivatives_in_the_border_are_those_of_differences(side: Side, seed: int) -> None:
    random = np.random.default_rng(seed)
    state = on_the_rail(random.choice([-1.0, 1.0]) * random.uniform(0.6e-3, 0.9e-3), 1e-4, 5e-4)
    state = state if side == "left" else state.mirrored()
    assert 0.0 < share(state, side) < 1.0
    contact = tabulated()
    found = contact(state, side)
    tangent, scale = contact.tangent(state, side, found), np.abs(wrench(found)).max()
    for name, step in COLUMNS.items():
        ends = [wrench(contact(replace(state, **{name: getattr(state, name) + way * step}), side)) for way in (1, -1)]
        change = (ends[0] - ends[1]) / (2.0 * step)
        own = tangent[:, WheelsetState.coordinates.index(name)]
        assert np.abs(own - change).max() < 2e-4 * max(np.abs(change).max(), 0.01 * scale / step * 1e-4), name


def test_the_force_is_continuous_from_the_table_to_the_elastic_contact() -> None:
    middle = on_the_rail(0.75e-3)
    states = [replace(middle, y=float(y)) for y in np.arange(0.4e-3, 1.1e-3, 5e-6)]
    forces = {c: np.array([c(state, "left").force for state in states]) for c in (tabulated(), ELASTIC)}
    own, elastic = (np.abs(np.diff(force, 2, axis=0)).max() / force[:, 2].max() for force in forces.values())
    assert own < max(1.5 * elastic, 5e-5)


def test_mirror_images_are_equal_to_the_last_bit() -> None:
    state = on_the_rail(0.8e-3, 2e-4, 1e-3)
    left, right = tabulated()(state, "left"), tabulated()(state.mirrored(), "right")
    assert np.array_equal(left.force * [1, -1, 1], right.force)
    assert np.array_equal(left.moment * [-1, 1, -1], right.moment)


@pytest.mark.parametrize("side", ["left", "right"])
def test_wheels_of_a_side_together_are_single_wheels(side: Side) -> None:
    """Inside, in the border, outside and without contact."""
    random, lifted = np.random.default_rng(3), replace(STATE, z=1e-3)
    states = [on_the_rail(y, *random.uniform(-3e-4, 3e-4, 2)) for y in (-2e-4, 3e-4, 0.8e-3, 1.4e-3)]
    states = [state if side == "left" else state.mirrored() for state in [*states, lifted]]
    contact, guess = tabulated(), ContactResult.guess("a warm start")
    together = contact.solve_side(states, side, [guess] * len(states))
    tangents = contact.side_tangents(states, side, together)
    for state, own, tangent in zip(states, together, tangents, strict=True):
        single = contact(state, side, guess)
        assert (own.status, own.approach, own.warm_start) == (single.status, single.approach, single.warm_start)
        assert wrench(own) == pytest.approx(wrench(single), rel=1e-11, abs=1e-9)
        expected = contact.tangent(state, side, single)
        assert np.abs(tangent - expected).max() <= 1e-9 * np.abs(expected).max()
        assert np.array_equal(own.tangent(), single.tangent())
        for a, b in zip(own.patches, single.patches, strict=True):
            assert (a.x, a.rail_y, a.contact_angle) == pytest.approx((b.x, b.rail_y, b.contact_angle), rel=1e-12)
            assert np.allclose(a.force, b.force)
    assert together[-1].status == "separated"
    mirrored: Side = "right" if side == "left" else "left"
    others = contact.solve_side([state.mirrored() for state in states], mirrored, [None] * len(states))
    for own, other in zip(together, others, strict=True):
        assert np.array_equal(own.force * [1, -1, 1], other.force)
        assert np.array_equal(own.moment * [-1, 1, -1], other.moment)


def into_a_curve(contact: WheelsetContact, curvature: float, checkpoints: Checkpoints | None = None) -> History:
    track = Track.curve(curvature=curvature, cant=0.06, transition=15.0, length=50.0)
    dynamics = wagon_dynamics(Wagon(), track, contact, 45.0)
    steps = StepSettings("rosenbrock", 3e-3, 3e-6)
    return simulate(dynamics, (0.0, 0.35), steps=steps, recording=Recording(checkpoints=checkpoints))


def test_runs_from_the_table_to_the_elastic_contact() -> None:
    """Beyond 1 mm; mirrored and resumed runs are the same to the last bit."""
    written = list[Checkpoint]()
    left = into_a_curve(tabulated(), 1 / 600, Checkpoints(4, lambda at: written.append(deepcopy(at))))
    right, elastic = into_a_curve(tabulated(), -1 / 600), into_a_curve(ELASTIC, 1 / 600)
    assert left.status == "completed"
    y = np.abs(left.coordinate("wheelset", 1))
    assert y[0] < 5e-4
    assert y[-1] > 1.2e-3
    assert left.coordinate("wheelset", 1)[-1] == pytest.approx(elastic.coordinate("wheelset", 1)[-1], abs=3e-5)
    np.testing.assert_array_equal(right.state, mirror_signs(left.dynamics.coordinates) * left.state)
    for at in written[1:3]:
        again = into_a_curve(tabulated(), 1 / 600, Checkpoints(4, lambda _: None, at))
        np.testing.assert_array_equal(again.state, left.state)
        np.testing.assert_array_equal(again.force, left.force)
