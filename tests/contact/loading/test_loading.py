"""Depth for a load: against closed forms, number of solves, and errors where there is no solution."""

from __future__ import annotations

import os
import signal
from dataclasses import replace

import numpy as np
import pytest
from spring_contact import SpringContact

from wheelrail.bindings._contact import JUMP, RTOL, LoweredWheelset, sphere_approach
from wheelrail.contact.kinematics.frames import RigidMotion, Side, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.loading.hertz import hertz_under_load
from wheelrail.contact.loading.load_search import LoadError, Results, find_depth_for_load
from wheelrail.contact.loading.two_wheels import find_depths_for_loads
from wheelrail.contact.loading.wheelset import axle_under_load, wheel_under_load, wheels_under_load, wheelset_at_state
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.interrupts import deferred_interrupts

STILL = RigidMotion(*(Twist(np.zeros(3), np.zeros(3), np.zeros(3)),) * 2)
MOUNTING = Mounting(wheel_y=0.75, rail_y=0.76, radius=0.46)
STIFFNESS = 1e11


def pushed(force: float, approach: float) -> tuple[ContactResult, ...]:
    if force <= 0.0:
        return (ContactResult.separated(approach),)
    return (ContactResult(np.array([0.0, 0.0, force]), np.zeros(3), approach=approach, status="converged"),)


def test_ctrl_c_ends_a_search_after_the_present_solve() -> None:
    depths: list[float] = []

    def contact(depth: float, _: object) -> tuple[ContactResult, ...]:
        depths.append(depth)
        os.kill(os.getpid(), signal.SIGINT)
        return pushed(STIFFNESS * depth**1.5, depth)

    with pytest.raises(KeyboardInterrupt), deferred_interrupts():
        find_depth_for_load(contact, 10e3, expected=1e-5, start=1e-5, rtol=RTOL)
    assert len(depths) == 1


def test_sphere_approach_is_that_of_hertz() -> None:
    # Closed form: F = 4/3 E* sqrt(R) d^1.5 with the contact modulus E*.
    modulus = 2.1e11 / (2.0 * (1.0 - 0.3**2))
    depth = sphere_approach(57e3, 0.3, modulus)
    force = 4.0 / 3.0 * modulus * np.sqrt(0.3) * depth**1.5
    assert force == pytest.approx(57e3, rel=1e-12)


@pytest.mark.parametrize("load", [1.0, 10e3, 57e3, 1e6])
def test_hertz_depth_is_exact_in_few_solves(load: float) -> None:
    model = SpringContact(stiffness=STIFFNESS)
    exact = (load / STIFFNESS) ** (2.0 / 3.0)
    found = hertz_under_load(model, STILL, load, expected=1.7 * exact)
    assert found.depth == pytest.approx(exact, rel=1e-9)
    assert found.error <= 1e-9
    assert found.trials == len(model.calls) <= 3  # F^(2/3) is a straight line here


def test_each_solve_starts_from_the_previous_result() -> None:
    model = SpringContact(stiffness=STIFFNESS)
    hertz_under_load(model, STILL, 20e3, expected=1e-5)
    assert model.calls[0] is None
    assert all(isinstance(guess, ContactResult) for guess in model.calls[1:])


@pytest.mark.parametrize("start", [-5e-3, -1e-4, 0.0, 2e-4, 3e-4])
@pytest.mark.parametrize("knows_gap", [True, False])
def test_start_above_or_below_the_solution(start: float, knows_gap: bool) -> None:
    touch, solves = 1.82e-4, 0

    def contact(depth: float, guess: object) -> tuple[ContactResult, ...]:
        nonlocal solves
        solves += 1
        overlap = depth - touch
        return pushed(STIFFNESS * max(overlap, 0.0) ** 1.5, overlap if knows_gap or overlap > 0.0 else 0.0)

    found = find_depth_for_load(contact, 57e3, expected=1e-4, start=start)
    assert found.depth == pytest.approx(touch + (57e3 / STIFFNESS) ** (2.0 / 3.0), rel=1e-8)
    assert solves <= (5 if knows_gap else 14)


def test_penalty_and_second_patch_do_not_slow_it_down() -> None:
    """Linear start (penalty), power 1.5 later, and a stiffer second patch from 40 micrometres on."""

    def force(depth: float) -> float:
        one = STIFFNESS * depth**1.5 / (1.0 + 2e-6 / max(depth, 1e-9))
        return one + 3.0 * STIFFNESS * max(depth - 4e-5, 0.0) ** 1.5

    found = find_depth_for_load(lambda d, _: pushed(force(max(d, 0.0)), d), 80e3, expected=6e-5)
    assert force(found.depth) == pytest.approx(80e3, rel=1e-9)
    assert found.trials <= 8


