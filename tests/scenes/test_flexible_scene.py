"""Scenes and arguments with an elastic axle and rails on pads: what they accept, what they return, and what is off."""

from __future__ import annotations

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.scenes.contacts import solve as solve_module
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import WheelsetScene, parse_scene

BODIES = {"rail": "UIC60-benchmark", "friction": 0.0}


def scene(text: str) -> WheelsetScene:
    parsed = parse_scene(f'kind = "wheelset"\n{text}')
    assert isinstance(parsed, WheelsetScene)
    return parsed


def test_off_by_default() -> None:
    assert not scene("").is_flexible
    assert not scene("[wheelset]\naxle = false\n[track]\npads = false").is_flexible
    assert scene("").wheelset.roll == 0.0


@pytest.mark.parametrize("text", ["[wheelset.axle]", "[track.pads]", "[wheelset]\naxle = true", "[track]\npads = true"])
def test_an_empty_table_switches_on_and_solves_the_roll(text: str) -> None:
    flexible = scene(text)
    assert flexible.is_flexible
    assert flexible.wheelset.roll == "solve"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[wheelset.axle]\ndiameter = 160.0", "160 mm is 0.160"),
        ("[wheelset.axle]\nsteps = [[0.65, 0.16]]", "required together"),
        ("[wheelset.axle]\ndiameter = 0.16\nsteps = [[1.1, 0.16]]\njournal = [0.9, 1.1]", "combined with steps"),
        ("[wheelset]\nroll = 0.0\n[wheelset.axle]", '"solve"'),
        ('model = "standard"\n[wheelset.axle]', 'model = "condensed"'),
        ('sides = ["left"]\n[track.pads]\n[wheelset]\nz = 0.0', "sides"),
        ("[track.pads]\nvertical = 100.0", "100 kN/mm is 100e6"),
        ("[track.pads]\nstiffness = 1e8", "stiffness"),
    ],
)
def test_refuses_what_does_not_fit(text: str, reason: str) -> None:
    with pytest.raises(SceneError, match=reason):
        scene(text)


def test_refuses_an_axle_that_does_not_fit_the_wheel() -> None:
    drawing = {"steps": [[0.80, 0.16], [1.08, 0.13]], "journal": [0.92, 1.08]}
    with pytest.raises(SceneError, match=r"wheelset\.axle.*ends of the hub"):
        wr.Wheelset(**BODIES, axle=drawing).solve()


def test_a_wheelset_that_does_not_ask_computes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(*_: object) -> None:
        raise AssertionError("flexibility of a rigid wheelset")

    monkeypatch.setattr(solve_module, "flexibility", forbidden)
    plain = wr.Wheelset(**BODIES).solve(y=2e-3, roll="solve")
    off = wr.Wheelset(**BODIES, axle=False, pads=False).solve(y=2e-3, roll="solve")
    for side, result in plain.results.items():
        np.testing.assert_array_equal(result.force, off.results[side].force)
        np.testing.assert_array_equal(result.moment, off.results[side].moment)
    assert not {"hub_motion", "rail_motion", "axle_stress"} & set(plain.data)


def test_solution_has_motions_and_stress() -> None:
    solution = wr.Wheelset(**BODIES, axle=True, pads=True).solve(y=0.0)
    data = solution.data
    assert solution.ok
    np.testing.assert_allclose([result.force[2] for result in solution.results.values()], 57e3, rtol=1e-6)
    assert 1e3 * float(data["hub_motion"].sel(side="left")[3]) == pytest.approx(-1.31, abs=0.02)
    assert 1e3 * float(data["rail_motion"].sel(side="right")[1]) == pytest.approx(-0.29, abs=0.01)
    # Bending moment between the wheels: wheel load less own weight, times the overhang of the journals, closed form.
    assert float(data["axle_stress"].sel(side="left")[0]) == pytest.approx(-31.2e6, rel=0.02)
    estimate = wr.Wheelset(**BODIES, axle=True).solve(y=0.0, error_estimate=True).results["left"].error_estimate
    assert estimate is not None
    assert 0.0 <= estimate.force < 0.01 * 57e3


def test_given_height_and_axle_load() -> None:
    wheelset = wr.Wheelset(**BODIES, axle=True, pads=True)
    low = wheelset.solve(y=0.0, z=-1e-3)
    assert low.ok
    force = low.results["left"].force[2]
    total = wheelset.solve(y=0.0, axle_load=2 * force)
    assert float(total.data["z"][0]) == pytest.approx(-1e-3, abs=1e-8)


def test_half_spaces_may_be_flexible_too() -> None:
    wheelset = wr.Wheelset(**BODIES, bodies="half-space", pads={"vertical": 60e6, "lateral": 30e6})
    solution = wheelset.solve(y=0.0)
    assert solution.ok
    assert float(solution.data["rail_motion"].sel(side="left")[1]) < -4e-4


def test_sleepers_belong_to_pads_and_to_a_place() -> None:
    with pytest.raises(SceneError, match=r"sleepers.*only with pads"):
        scene("[track.sleepers]")
    assert scene("[track.pads]\n[track.sleepers]\nposition = 0.3").track.sleepers is not None
    with pytest.raises(SceneError, match=r"track\.sleepers: not allowed in an element"):
        wr.Wheelset(**BODIES, bodies="half-space", pads=True, sleepers=True).element()
