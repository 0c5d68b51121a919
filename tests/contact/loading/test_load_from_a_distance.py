"""Loads are found from wheels that start far above their rails, or deep inside them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from dense_surfaces import DenseSurfaces
from small_strips import few_strips
from standard_pair import MOUNTING, RAIL, WHEEL, wheel_on_rail

import wheelrail as wr
from benchmarks.population.profiles import rail, wheel
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.wheelset import axle_under_load, wheel_under_load, wheels_under_load
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult

LOAD, EXPECTED = 60e3, 6e-5
MODELS = ["standard", "strips"]


@cache
def contact(name: str) -> WheelsetContact:
    own, smaller = ((wheel_on_rail if name == "standard" else few_strips)(radius=r) for r in (0.46, 0.458))
    return replace(own, right=smaller)


def rolling(**more: float) -> WheelsetState:
    return WheelsetState(pitch_rate=20.0 / 0.46, speed=20.0, **more)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("place", [{"y": 0.0}, {"y": 6.4e-3, "yaw": 4e-3}, {"y": -3e-3, "roll": 7e-3}])
def test_height_under_a_load_does_not_depend_on_the_start(name: str, place: dict[str, float]) -> None:
    own = contact(name)
    heights = []
    for z in (0.0, 2.5e-4, 0.02, -5e-4, -0.02):
        found = wheel_under_load(own, rolling(z=z, **place), "left", LOAD, expected=EXPECTED)
        assert found.results["left"].status == "converged"
        assert found.results["left"].force[2] == pytest.approx(LOAD, rel=1e-6)
        heights.append(found.state.z)
    np.testing.assert_allclose(heights, heights[0], atol=1e-9)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("roll", [2e-4, -1e-3, 1e-2])
def test_rolled_wheelset_touches_where_dense_surfaces_do(name: str, roll: float) -> None:
    """The load is found at the height of the first contact less the approach, for a gentle slope of the contact."""
    for side, radius in zip(SIDES, (0.46, 0.458), strict=True):
        dense = DenseSurfaces(WHEEL, RAIL, radius)
        found = wheel_under_load(contact(name), rolling(roll=roll), side, LOAD, expected=EXPECTED)
        result = found.results[side]
        assert result.force[2] == pytest.approx(LOAD, rel=1e-6)
        raised = replace(found.state, z=found.state.z + 1e-3)
        pose, _ = MOUNTING.left_pair(raised if side == "left" else raised.mirrored())
        assert 0.85e-3 < dense.gap(pose) + result.approach < 1.0e-3 * (1 + 1e-6)


@pytest.mark.parametrize("name", MODELS)
def test_both_wheels_of_different_radii_carry_their_loads(name: str) -> None:
    """2 mm of difference are 1.3 mrad of roll, or a wheel that one load on the axle leaves in the air."""
    own = contact(name)
    solved = wheels_under_load(own, rolling(z=5e-3), LOAD, expected=EXPECTED)
    assert [solved.results[side].force[2] for side in SIDES] == pytest.approx([LOAD, LOAD], rel=1e-6)
    assert solved.state.roll == pytest.approx(1e-3 / 0.75, rel=0.1)
    level = axle_under_load(own, rolling(z=5e-3), 2 * LOAD, expected=EXPECTED)
    assert sum(level.results[side].force[2] for side in SIDES) == pytest.approx(2 * LOAD, rel=1e-6)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("y", [5e-3, -7e-3])
def test_wheels_under_a_newton(name: str, y: float) -> None:
    """The approach is 50 nm, far below the gaps that a roll opens: at 06d44fc 60 solves did not find it."""
    found = wheels_under_load(contact(name), rolling(y=y, yaw=1e-3), 1.0, expected=5e-8)
    for result in found.results.values():
        assert result.force[2] == pytest.approx(1.0, abs=1e-5)
        assert 2e-8 < result.approach < 2e-7


def test_loads_of_a_newton_are_allowed_and_listed() -> None:
    """At 06d44fc wheel loads below 1 kN and axle loads below 2 kN were refused."""
    with pytest.warns(UserWarning, match="wheel_load = 1: unusual"):
        solution = wr.Wheelset(model="standard").solve(wheel_load=1.0)
    np.testing.assert_allclose(solution.data["vertical_force"], 1.0, rtol=1e-5)
    solution = wr.Wheelset(model="standard").solve(axle_load=1.0, roll=1e-3)
    assert float(solution.data["vertical_force"].sum()) == pytest.approx(1.0, rel=1e-5)


@pytest.mark.parametrize(
    ("worn", "more", "at"),
    [
        (
            {},
            {"model": "standard", "normal": "hertz", "friction": 0.564, "gauge": 1.0, "flange_back_distance": 0.925},
            {"y": -6.848e-3, "yaw": -6.5e-4, "wheel_load": 1418.0, "speed": 7.0},
        ),
        (
            {"hollow": 2.09064e-4, "hollow_field": 2.58862e-4},
            {
                "bodies": "half-space",
                "strips": 8,
                "cells": 8,
                "laying_angle": 0.0,
                "friction": 0.0,
                "pads": True,
                "flange_back_distance": 1.363,
            },
            {"y": -5.35531e-3, "yaw": 2.9366e-3, "wheel_load": 120966.0, "speed": 0.55},
        ),
    ],
    ids=["standard", "pads"],
)
def test_a_wheel_that_climbs_a_flange_as_it_is_lowered(
    worn: dict[str, float], more: dict[str, object], at: dict[str, float]
) -> None:
    """Lowering one wheel rolls the axle, and it moves to its flange. Each carries its load at one height and roll."""
    pair = {"wheel": wheel("S1002", **worn).profile, "rail": wr.profile("60E1"), "radius": 0.464171}
    data = wr.Wheelset(**pair, **more).solve(roll="solve", **at).data
    assert list(data["status"].values) == ["converged", "converged"]
    np.testing.assert_allclose(data["vertical_force"], at["wheel_load"], rtol=1e-5)
    assert np.ptp(data["z"].values) == np.ptp(data["roll"].values) == 0.0


@pytest.fixture
def approaches(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Those of all solves on strips, m."""
    found: list[float] = []
    solve = LatticeContact.__call__

    def watched(own: LatticeContact, *arguments: Any) -> ContactResult:
        result = solve(own, *arguments)
        found.append(result.approach)
        return result

    monkeypatch.setattr(LatticeContact, "__call__", watched)
    return found


