"""Contacts solved at the ends of steps only: forces within steps, accuracy of runs, resumed and mirrored ones."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from plane import mirror_signs
from small_strips import few_strips
from standard_pair import wheel_on_rail

from benchmarks.population.drawn_run import Run
from benchmarks.population.runs import BY_METHOD, EVENTS, USUAL
from wheelrail.contact.kinematics.frames import MIRROR, SIDES
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.rosenbrock import ROSENBROCK_ENDS, RosenbrockW
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleLinearisation
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.contacts_at_end import ContactsAtEnd
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.steady.start_state import start_state
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon


def curve(curvature: float = 1 / 600) -> Track:
    return Track.curve(curvature=curvature, cant=0.06, transition=15.0, length=50.0)


@cache
def vehicle_at(time: float) -> tuple[VehicleDynamics, Array]:
    """Manchester 1 in a transition, and its state after a time s."""
    dynamics = VehicleDynamics(load_vehicle(), curve(), wheel_on_rail(), 30.0)
    return dynamics, simulate(dynamics, (0.0, time)).state[-1]


def wrench(result: ContactResult) -> Array:
    return np.concatenate([result.force, result.moment])


@pytest.mark.parametrize("seed", range(6))
def test_value_and_slope_are_those_of_the_contact(seed: int) -> None:
    """The difference vanishes with the square of the distance."""
    random, (dynamics, state) = np.random.default_rng(seed), vehicle_at(0.3)
    start = dynamics(0.3, state)
    own_contacts = ContactsAtEnd.of(dynamics, state, start)
    direction = random.normal(size=dynamics.size) * np.abs(state).clip(1e-6)

    def error(size: float, later: float) -> float:
        time, moved = 0.3 + later, state + size * direction
        own, exact = own_contacts(time, moved, start).contacts, dynamics(time, moved, start).contacts
        return max(float(np.abs(wrench(own[n][s]) - wrench(exact[n][s])).max()) for n in exact for s in SIDES)

    sizes = np.array([1e-4, 2e-4, 4e-4, 1e-3])
    slope = np.polyfit(np.log(sizes), np.log([error(size, 0.0) for size in sizes]), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1)
    assert error(0.0, 1e-3) < 0.05  # N, by the turning track frame: to first order in yaw


def test_wheelsets_with_and_without_moving_hubs() -> None:
    """One wheelset on an elastic axle and pads, the others rigid: wheels have 9 or 27 coordinates."""
    name, numbers = "elastic axle", {"method": BY_METHOD["rosenbrock_ends"]}
    dynamics = Run(0, fixed=tuple((USUAL | numbers | EVENTS[name]).items())).dynamics
    state = start_state(dynamics)
    start = dynamics(0.0, state)
    own_contacts = ContactsAtEnd.of(dynamics, state, start)
    moved = state + 1e-6 * np.random.default_rng(1).normal(size=dynamics.size)
    own, exact = own_contacts(0.0, moved, start).contacts, dynamics(0.0, moved, start).contacts
    for wheelset in exact:
        for side in SIDES:
            changed = wrench(exact[wheelset][side]) - wrench(start.contacts[wheelset][side])
            left = wrench(own[wheelset][side]) - wrench(exact[wheelset][side])
            assert np.abs(left).max() < 0.02 * np.abs(changed).max()


@dataclass(frozen=True)
class Rate:
    rate: Array


def pendulum(t: float, x: Array, previous: Rate | None = None) -> Rate:
    """Driven, with a costly force -sin x."""
    return Rate(np.array([x[1], np.cos(3.0 * t) - 0.2 * x[1] - np.sin(x[0])]))


@dataclass(frozen=True)
class PendulumAt:
    """The pendulum with its force to first order."""

    x: Array

    def at(self, state: Array, there: Rate) -> PendulumAt:
        return PendulumAt(state)

    def force(self, x: float) -> float:
        return float(-np.sin(self.x[0]) - np.cos(self.x[0]) * (x - self.x[0]))

    def __call__(self, time: float, state: Array, previous: Rate | None) -> Rate:
        return Rate(pendulum(time, state).rate + np.array([0.0, np.sin(state[0]) + self.force(state[0])]))

    def missed(self, time: float, state: Array, within: Rate, share: float, end: PendulumAt) -> Array:
        v0, v, v1, c = self.x[0], state[0], end.x[0], share
        lagrange = np.polyfit([0.0, c, 1.0], [v0, v, v1], 2)
        value = -np.sin(v1) - self.force(v1)
        slope = (np.cos(v0) - np.cos(v1)) * np.polyval(np.polyder(lagrange), 1.0)
        cubic = np.linalg.solve([[1.0, 1.0], [2.0, 3.0]], [value, slope])
        return np.array([[0.0, cubic @ [c**2, c**3]], [0.0, value * c**2]])


def test_the_method_is_of_third_order_with_one_evaluation_a_step() -> None:
    def slope(t: float, x: Array, at: Rate) -> VehicleLinearisation:
        by_state = np.array([[0.0, 1.0], [-np.cos(x[0]), -0.2]])
        return VehicleLinearisation(by_state, np.array([0.0, -3.0 * np.sin(3.0 * t)]))

    def end(steps: int) -> tuple[Array, float]:
        calls, x, h, largest = [0], np.array([1.0, 0.5]), 2.0 / steps, 0.0

        def counted(t: float, x: Array, previous: Rate | None = None) -> Rate:
            calls[0] += 1
            return pendulum(t, x)

        def ends(x: Array, start: Rate, linear: object) -> PendulumAt:
            return PendulumAt(x)

        method = RosenbrockW(counted, ROSENBROCK_ENDS, StepStatistics(), slope, ends=ends)
        start = pendulum(0.0, x)
        for n in range(steps):
            x, errors, last = method(n * h, x, start, h)
            start, _ = method.end((n + 1) * h, x, last)
            largest = max(largest, float(np.abs(errors).max()))
        assert calls[0] == steps
        return x, largest

    exact, numbers = end(3200)[0], np.array([25, 50, 100, 200])
    errors, estimates = zip(*((np.abs(end(n)[0] - exact).max(), end(n)[1]) for n in numbers.tolist()), strict=True)
    assert np.polyfit(np.log(1.0 / numbers), np.log(errors), 1)[0] == pytest.approx(3.0, abs=0.2)
    assert np.polyfit(np.log(1.0 / numbers), np.log(estimates), 1)[0] == pytest.approx(3.0, abs=0.3)
    assert all(estimate * n > error for estimate, n, error in zip(estimates, numbers, errors, strict=True))


@cache
def in_a_curve(method: str = "rosenbrock_ends", curvature: float = 1 / 600, rtol: float = 3e-3) -> History:
    dynamics = VehicleDynamics(load_vehicle(), curve(curvature), wheel_on_rail(), 45.0)
    return simulate(dynamics, (0.0, 0.15), steps=StepSettings(method, rtol, 1e-2 * rtol))


def test_runs_are_as_accurate_with_less_than_half_of_the_solves() -> None:
    """But for pitch angles: nothing depends on those of wheelsets, which keep what each impact on a flange adds."""
    reference, plain, own = in_a_curve("rosenbrock", rtol=3e-4), in_a_curve("rosenbrock"), in_a_curve()
    away = [np.abs(run.state[-1] - reference.state[-1])[:42].reshape(7, 6) for run in (own, plain)]
    errors = [np.delete(each, 4, axis=1).max() for each in away]
    assert errors[0] < 1.5 * errors[1]
    solves = [sum(side.solves for side in run.cost.contact.values()) for run in (own, plain)]
    assert solves[0] < 0.5 * solves[1]


def test_mirror_images_are_equal_to_the_last_bit() -> None:
    left, right = in_a_curve(), in_a_curve(curvature=-1 / 600)
    np.testing.assert_array_equal(right.state, mirror_signs(left.dynamics.coordinates) * left.state)
    np.testing.assert_array_equal(right.force, MIRROR * left.force[:, :, ::-1])


def test_a_resumed_run_repeats_the_whole_one_to_the_last_bit() -> None:
    """With strips, whose solves start from earlier ones."""
    dynamics = wagon_dynamics(Wagon(), curve(), few_strips(), 45.0)
    steps, written = StepSettings("rosenbrock_ends", 3e-3, 3e-6), list[Checkpoint]()
    every = Checkpoints(4, lambda at: written.append(deepcopy(at)))
    whole = simulate(dynamics, (0.0, 0.2), steps=steps, recording=Recording(checkpoints=every))
    assert len(written) > 2
    assert written[1].solved is not None
    for at in written[1:3]:
        again = simulate(
            dynamics, (0.0, 0.2), steps=steps, recording=Recording(checkpoints=Checkpoints(4, lambda _: None, at))
        )
        np.testing.assert_array_equal(again.state, whole.state)
        np.testing.assert_array_equal(again.force, whole.force)


class Bare(VehicleContact):
    """Contact without a tangent."""

    def __call__(self, state, side, guess=None):  # type: ignore[no-untyped-def]
        return wheel_on_rail()(state, side, guess)


def test_without_a_tangent_contacts_are_solved_in_all_stages() -> None:
    dynamics = wagon_dynamics(Wagon(), curve(), Bare(), 45.0)
    own, plain = (
        simulate(dynamics, (0.0, 0.05), steps=StepSettings(method, 3e-3, 3e-5))
        for method in ("rosenbrock_ends", "rosenbrock")
    )
    np.testing.assert_array_equal(own.state, plain.state)
