"""Tables of contact forces: interpolation, refinement, and the table beside the model that it is made from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from standard_pair import MOUNTING, wheel_on_rail

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.table.force_table import ForceTable, TreadFrame
from wheelrail.contact.models.table.interpolation import stencil
from wheelrail.contact.models.table.model import TableContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.tables.builder import NoSolution, TableBuilder, completed
from wheelrail.contact.tables.errors import TableErrors
from wheelrail.contact.tables.nodes import Nodes
from wheelrail.contact.tables.samples import TableSampler
from wheelrail.contact.tables.table_range import TableRange
from wheelrail.contact.tables.tasks import Task
from wheelrail.support.arrays import Array

FRAME = TreadFrame(MOUNTING.radius, MOUNTING.wheel_y - MOUNTING.rail_y)
RANGES = TableRange(y=(-1e-3, 1e-3), roll=(-5e-4, 5e-4), yaw=(-2e-3, 2e-3), load=(30e3, 90e3))
TOLERANCE = 0.02
V = 20.0
LOWERED = WheelsetState(y=-1e-4, yaw=1e-3, y_rate=0.01, roll_rate=1e-3, pitch_rate=1.001 * V / 0.46, speed=V)
STATE = wheel_under_load(wheel_on_rail(), LOWERED, "left", 60e3, expected=1e-4).state


def in_this_process(sampler: TableSampler) -> Callable[[Sequence[Task], str], list[Array]]:
    return lambda tasks, purpose: [task.rows(sampler) for task in tasks]


@cache
def built(friction: float = 0.3) -> tuple[ForceTable, TableErrors]:
    sampler = TableSampler(wheel_on_rail(friction).model, FRAME, friction)
    return TableBuilder(sampler, RANGES, TOLERANCE, in_this_process(sampler)).build()


def contact(friction: float = 0.3) -> WheelsetContact:
    return WheelsetContact(TableContact(built(friction)[0]), MOUNTING)


def interpolated(nodes: Array, values: Array, x: complex) -> complex:
    first, start, stop, weights = stencil(nodes, x)
    return complex(sum(weights[k] * values[first + k] for k in range(start, stop)))


def test_quadratic_functions_are_interpolated_exactly() -> None:
    nodes = np.array([-1.0, -0.2, 0.1, 0.7, 2.0])
    for x in (-1.0, -0.7, 0.0, 0.1, 0.5, 1.9, 2.0):
        assert interpolated(nodes, 3.0 - 2.0 * nodes + nodes**2, x).real == pytest.approx(
            3.0 - 2.0 * x + x**2, abs=1e-13
        )


@pytest.mark.parametrize("count", [1, 2])
def test_one_node_is_a_constant_and_two_a_line(count: int) -> None:
    nodes = np.array([1.0, 3.0])[:count]
    assert interpolated(nodes, 5.0 * nodes, 2.5).real == pytest.approx((5.0, 12.5)[count - 1], rel=1e-15)


def test_slope_is_continuous_and_complex_steps_are_derivatives() -> None:
    nodes, values = np.array([0.0, 0.3, 1.0, 1.2, 2.0]), np.array([0.0, 1.0, 0.5, 2.0, 1.5])

    def slope(x: float) -> float:
        return interpolated(nodes, values, x + 1e-30j).imag / 1e-30

    for node in nodes[1:-1]:
        assert slope(node - 1e-12) == pytest.approx(slope(node + 1e-12), abs=1e-9)
    difference = (interpolated(nodes, values, 0.6 + 1e-6) - interpolated(nodes, values, 0.6 - 1e-6)).real / 2e-6
    assert slope(0.6) == pytest.approx(difference, rel=1e-8)


def test_intervals_with_large_errors_are_bisected_and_others_not_tested_again() -> None:
    nodes = Nodes({"y": np.array([0.0, 1.0, 2.0]), "roll": np.array([0.5])}, {"y": (0.0, 2.0), "roll": (0.0, 1.0)})
    trials = nodes.trials(np.random.default_rng(0))
    assert {(trial.axis, trial.point[trial.axis]) for trial in trials} == {
        ("y", 0.5),
        ("y", 1.5),
        ("roll", 0.0),
        ("roll", 1.0),
    }
    errors = np.array([float(trial.axis == "y" and trial.point["y"] < 1.0) for trial in trials])
    assert nodes.refine(trials, errors, 0.1)
    assert nodes.axes["y"].tolist() == [0.0, 0.5, 1.0, 2.0]
    assert nodes.axes["roll"].tolist() == [0.5]
    assert {trial.interval for trial in nodes.trials(np.random.default_rng(0))} == {(0.0, 0.5), (0.5, 1.0)}


def test_an_axis_of_one_node_gets_its_ends() -> None:
    nodes = Nodes({"roll": np.array([0.0])}, {"roll": (-1.0, 1.0)})
    trials = nodes.trials(np.random.default_rng(0))
    assert nodes.refine(trials, np.ones(len(trials)), 0.1)
    assert nodes.axes["roll"].tolist() == [-1.0, 0.0, 1.0]


@pytest.mark.parametrize("failed", [[], [0], [1, 2], [0, 3, 4]])
def test_failed_solves_are_interpolated_between_their_neighbours(failed: list[int]) -> None:
    nodes = np.array([0.0, 1.0, 3.0, 4.0, 7.0])
    expected = nodes[:, None] * [1.0, -2.0] + [5.0, 0.5]
    rows = expected.copy()
    rows[failed] = np.nan
    np.testing.assert_allclose(completed(rows, nodes), expected, rtol=1e-14)


def test_too_many_failed_solves_are_an_error() -> None:
    with pytest.raises(NoSolution, match="solutions at 1 of 3 values"):
        completed(np.array([[np.nan], [1.0], [np.nan]]), np.arange(3.0))


def test_table_agrees_with_its_model_at_fresh_points() -> None:
    """Also with rates of rotation about z, which the table does not have as a variable."""
    _, errors = built()
    assert errors.rms < TOLERANCE
    assert errors.worst < 4 * TOLERANCE
    assert np.abs(errors.moment).max() < 5e-4  # m, of the load
    own, direct = contact(), wheel_on_rail()
    for side in ("left", "right"):
        result, expected = own(STATE, side), direct(STATE, side)
        assert result.status == expected.status == "converged"
        load = expected.force[2]
        np.testing.assert_allclose(result.force, expected.force, atol=2 * TOLERANCE * load)
        np.testing.assert_allclose(result.moment, expected.moment, atol=2 * TOLERANCE * load * 0.75)


def test_table_without_friction() -> None:
    table, errors = built(0.0)
    assert table.friction.coefficient == 0.0
    assert errors.rms < TOLERANCE
    standstill = replace(STATE, speed=0.0, pitch_rate=0.0, y_rate=0.0)
    np.testing.assert_allclose(contact(0.0)(standstill, "left").force, contact(0.0)(STATE, "left").force, rtol=1e-14)


@pytest.mark.parametrize("side", ["left", "right"])
def test_tangent_is_the_derivative(side: str) -> None:
    own, steps = contact(), {"y": 1e-8, "z": 1e-9, "roll": 1e-8, "yaw": 1e-7}
    result = own(STATE, side)  # type: ignore[arg-type]
    tangent = own.tangent(STATE, side, result)  # type: ignore[arg-type]
    for column, name in enumerate(WheelsetState.coordinates):
        h = steps.get(name, 1e-6)
        ahead, behind = (
            own(replace(STATE, **{name: getattr(STATE, name) + step}), side)  # type: ignore[arg-type]
            for step in (h, -h)
        )
        difference = np.concatenate([ahead.force - behind.force, ahead.moment - behind.moment]) / (2 * h)
        np.testing.assert_allclose(
            tangent[:, column], difference, rtol=2e-5, atol=2e-6 * np.abs(tangent).max(axis=1).max()
        )


def test_beyond_the_largest_creepage_only_the_direction_of_slip_matters() -> None:
    own = contact()
    forces = [own(replace(STATE, pitch_rate=factor * V / 0.46), "left").force for factor in (1.1, 1.2)]
    assert forces[0][0] == pytest.approx(forces[1][0], rel=2e-3)
    assert forces[0][0] == pytest.approx(0.3 * forces[0][2], rel=0.03)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"y": 3e-3}, "table: y of the wheel = 0.003 m: must be from -0.001 to 0.001 m"),
        ({"yaw": 4e-3}, "table: yaw of the wheel = 0.004 rad: must be from -0.002 to 0.002 rad"),
        ({"z": -1e-3}, "table: load without friction ="),
        ({"speed": -V, "pitch_rate": -V / 0.46}, "friction needs a positive rolling speed"),
    ],
)
def test_outside_the_table_variable_value_and_range_are_named(changes: dict[str, float], message: str) -> None:
    result = contact()(replace(STATE, **changes), "left")  # type: ignore[arg-type]
    assert result.status.startswith(f"failed: {message}")


def test_separated_wheel_and_light_load() -> None:
    """Below the smallest load of the table the force falls with depth^(3/2) to zero, and stays there."""
    own = contact()
    touch = next(z for z in np.arange(-3e-4, 0.0, 1e-7) if own(replace(STATE, z=z), "left").status == "separated")
    loads = [own(replace(STATE, z=touch - depth), "left").force[2] for depth in (2e-6, 8e-6)]
    assert loads[1] / loads[0] == pytest.approx(8.0, rel=0.15)
    assert own(replace(STATE, z=5e-3), "left").status == "separated"


def test_a_load_without_solution_is_nan() -> None:
    sampler = TableSampler(wheel_on_rail().model, FRAME, 0.3)
    rows = sampler.normal_rows(1e-3, 0.0, 0.0, [6e4, 5e9])
    assert np.isfinite(rows[0]).all()
    assert np.isnan(rows[1]).all()


def test_wheels_far_above_the_rail_are_lowered_to_it() -> None:
    """At 2 mrad of roll and 7 mm the penetrations that the model samples begin below the nominal height."""
    sampler = TableSampler(wheel_on_rail().model, FRAME, 0.3)
    assert np.isfinite(sampler.normal_rows(-7e-3, 2e-3, -5e-3, [1e4])).all()


@pytest.mark.parametrize("load", [(0.0, 1e5), (1e5, 1e4)])
def test_impossible_ranges_are_refused(load: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="load = "):
        TableRange(load=load)