@pytest.mark.parametrize(("on_strips", "within"), [(True, 10.0), (False, 20.0)])
def test_a_soft_flange_does_not_lead_strips_deep_into_the_next_contact(on_strips: bool, within: float) -> None:
    """A flange that carries a third of the load at 6.4 mm, where the tread begins to touch, as stiff as Hertz's.

    Where deep solves cost no more, steps are in proportion to the overlap, and fewer.
    """
    load, forces = 184e3, [0.0]

    def force(depth: float) -> float:
        return (2.5e5 * max(depth, 0.0)) ** 1.5 + (1.9e7 * max(depth - 6.4e-3, 0.0)) ** 1.5

    def solve(_side: int, z: float, _roll: float, _earlier: object) -> ContactResult:
        forces.append(force(-z))
        return pushed(forces[-1], -0.4 * z)[0]

    def overlap(_side: int, z: float, _roll: float) -> float:
        return -0.4 * z

    wheels = LoweredWheelset(0.0, 0.0, 0.75, solve, overlap, [on_strips] * 2, solve, [False] * 2)
    z, *_ = wheels.under_load([0], load, 1.7e-4, RTOL)
    assert force(-z) == pytest.approx(load, rel=1e-9)
    assert max(forces) < within * load
    assert len(forces) <= (26 if on_strips else 16)


def test_search_ends_despite_contact_noise() -> None:
    noise = np.random.default_rng(1)

    def contact(depth: float, guess: object) -> tuple[ContactResult, ...]:
        return pushed(STIFFNESS * max(depth, 0.0) ** 1.5 * (1.0 + 1e-8 * noise.standard_normal()), depth)

    found = find_depth_for_load(contact, 57e3, expected=5e-5)
    assert found.error < 1e-7
    assert found.trials <= 12


def test_a_model_that_fails_when_too_deep_is_approached_from_above() -> None:
    model = SpringContact(stiffness=STIFFNESS, deepest=1.2e-4)
    found = hertz_under_load(model, STILL, 57e3, expected=8e-4)
    assert found.depth == pytest.approx((57e3 / STIFFNESS) ** (2.0 / 3.0), rel=1e-9)


def test_failure_names_the_reason() -> None:
    model = SpringContact(stiffness=STIFFNESS, deepest=1e-5)  # fails before it can carry the load
    for rtol in (RTOL, 0.02):
        with pytest.raises(LoadError, match="off the mesh"):
            hertz_under_load(model, STILL, 57e3, expected=5e-5, rtol=rtol)


def test_a_force_that_jumps_over_the_load_is_an_error() -> None:
    with pytest.raises(LoadError, match="jumps over"):
        find_depth_for_load(lambda d, _: pushed(40e3 if d < 5e-5 else 70e3, max(d, 1e-6)), 57e3, expected=5e-5)


def test_a_load_out_of_reach_is_an_error() -> None:
    with pytest.raises(LoadError, match="not reached"):
        find_depth_for_load(lambda d, _: pushed(0.0, 0.0), 57e3, expected=5e-5, deepest=0.01)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("roll", [0.0, 2e-3, -2e-3])
def test_wheel_under_load(side: Side, roll: float) -> None:
    model = SpringContact(touch=0.46 - 1.8e-4, stiffness=STIFFNESS)
    seat = wheel_under_load(WheelsetContact(model, MOUNTING), WheelsetState(roll=roll), side, 57e3, expected=8e-5)
    up = 0.75 * np.sin(roll) * (1.0 if side == "left" else -1.0)
    assert seat.state.z == pytest.approx(-1.8e-4 - (57e3 / STIFFNESS) ** (2.0 / 3.0) - up, abs=1e-12)
    assert seat.results[side].force[2] == pytest.approx(57e3, rel=1e-9)
    assert list(seat.results) == [side]
    assert seat.solves == len(model.calls)


def test_axle_under_load_with_roll_has_unequal_wheel_loads() -> None:
    model = SpringContact(touch=0.46, stiffness=STIFFNESS)
    seat = axle_under_load(WheelsetContact(model, MOUNTING), WheelsetState(roll=2e-5), 114e3, expected=8e-5)
    left, right = (seat.results[side].force[2] for side in ("left", "right"))
    assert left + right == pytest.approx(114e3, rel=1e-9)
    assert left < right  # a positive roll lifts the left wheel
    assert seat.solves == len(model.calls) <= 14


