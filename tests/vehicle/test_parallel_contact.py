"""Contacts of several wheels in threads: results to the last bit, really at the same time, errors, interrupts."""

from __future__ import annotations

import signal
import threading
import time
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import pytest
from small_strips import few_strips
from standin_contact import CONTACT, FunctionContact

from wheelrail.contact.element.contact_element import ContactElement
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult, LazyPatches, Patch
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import check_interrupt, deferred_interrupts
from wheelrail.support.threads import Threads
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.simulation.contact_cost import CountedContact
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.parallel_contact import Parallel, in_threads
from wheelrail.vehicle.simulation.recorder import Recorder
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.steady.equilibrium import equilibrium
from wheelrail.vehicle.track.track import Track

STATE = WheelsetState(z=-6e-5, pitch_rate=45.0 / 0.46, speed=45.0)
FOUR = [replace(STATE, y=y) for y in (-2e-3, -1e-3, 1e-3, 2e-3)]
NONE = [None] * len(FOUR)


def begun(contact: VehicleContact, count: int = 2) -> Parallel:
    """The contact in threads that take part from the first call on."""
    parallel = Parallel(contact, Threads(count - 1))
    parallel.begun = True
    return parallel


@pytest.mark.parametrize("count", [2, 4])
def test_runs_on_strips_are_those_of_one_thread(count: int) -> None:
    """Forces, tangents, patches and costs of a vehicle of eight wheels."""
    state = equilibrium(VehicleDynamics(load_vehicle(), Track(), few_strips(), 30.0)).state
    state[42:84:6] += 0.1  # m/s forward
    state[43:84:6] += 0.05  # m/s to the left

    def run(contact: VehicleContact) -> History:
        dynamics = VehicleDynamics(load_vehicle(), Track(), contact, 30.0)
        return simulate(dynamics, (0.0, 0.01), initial=state)

    alone = run(few_strips())
    with in_threads(few_strips(), count) as contact:
        together = run(contact)
    assert alone.status == together.status == "completed"
    assert len(alone) > 2
    np.testing.assert_array_equal(together.state, alone.state)
    np.testing.assert_array_equal(together.force, alone.force)
    for side in SIDES:
        mine, theirs = together.cost.contact[side], alone.cost.contact[side]
        assert (mine.solves, mine.tangents, mine.newton) == (theirs.solves, theirs.tangents, theirs.newton)
    for own, other in zip(together.rows[-1].patches, alone.rows[-1].patches, strict=True):
        for mine_packed, theirs_packed in zip(own, other, strict=True):
            np.testing.assert_array_equal(mine_packed.values, theirs_packed.values)


class Meeting(VehicleContact):
    """A contact two of whose solves, tangents or patches have to be under way at the same time."""

    def __init__(self) -> None:
        self.barrier = threading.Barrier(2, timeout=20.0)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        self.barrier.wait()
        return replace(ContactResult.separated(1.0), patches=LazyPatches(self.patches))

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        self.barrier.wait()
        return np.full((6, 9), state.y)

    def patches(self) -> tuple[Patch, ...]:
        self.barrier.wait()
        return ()


def test_solves_tangents_and_patches_run_side_by_side() -> None:
    """Of both sides of one wheelset, and of wheelsets."""
    contact = begun(Meeting())
    element: ContactElement[WheelsetState, Side] = ContactElement(CountedContact(contact), SIDES)
    results: list[dict[Side, ContactResult]] = [{} for _ in FOUR]
    for i, side, result in element.solve_states(FOUR, NONE):
        results[i][side] = result
    tangents = element.tangents(FOUR, results)
    assert tangents.shape == (4, 2, 6, 9)
    np.testing.assert_array_equal(tangents[:, :, 0, 0].T, [[state.y for state in FOUR]] * 2)
    recorder = Recorder(partial(pytest.fail, "no step"), contact.each, None)
    at = VehicleEvaluation(np.zeros(20), dict(zip("abcd", results, strict=True)))
    recorder.begin(0.0, np.zeros(20), at)
    assert [[len(patches) for patches in pair] for pair in recorder.rows[0].patches] == [[0, 0]] * 4


@dataclass(frozen=True)
class Alone(FunctionContact):
    """A contact that threads may not solve at the same time."""

    @property
    def concurrent(self) -> bool:
        return False


def test_what_is_not_for_threads_is_solved_in_one() -> None:
    names: list[str] = []

    def solve(state: WheelsetState, side: Side, guess: ContactResult | None) -> ContactResult:
        names.append(threading.current_thread().name)
        return CONTACT(state, side, guess)

    element: ContactElement[WheelsetState, Side] = ContactElement(begun(Alone(solve)), SIDES)
    assert len(list(element.solve_states(FOUR, NONE))) == 8
    assert names == [threading.current_thread().name] * 8


@dataclass
class Mistaken(VehicleContact):
    """A contact with a mistake in the program at one place; records what is begun."""

    begun: list[float] = field(default_factory=list)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        self.begun.append(state.y)
        if state.z < -1.0:
            raise ArithmeticError("too deep")
        if state.y > 0.0:
            raise KeyError("a mistake")
        return CONTACT(state, side, guess)


def test_errors_are_those_of_one_thread() -> None:
    contact = Mistaken()
    parallel = begun(contact)
    element: ContactElement[WheelsetState, Side] = ContactElement(parallel, SIDES)
    deep = [replace(state, z=-2.0) for state in FOUR]
    statuses = {result.status for _, _, result in element.solve_states(deep, NONE)}
    assert statuses == {"failed: ArithmeticError: too deep"}
    contact.begun.clear()
    with pytest.raises(KeyError, match="a mistake"):
        list(element.solve_states(FOUR * 20, NONE * 20))
    assert len(contact.begun) < 20  # of 160
    assert len(list(element.solve_states(FOUR[:2], NONE[:2]))) == 4
    with pytest.raises(ValueError, match="no tangent"):
        element.tangents(FOUR, [dict.fromkeys(SIDES, ContactResult.separated())] * 4)


def test_ctrl_c_ends_all_threads_once() -> None:
    """It reaches the main thread while another one solves, too."""

    def solve(state: WheelsetState, side: Side, guess: ContactResult | None) -> ContactResult:
        if threading.current_thread() is threading.main_thread():
            signal.raise_signal(signal.SIGINT)
            return CONTACT(state, side, guess)
        for _ in range(2000):
            time.sleep(0.01)
            check_interrupt()
        return CONTACT(state, side, guess)

    element: ContactElement[WheelsetState, Side] = ContactElement(begun(FunctionContact(solve)), SIDES)
    began = time.monotonic()
    with deferred_interrupts():
        with pytest.raises(KeyboardInterrupt):
            list(element.solve_states(FOUR[:1], NONE[:1]))
        check_interrupt()  # no second time
    assert time.monotonic() - began < 10.0


def test_threads_end_with_the_block() -> None:
    before = threading.active_count()
    with in_threads(CONTACT, 3) as contact:
        assert threading.active_count() == before + 2
        assert isinstance(contact, Parallel)
    assert threading.active_count() == before
    with in_threads(CONTACT, 1) as contact:
        assert contact is CONTACT
