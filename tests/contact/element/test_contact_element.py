"""Accepted and trial states of a contact element, with a contact whose results depend on the initial guess."""

from __future__ import annotations

import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult, Statistics
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array

HIGH = 1e-3  # m, above which the sides are separated


@dataclass(frozen=True)
class HistoryContact(VehicleContact):
    """A contact whose force depends on all accepted states before it, and which fails in some places."""

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        if state.z > HIGH:
            return ContactResult.separated(HIGH - state.z)
        if state.yaw > 0.1:
            return ContactResult.failed("no convergence")
        if state.yaw < -0.1:
            raise FloatingPointError("overflow")
        if state.roll > 0.1:
            return ContactResult(np.array([0.0, 0.0, np.nan]), np.zeros(3), status="converged")
        before = 0.0 if guess is None or guess.warm_start is None else float(guess.warm_start)  # type: ignore[arg-type]
        memory = 0.3 * before + state.y + (0.1 if side == "left" else 0.2)
        force = np.array([memory, np.sin(memory), 1.0 - state.z])
        return ContactResult(
            force, 2 * force, approach=-state.z, status="converged", statistics=Statistics(newton=3), warm_start=memory
        )

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        total = np.zeros((6, len(state.coordinates)))
        total[0, state.coordinates.index("y")] = 1.0
        total[5, state.coordinates.index("yaw_rate")] = -2.0 if side == "left" else 2.0
        return total


def element() -> ContactElement[WheelsetState, Side]:
    return ContactElement(HistoryContact(), SIDES)


def path(trials: int) -> list[Array]:
    """Forces of 20 accepted states with a number of trial states before each, failed ones among them."""
    random = np.random.default_rng(0)
    contact, forces = element(), []
    for y in np.linspace(0.0, 1.0, 20).tolist():
        for place in random.normal(size=(trials, 3)) * 0.2:
            contact.solve_state(WheelsetState(y=place[0], yaw=place[1], roll=place[2]))
        solution = contact.solve_state(WheelsetState(y=y))
        contact.accept()
        forces += list(solution.force.values())
    return forces


def test_rejected_trials_leave_no_trace() -> None:
    assert [f.tobytes() for f in path(1000)] == [f.tobytes() for f in path(0)]
    assert path(0)[-1][0] > 1.4 * path(0)[0][0]  # the history is in the forces


def test_solves_start_from_the_accepted_state_only() -> None:
    contact, state = element(), WheelsetState(y=0.5)
    first = contact.solve_state(state).force["left"]
    assert contact.solve_state(state).force["left"].tobytes() == first.tobytes()
    contact.accept()
    later = contact.solve_state(state).force["left"]
    assert later[0] == pytest.approx(first[0] + 0.3 * first[0])
    contact.solve_state(replace(state, yaw=0.5))  # fails
    assert contact.solve_state(state).force["left"].tobytes() == later.tobytes()


def test_a_restored_state_repeats_the_solves_after_it() -> None:
    contact = element()
    for y in (0.1, 0.2, 0.3):
        contact.solve_state(WheelsetState(y=y))
        contact.accept()
    contact.solve_state(WheelsetState(y=9.0))  # not accepted
    stored = pickle.loads(pickle.dumps(contact.state()))

    def continued(later: ContactElement[WheelsetState, Side]) -> bytes:
        forces = []
        for y in (0.4, 0.5):
            forces.append(later.solve_state(WheelsetState(y=y)).force["right"])
            later.accept()
        return np.array(forces).tobytes()

    expected = continued(contact)
    for other in (contact, element()):
        other.restore(stored)
        with pytest.raises(ValueError, match="accept: no state has been solved"):
            other.accept()
        assert continued(other) == expected
    with pytest.raises(TypeError, match="must be given the state of an element, got dict"):
        contact.restore({})  # type: ignore[arg-type]
    single: ContactElement[WheelsetState, Side] = ContactElement(HistoryContact(), ("left",))
    with pytest.raises(ValueError, match="restore: must be a state of left, got left, right"):
        single.restore(stored)


@pytest.mark.parametrize(
    ("state", "text"),
    [
        (WheelsetState(yaw=0.2), "failed: left: no convergence; right: no convergence"),
        (WheelsetState(yaw=-0.2), "failed: left: FloatingPointError: overflow; right: FloatingPointError: overflow"),
        (
            WheelsetState(roll=0.2),
            "failed: left: force or moment is not finite; right: force or moment is not finite",
        ),
    ],
)
def test_a_failed_solve_is_a_status(state: WheelsetState, text: str) -> None:
    contact = element()
    contact.solve_state(WheelsetState(y=0.1))
    contact.accept()
    before = pickle.dumps(contact.state())
    solution = contact.solve_state(state)
    assert solution.status == text
    assert not solution.ok
    assert np.isnan(solution.force["left"]).all()
    assert np.isnan(solution.moment["right"]).all()
    for call in (contact.accept, contact.tangent, contact.patches):
        with pytest.raises(ValueError, match="the last solve failed: left"):
            call()
    assert pickle.dumps(contact.state()) == before


def test_values_of_a_solution() -> None:
    contact = element()
    solution = contact.solve_state(WheelsetState(y=0.5, z=-0.25))
    assert solution.status == "converged"
    assert solution.iterations == {"left": 3, "right": 3}
    assert solution.approach["left"] == 0.25
    np.testing.assert_array_equal(solution.moment["left"], 2 * solution.force["left"])
    assert contact.patches() == {"left": (), "right": ()}
    apart = contact.solve_state(WheelsetState(z=3e-3))
    assert (apart.status, apart.ok) == ("separated", True)
    assert not apart.force["left"].any()
    contact.accept()
    assert contact.solve_state(WheelsetState(y=0.5)).force["left"][0] == pytest.approx(0.6)  # no history is left


def test_names_of_a_tangent() -> None:
    contact = element()
    with pytest.raises(ValueError, match="tangent: no state has been solved"):
        contact.tangent()
    contact.solve_state(WheelsetState(y=0.5))
    tangent = contact.tangent()
    assert tangent.values.shape == (2, 6, 9)
    np.testing.assert_array_equal(tangent.by("yaw_rate", "y")[:, [0, 5]], [[[0, 1], [-2, 0]], [[0, 1], [2, 0]]])
    np.testing.assert_array_equal(tangent.moment["right"], tangent.values[1, 3:])
    np.testing.assert_array_equal(tangent.force["left"], tangent.values[0, :3])
    assert [len(names) for _, names in tangent.coords] == list(tangent.values.shape)
    with pytest.raises(ValueError, match="tangent by 'yaw_speed': must be one of y, z, roll"):
        tangent.by("yaw_speed")
