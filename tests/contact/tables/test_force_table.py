"""Tables of contact forces: interpolation, refinement, and the table beside the model that it is made from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from standard_pair import MOUNTING, wheel_on_rail

from wheelrail.bindings._contact import Grid, interpolated, level_at
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.table.force_table import ForceTable, TreadFrame
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


def spline(nodes: Array, values: Array) -> CubicHermiteSpline:
    """The interpolant of SciPy with slopes of parabolas by NumPy."""
    return CubicHermiteSpline(nodes, values, np.gradient(values, nodes, axis=0, edge_order=min(2, len(nodes) - 1)))


@pytest.mark.parametrize("counts", [(6, 3, 4), (1, 5, 2), (2, 1, 1)])
def test_tensor_product_with_derivatives_is_that_of_scipy(counts: tuple[int, ...]) -> None:
    random = np.random.default_rng(0)
    axes = [np.sort(random.uniform(0.0, 1.0, count)) for count in counts]
    values, columns = random.uniform(-1.0, 1.0, (*counts, 7)), 7
    at = tuple(float(0.4 * nodes[0] + 0.6 * nodes[-1]) for nodes in axes)
    grid = Grid(np.concatenate(axes), counts, values.ravel(), columns)
    own = interpolated(grid, np.array(at), True)
    for row in range(4):
        expected = values
        for axis, (nodes, x) in enumerate(zip(axes, at, strict=True), 1):
            order = int(axis == row)
            expected = expected[0] * (1 - order) if len(nodes) == 1 else spline(nodes, expected)(x, order)
        np.testing.assert_allclose(own[row], expected, rtol=1e-11, atol=1e-12)
    np.testing.assert_array_equal(interpolated(grid, np.array(at), False), own[:1])


@pytest.mark.parametrize("z", [-2e-5, -3e-4, -3.001e-4, -9.99e-4, -1e-3])
def test_level_is_where_the_height_is(z: float) -> None:
    nodes, heights = np.array([0.0, 400.0, 1000.0, 2000.0]), np.array([0.0, -3e-4, -6e-4, -1e-3])
    assert spline(nodes, heights)(level_at(nodes, heights, z)) == pytest.approx(z, rel=1e-14)


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
    assert nodes.axes["roll"].tolist() == [-1.0, 1.0]


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
    """Also with rates of rotation about z, which the table does not have as a variable.

    Where the load of the standard contact moves from one hump of the penetration to the other, single points err more.
    """
    _, errors = built()
    assert errors.rms < TOLERANCE
    assert np.nanquantile(errors.lengths, 0.99) < 4 * TOLERANCE
    assert errors.worst < 6 * TOLERANCE
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
