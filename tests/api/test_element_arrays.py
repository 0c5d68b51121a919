"""Arrays in and out of a wheelset's element: the numbers of `solve`, derivatives by all inputs, wild input."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from time import process_time
from typing import Any

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.api.elements.variables import FORCES, INPUTS, OUTPUTS, PARAMETERS, PATCH
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array

NUMBER = {variable.name: number for number, variable in enumerate(INPUTS)}
PLACE = {"y": -1e-3, "z": -2.8e-4, "yaw": 5e-3, "y_rate": 0.01, "speed": 20.0, "pitch_rate": 20.0 / 0.46}


@cache
def standard() -> wr.Wheelset:
    return wr.Wheelset("S1002", "UIC60-benchmark", model="standard", right={"friction": 0.1}, speed=20.0)


def exact() -> wr.WheelsetElement:
    """A lattice with the last Newton step small enough for differences."""
    element = wr.Wheelset("S1002", "UIC60-benchmark", bodies="half-space", strips=8, cells=8).element()
    contact = element.contact
    assert isinstance(contact, WheelsetContact)
    element.contact = replace(contact, model=replace(contact.model, tolerance=1e-8))  # type: ignore[type-var]
    return element


def inputs(element: wr.WheelsetElement, **values: float) -> Array:
    array = element.start_array()
    for name, value in values.items():
        array[NUMBER[name]] = value
    return array


def test_names_and_units() -> None:
    for variables in (INPUTS, OUTPUTS, PATCH, PARAMETERS):
        names = [variable.name for variable in variables]
        assert all(name.isidentifier() for name in names)
        assert len(set(names)) == len(names)
        assert not any(variable.description.endswith(".") for variable in variables)
    assert OUTPUTS[: len(FORCES)] == FORCES
    assert len({variable.name for variable in (*INPUTS, *OUTPUTS, *PARAMETERS)}) == 33


@pytest.mark.parametrize("make", [lambda: standard().element(), exact], ids=["standard", "lattice"])
def test_arrays_have_the_numbers_of_solve_to_the_last_bit(make: Any) -> None:
    element, outputs = make(), np.zeros(len(OUTPUTS))
    for _ in range(2):  # from none, and from an accepted state
        given = inputs(element, **PLACE, frame_rate_z=0.03, left_rail_y=1e-4, right_rail_z=-2e-5)
        assert element.solve_array(given, outputs) == "converged"
        values = element.patch_array()
        shifts = ((1e-4, 0.0), (0.0, -2e-5))
        solution = element.solve(**PLACE, frame_rate=(0.0, 0.0, 0.03), rail_shift=shifts)
        wrenches = [part[side] for side in ("left", "right") for part in (solution.force, solution.moment)]
        expected = np.concatenate([*wrenches, list(solution.approach.values())])
        assert outputs.tobytes() == expected.tobytes()
        for row, patches in zip(values, element.patches().values(), strict=True):
            largest = max(patches, key=lambda patch: patch.normal_force)
            assert (row[0], row[1], row[2]) == (len(patches), largest.area, largest.max_pressure)
            assert row[PATCH.index(next(v for v in PATCH if v.name == "rail_y"))] == largest.rail_y
        element.accept()


def test_start_values_are_those_of_the_wheelset() -> None:
    element = standard().element()
    outputs = np.zeros(len(OUTPUTS))
    start = inputs(element, z=-2.5e-4)
    element.solve_array(start, outputs)
    np.testing.assert_array_equal(outputs[:3], element.solve(z=-2.5e-4).force["left"])
    assert start[NUMBER["pitch_rate"]] == 20.0 / 0.46
    assert outputs[0] > 2.5 * outputs[6] > 0.0  # friction 0.3 on the left, 0.1 on the right


def test_derivatives_by_all_inputs() -> None:
    """To 1e-3 of the largest entry of a row, of positions and of the track frame, beside central differences."""
    element, outputs = exact(), np.zeros(len(OUTPUTS))
    place = inputs(element, **PLACE)
    element.solve_array(place, outputs)
    element.accept()
    element.solve_array(place, outputs)
    derivatives = element.tangent_array()
    for names, step in (
        (("y", "z", "left_rail_y", "left_rail_z", "right_rail_y", "right_rail_z"), 2e-8),
        (("speed", "frame_rate_x", "frame_rate_y", "frame_rate_z"), 2e-5),
    ):
        columns = []
        for name in names:
            ahead, behind = place.copy(), place.copy()
            ahead[NUMBER[name]] += step
            behind[NUMBER[name]] -= step
            pair = []
            for at in (ahead, behind):
                element.solve_array(at, outputs)
                pair.append(outputs[: len(FORCES)].copy())
            columns.append((pair[0] - pair[1]) / (2 * step))
        expected = np.stack(columns, axis=1)
        error = np.abs(derivatives[:, [NUMBER[name] for name in names]] - expected)
        assert (error / np.abs(expected).max(axis=1, keepdims=True)).max() < 1e-3


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"z": float("nan")}, "failed: z = nan: must be a number from -0.1 to 0.1 m (2 mm is 0.002)"),
        ({"z": -0.5}, "failed: z = -0.5: must be"),
        ({"left_rail_z": float("inf")}, "failed: left_rail_z = inf: must be"),
        ({"speed": 0.0, "pitch_rate": 0.0}, "failed: left: friction needs a positive rolling speed"),
        ({"y": 0.01, "z": -0.02}, "failed: left: the wheel overlaps the rail 2.2"),
        ({"z": -0.05}, "failed: left: the wheel lies inside the rail, too deep for a contact"),
    ],
)
def test_wild_input_is_a_status(values: dict[str, float], says: str) -> None:
    element, outputs = standard().element(), np.zeros(len(OUTPUTS))
    before = element.solve_array(inputs(element, z=-2.5e-4), outputs), outputs.tobytes()
    assert element.solve_array(inputs(element, **{"z": -2.5e-4, **values}), outputs).startswith(says)
    assert np.isnan(outputs[: len(FORCES)]).all()
    with pytest.raises(ValueError, match="accept: "):
        element.accept()
    assert (element.solve_array(inputs(element, z=-2.5e-4), outputs), outputs.tobytes()) == before
    with pytest.raises(ValueError, match=r"arrays \(17,\) and \(14,\), got \(3,\)"):
        element.solve_array(np.zeros(3), outputs)


def test_motions_of_own_bodies_are_no_array() -> None:
    wheelset = wr.Wheelset("S1002", "UIC60-benchmark", bodies="half-space", strips=8, cells=8)
    element = wheelset.element(host=["axle"])
    for call in (element.start_array, lambda: element.solve_array(np.zeros(17), np.zeros(14)), element.tangent_array):
        with pytest.raises(wr.SceneError, match=r"_array: not allowed with element\(host="):
            call()


@dataclass(frozen=True)
class Constant(VehicleContact):
    """The same result everywhere."""

    result: ContactResult

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.result


def test_the_interface_costs_microseconds() -> None:
    """Beyond `solve_state`: 10 to 14 us measured on a loaded machine."""
    element, outputs = standard().element(), np.zeros(len(OUTPUTS))
    result = ContactResult(np.ones(3), np.ones(3), status="converged")
    element.contact = Constant(result)
    given, state = inputs(element, **PLACE), element.solve(**PLACE).state

    def shortest(call: Any) -> float:
        times = []
        for _ in range(20):
            start = process_time()
            for _ in range(200):
                call()
            times.append((process_time() - start) / 200)
        return min(times)

    cost = shortest(lambda: element.solve_array(given, outputs)) - shortest(lambda: element.solve_state(state))
    assert 0.0 < cost < 40e-6