def test_search_for_a_roll_starts_where_no_wheel_is_far_too_deep(approaches: list[float]) -> None:
    """Alone each wheel carries its load 0.3 mm deep; the roll of both together presses the flange 2.4 mm into the rail,
    where solves with finer cells took 14 of 16 s.
    """
    pair = {"wheel": wheel("cone", slope=0.1, face=1.22).profile, "rail": wr.profile("60E1"), "radius": 0.389295}
    track = {"gauge": 1.52, "flange_back_distance": 1.448, "laying_angle": 0.025, "friction": 0.00634697}
    place = {"y": 7.88666e-3, "yaw": 6.00452e-4, "speed": 1.61836, "y_rate": -1.72794e-4}
    model = {"bodies": "half-space", "strips": 8, "cells": 8}
    data = wr.Wheelset(**pair, **track, **model).solve(wheel_load=129724.0, roll="solve", **place).data
    assert list(data["status"].values) == ["converged", "converged"]
    assert max(approaches) < 1e-3


def test_search_does_not_start_where_surfaces_hardly_touch(approaches: list[float]) -> None:
    """A cylinder overlaps a plane by 0.8 nm at the nominal height: solves there took minutes and 7 GB."""
    pair = {"wheel": wheel("cone", slope=0.0).profile, "rail": rail("flat", radius=0.01).profile, "radius": 0.597464}
    track = {"gauge": 1.067, "flange_back_distance": 0.992, "laying_angle": 0.0, "friction": 0.0}
    model = {"bodies": "half-space", "strips": 8, "cells": 8}
    data = wr.Wheelset(**pair, **track, **model).solve(y=0.0, wheel_load=104377.0, sides=("right",), speed=0.67).data
    assert list(data["status"].values) == ["converged"]
    assert min(approaches) > 1e-6