def test_wheels_under_load_find_height_and_roll() -> None:
    """Left wheel 0.3 mm lower: the height is the mean, the roll half the difference over the base."""

    class Uneven(SpringContact):
        def __call__(self, pose, motion, guess):  # type: ignore[no-untyped-def]
            # Only the mirrored right wheel has a positive lateral offset of the wheelset here.
            self.touch = 0.46 - (3e-4 if pose.origin[1] < -0.01 else 0.0)
            return super().__call__(pose, motion, guess)

    model = Uneven(stiffness=STIFFNESS)
    state = WheelsetState(y=-0.003, speed=45.0)
    seat = wheels_under_load(WheelsetContact(model, MOUNTING), state, 57e3, expected=8e-5)
    for side in ("left", "right"):
        assert seat.results[side].force[2] == pytest.approx(57e3, rel=1e-9)
    assert np.sin(seat.state.roll) == pytest.approx(-3e-4 / (2 * 0.75), rel=1e-6)
    assert seat.state.z == pytest.approx(-1.5e-4 - (57e3 / STIFFNESS) ** (2.0 / 3.0), abs=1e-9)
    assert (seat.state.y, seat.state.speed) == (state.y, state.speed)
    assert seat.solves == len(model.calls) <= 20


def test_balance_solves_a_coupled_pair_superlinearly() -> None:
    """A fifth of each depth acts on the other wheel; against the linear solution in F^(2/3)."""
    mix = np.array([[1.0, 0.2], [0.15, 1.1]])
    loads = np.array([57e3, 40e3])

    def contact(depths: np.ndarray, guess: object) -> tuple[ContactResult, ...]:
        overlaps = mix @ depths
        return tuple(pushed(STIFFNESS * max(o, 0.0) ** 1.5, o)[0] for o in overlaps)

    expected = np.linalg.solve(mix, (loads / STIFFNESS) ** (2.0 / 3.0))
    depths, results, trials = find_depths_for_loads(
        contact, loads, start=np.full(2, 4e-5), slopes=np.full(2, STIFFNESS ** (2.0 / 3.0))
    )
    assert depths == pytest.approx(expected, rel=1e-8)
    assert [r.force[2] for r in results] == pytest.approx(loads, rel=1e-9)
    assert trials <= 9


def test_balance_accepts_what_the_contact_does_not_resolve() -> None:
    """A force that changes by 2e-7 with the guess, as that of an iteration with its own tolerance does."""
    loads = np.array([57e3, 57e3])

    def contact(depths: np.ndarray, guess: Results | None) -> tuple[ContactResult, ...]:
        from_near = guess is not None and abs(guess[0].force[2] / 57e3 - 1.0) < 1e-7
        error = 2e-7 if from_near else 0.0
        return tuple(pushed(STIFFNESS * d**1.5 * (1.0 + 100.0 * d - error), d)[0] for d in depths)

    _, results, trials = find_depths_for_loads(
        contact, loads, start=np.full(2, 4e-5), slopes=np.full(2, 1.01 * STIFFNESS ** (2.0 / 3.0)), rtol=1e-12
    )
    assert [r.force[2] for r in results] == pytest.approx(loads, rel=1e-6)
    assert trials <= 9


def test_wheelset_at_state_solves_each_side_once() -> None:
    model = SpringContact(touch=0.46, stiffness=STIFFNESS)
    seat = wheelset_at_state(WheelsetContact(model, MOUNTING), WheelsetState(z=-1e-4), ("right",))
    assert list(seat.results) == ["right"]
    assert len(model.calls) == 1
    assert seat.state == replace(seat.state, z=-1e-4)


def test_a_balance_within_its_tolerance_is_no_jump() -> None:
    """Loads of 5 to 80 N on axles and pads, first searched for within 1 %, ended as jumps of 0.2 to 0.9 %."""
    loads = np.array([57e3, 40e3])

    def contact(depths: np.ndarray, guess: object) -> tuple[ContactResult, ...]:
        return tuple(pushed(STIFFNESS * max(d, 0.0) ** 1.5, d)[0] for d in depths)

    slopes = np.full(2, 57e3 ** (2.0 / 3.0) / 6e-5)
    _, results, _ = find_depths_for_loads(
        contact, loads, start=np.array([-3e-5, 2e-5]), slopes=slopes, rtol=1e-2, max_trials=0
    )
    errors = np.array([r.force[2] for r in results]) / loads - 1.0
    assert np.abs(errors).max() < 1e-2
    assert np.abs(errors).max() > JUMP
