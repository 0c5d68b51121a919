"""Inner stages of steps on corrected tables: another contact as a poor table, the contact itself as a perfect one."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from plane import mirror_signs
from small_strips import few_strips
from standard_pair import wheel_on_rail

from wheelrail.contact.kinematics.frames import MIRROR, SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.scenes.builders.vehicle_file import load_vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.plane_wagon import wagon_dynamics
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.simulate import simulate
from wheelrail.vehicle.simulation.table_stages import CorrectedTable, TableStages
from wheelrail.vehicle.simulation.time_run import Recording
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

POOR = {"friction": 0.2}  # of the contact that serves as a table


def curve(curvature: float = 1 / 600) -> Track:
    return Track.curve(curvature=curvature, cant=0.06, transition=15.0, length=50.0)


@cache
def vehicle_at(time: float) -> tuple[VehicleDynamics, Array]:
    """Manchester 1 in a transition, and its state after a time s."""
    dynamics = VehicleDynamics(load_vehicle(), curve(), wheel_on_rail(), 30.0, stages=wheel_on_rail(**POOR))
    return dynamics, simulate(replace(dynamics, stages=None), (0.0, time)).state[-1]


def wrench(result: ContactResult) -> Array:
    return np.concatenate([result.force, result.moment])


@pytest.mark.parametrize("seed", range(6))
def test_value_and_slope_are_those_of_the_contact_at_the_start(seed: int) -> None:
    """The difference vanishes with the square of the distance, the table's own with nothing."""
    random, (dynamics, state) = np.random.default_rng(seed), vehicle_at(0.3)
    assert dynamics.stages is not None
    start = dynamics(0.3, state)
    linear = VehicleJacobian(dynamics, StepStatistics())(0.3, state, start)
    inner = TableStages(dynamics, dynamics.stages)(start, linear)
    direction = random.normal(size=dynamics.size) * np.abs(state).clip(1e-6)

    def error(size: float, later: float) -> float:
        time, moved = 0.3 + later, state + size * direction
        own, exact = inner(time, moved, start).contacts, dynamics(time, moved, start).contacts
        return max(float(np.abs(wrench(own[n][s]) - wrench(exact[n][s])).max()) for n in exact for s in SIDES)

    sizes = np.array([1e-4, 2e-4, 4e-4, 1e-3])
    slope = np.polyfit(np.log(sizes), np.log([error(size, 0.0) for size in sizes]), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.1)
    assert error(0.0, 1e-3) < 5e-3  # N, by the turning track frame: to first order in yaw


def in_a_curve(stages: VehicleContact | None, curvature: float = 1 / 600, rtol: float = 3e-3) -> History:
    dynamics = VehicleDynamics(load_vehicle(), curve(curvature), wheel_on_rail(), 45.0, stages=stages)
    return simulate(dynamics, (0.0, 0.15), steps=StepSettings("rosenbrock", rtol, 1e-2 * rtol))


@cache
def plain() -> History:
    return in_a_curve(None)


def test_the_contact_as_its_own_table_repeats_the_run_to_the_last_bit() -> None:
    own = in_a_curve(wheel_on_rail())
    np.testing.assert_array_equal(own.state, plain().state)
    np.testing.assert_array_equal(own.force, plain().force)


def test_a_poor_table_costs_steps_and_no_accuracy() -> None:
    reference = in_a_curve(None, rtol=1e-4)
    poor = in_a_curve(wheel_on_rail(**POOR))
    errors = [np.abs(run.state[-1] - reference.state[-1])[:42].max() for run in (poor, plain())]
    assert errors[0] < max(1.5 * errors[1], 1e-6)
    solves = sum(side.solves for side in poor.cost.contact.values())
    assert solves < 0.5 * 8 * poor.cost.steps.evaluations  # those of ends alone, and of the start


def test_mirror_images_are_equal_to_the_last_bit() -> None:
    left, right = (in_a_curve(wheel_on_rail(**POOR), way / 600) for way in (1.0, -1.0))
    np.testing.assert_array_equal(right.state, mirror_signs(left.dynamics.coordinates) * left.state)
    np.testing.assert_array_equal(right.force, MIRROR * left.force[:, :, ::-1])


def test_a_resumed_run_repeats_the_whole_one_to_the_last_bit() -> None:
    """With strips, whose solves start from earlier ones."""
    dynamics = replace(wagon_dynamics(Wagon(), curve(), few_strips(), 45.0), stages=wheel_on_rail())
    steps, written = StepSettings("rosenbrock", 3e-3, 3e-6), list[Checkpoint]()
    every = Checkpoints(4, lambda at: written.append(deepcopy(at)))
    whole = simulate(dynamics, (0.0, 0.2), steps=steps, recording=Recording(checkpoints=every))
    assert len(written) > 2
    for at in written[1:3]:
        again = simulate(
            dynamics, (0.0, 0.2), steps=steps, recording=Recording(checkpoints=Checkpoints(4, lambda _: None, at))
        )
        np.testing.assert_array_equal(again.state, whole.state)
        np.testing.assert_array_equal(again.force, whole.force)


def test_the_contact_is_solved_where_the_table_is_not_known() -> None:
    class Nowhere(VehicleContact):
        def __call__(self, state: object, side: object, guess: object = None) -> ContactResult:
            return ContactResult.failed("outside")

    contact, state = wheel_on_rail(), WheelsetState(z=-1e-4, speed=20.0, pitch_rate=20.0 / 0.46)
    found = CorrectedTable(contact, Nowhere(), {}, 0.46).solve_side([state], "left", [None])[0]
    assert np.array_equal(found.force, contact(state, "left").force)
    np.testing.assert_array_equal(in_a_curve(Nowhere()).state, plain().state)
