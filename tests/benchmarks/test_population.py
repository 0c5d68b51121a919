"""The population of situations: what it draws, its oracle against closed forms, and faults that its judge detects."""

from __future__ import annotations

import builtins
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import wheelrail as wr
from benchmarks.population import judge as judge_module
from benchmarks.population.checks import PARABOLIC, TOUCH, _connected, between_points, broken, lowering, within_strip
from benchmarks.population.draw import Situation, situation
from benchmarks.population.explanations import _below_points, _extent, explanation, resting_rolls
from benchmarks.population.judge import faults, judged, of_exception
from benchmarks.population.oracle import Position, RigidSide, Section
from benchmarks.population.pairs import Ellipse
from benchmarks.population.pairs import drawn as drawn_pair
from benchmarks.population.pairs import faults as pair_faults
from benchmarks.population.pairs import judged as judged_pair
from benchmarks.population.profiles import Shape, rail, wheel
from benchmarks.population.report import reproduction, show
from benchmarks.population.results import SideResult, side_result, solved
from benchmarks.population.workers import Plan, verdicts
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState

MANY = 250  # situations


def arguments_of(line: str, monkeypatch: pytest.MonkeyPatch) -> tuple[dict[str, Any], dict[str, Any]]:
    """Arguments of a line of Python, shapes in place of profiles."""
    monkeypatch.setattr(Shape, "profile", property(lambda shape: shape))
    made: list[dict[str, Any]] = []

    class Wheelset:
        def __init__(self, **arguments: Any) -> None:
            made.append(arguments)

        def solve(self, **arguments: Any) -> None:
            made.append(arguments)

    builtins.eval(line, {"wr": SimpleNamespace(Wheelset=Wheelset), "wheel": wheel, "rail": rail})
    return made[0], made[1]


def test_a_seed_gives_one_situation_and_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    for seed in range(40):
        drawn = situation(seed)
        assert drawn == situation(seed)
        assert arguments_of(str(drawn), monkeypatch) == (drawn.wheelset, drawn.solve)
        assert drawn.mirrored().mirrored() == drawn


def test_the_population_covers_its_ranges() -> None:
    many = [situation(seed) for seed in range(MANY)]
    for name, low, high in (("y", -0.05, 0.05), ("yaw", -0.02, 0.02), ("speed", 0.2, 60.0)):
        values = np.array([own.solve[name] for own in many])
        assert values.min() < low
        assert values.max() > high
    loads = np.array([own.solve["wheel_load"] for own in many if "wheel_load" in own.solve])
    assert loads.min() < 10.0
    assert loads.max() > 1.4e5
    assert {own.wheelset["gauge"] for own in many} >= {1.0, 1.435, 1.676}
    assert {own.wheelset["wheel"].base for own in many} == {"S1002", "cone", "disc"}
    assert {own.wheelset["rail"].base for own in many} == {"60E1", "arcs", "groove", "flat"}
    kinds = {next(key for key in ("wheel_load", "axle_load", "z") if key in own.solve) for own in many}
    assert kinds == {"wheel_load", "axle_load", "z"}
    models = {(own.wheelset.get("model"), own.wheelset.get("bodies"), own.wheelset.get("points")) for own in many}
    assert models >= {("standard", None, None), (None, "half-space", None), (None, "waveguide", "grid")}


def roller(radius: float = 0.46, crown: float = 0.3) -> RigidSide:
    """A roller with a crown radius on a flat rail, its centre 10 mm to the field side of the rail's."""
    return RigidSide(wheel("disc", crown=crown), rail("flat"), 0.0, radius, 0.46, 0.76, 1.435, 0.014)


@pytest.mark.parametrize("roll", [0.0, 5e-3, -8e-3])
@pytest.mark.parametrize("yaw", [0.0, 2e-2])
def test_first_contact_of_a_torus_on_a_plane(roll: float, yaw: float) -> None:
    side, crown = roller(), 0.3
    # splines overshoot the ends of the rail's flat top by 2e-8 m
    # the centres of the crown's circles lie on one of radius R - crown about the axle
    lowest = 0.46 + 0.76 * np.sin(roll) - (0.46 - crown) * np.cos(roll) - crown
    assert side.first_contact(Position(0.0, 0.0, roll, yaw)) == pytest.approx(-lowest, abs=5e-8)
    for z in (-2e-4, 1e-3):
        deepest = side.section(Position(0.0, z, roll, yaw)).depth.max()
        assert deepest == pytest.approx(-lowest - z, abs=5e-8)


def test_the_gauge_of_an_inclined_rail() -> None:
    from wheelrail.meshes.profiles.named import named_profile

    side = replace(roller(), rail=rail("60E1"), inclination=0.05)
    assert side.rail_y == pytest.approx(named_profile("60E1").inclined(0.05).gauge_offset(1.435, 0.014), abs=2e-6)


@cache
def example() -> tuple[Situation, SideResult]:
    """The left side of a situation with the standard contact, in a curve."""
    own = Situation(
        0,
        {
            **{"wheel": wheel("S1002"), "rail": rail("60E1"), "laying_angle": 0.025, "radius": 0.46, "gauge": 1.435},
            **{"flange_back_distance": 1.36, "curvature": 0.0, "friction": 0.3, "model": "standard"},
        },
        {"y": 2e-3, "yaw": 1e-3, "roll": 0.0, "wheel_load": 6e4, "speed": 20.0},
    )
    return own, side_result(solved(own).data, "left")


def test_a_right_result_breaks_nothing() -> None:
    own, result = example()
    assert broken(own, "left", result) == []


@pytest.mark.parametrize(
    ("planted", "found"),
    [
        ({"force": (0.0, 0.0, 5.9e4)}, "vertical force 59000"),
        ({"moment": (0.0, 0.0, 0.0)}, "the moment differs"),
        ({"approach": 1e-5}, "where the overlap is"),
        ({"z": -1e-3}, "where the overlap is"),
        ({"roll": 1e-3}, "roll 0.001 rad where 0 is given"),
        ({"status": "separated"}, "separated with an overlap"),
        ({"force": (np.nan, 0.0, 6e4)}, "force is not finite"),
        ({"bands": -2e-2}, "remains outside the contacts"),
        ({"pressure": -0.02}, "tension of"),
        ({"traction": 5.0}, "sum of the tractions"),
        ({"slip": -1.0}, "friction does work"),
    ],
)
def test_planted_faults_are_detected(planted: dict[str, Any], found: str) -> None:
    own, result = example()
    ((name, value),) = planted.items()
    if name == "bands":
        value = result.bands + value
    elif name == "pressure":
        value = np.where(np.arange(len(result.pressure)) == 0, value * result.pressure.max(), result.pressure)
    elif name in ("traction", "slip"):
        value = value * getattr(result, name)
    elif isinstance(value, tuple):
        value = np.array(value)
    texts = broken(own, "left", replace(result, **{name: value}))
    assert any(found in text for text in texts), texts


def test_axes_of_a_rail_on_pads_are_turned_by_its_roll() -> None:
    """The force is that of the tractions; the moved rail's axes were taken for the track's, 3e-3 of the load off."""
    own, _ = example()
    pads = {**own.wheelset, "bodies": "half-space", "strips": 6, "cells": 6, "pads": True}
    del pads["model"]
    padded = replace(own, wheelset=pads, solve={**own.solve, "y": 1e-3, "roll": "solve"})
    for side in SIDES:
        assert broken(padded, side, side_result(solved(padded).data, side)) == []


def test_paraboloid_of_a_patch_whose_strips_shorten_linearly() -> None:
    """Peak of FASTSIM's bound over mu times that of the pressure: 4/3 on an ellipse, pi/2 on a lens."""
    t = np.linspace(0.0, 1.0, 20001)
    for half, ratio in ((np.sqrt(1.0 - t**2), 4.0 / 3.0), (1.0 - t, PARABOLIC)):
        load, volume = 0.5 * np.pi * (half**2).mean(), 4.0 / 3.0 * (half**3).mean()
        assert load / volume == pytest.approx(ratio, rel=1e-3)


def test_overlaps_connected_to_a_patch() -> None:
    overlaps = np.array([0, 1, 1, 1, 0, 1, 1, 0], dtype=bool)
    inside = np.array([0, 0, 1, 0, 0, 0, 0, 0], dtype=bool)
    np.testing.assert_array_equal(_connected(overlaps, inside), [0, 1, 1, 1, 0, 0, 0, 0])


def test_wheels_that_cannot_both_rest() -> None:
    own, _ = example()
    assert resting_rolls(own) == pytest.approx([0.0], abs=1e-3)
    narrow = replace(own, solve={**own.solve, "y": -0.2})
    assert resting_rolls(narrow) == []


def test_the_lowering_of_half_spaces_is_that_of_a_point_load_far_away() -> None:
    _, result = example()
    far = result.position[:1] + np.array([0.0, 0.5, 0.0])
    normal = (result.pressure * result.area).sum()
    assert lowering(far, result)[0] == pytest.approx(2 * 0.91 * normal / (np.pi * 2.1e11 * 0.5), rel=2e-2)


def test_the_load_of_an_axle_is_that_of_both_wheels() -> None:
    own, result = example()
    axle = replace(own, solve={**{k: v for k, v in own.solve.items() if k != "wheel_load"}, "axle_load": 1.3e5})
    assert any("130000 N are asked for" in text for text in faults(axle, {"left": result, "right": result}))


def test_exceptions_and_failures() -> None:
    from wheelrail.scenes.schema.errors import SceneError

    own, _ = example()
    light = replace(own, solve={**own.solve, "wheel_load": 0.5})
    text = "Wheelset: wheel_load = 0.5: must be a number from 1 to 1e+06 N"
    assert of_exception(light, SceneError(text))[0] == "explained failure"
    assert of_exception(own, SceneError(text))[0] == "unexplained failure"
    assert of_exception(own, ZeroDivisionError("division by zero"))[0] == "wrong"
    failed = replace(example()[1], status="failed: 60000 N not reached within 0.05 m, nearest 0 N")
    assert explanation(own, "left", failed) == ""
    beside = replace(own, wheelset={**own.wheelset, "gauge": 1.676}, solve={**own.solve, "y": -9e-2})
    assert explanation(beside, "left", failed) == "beside the rail"


@pytest.mark.parametrize(
    ("y", "z", "reason"),
    [
        (-55.0, 28.0, "names an overlap of the flange"),
        (-48.3, 26.0, "names an overlap of the flange"),
        (-20.0, 0.7, ""),
        (50.0, -1.2, ""),
    ],
)
def test_a_failure_that_names_an_overlap(y: float, z: float, reason: str) -> None:
    own, result = example()
    groove = replace(own, wheelset={**own.wheelset, "rail": rail("groove", depth=27e-3), "laying_angle": 0.0})
    status = f"failed: the wheel overlaps the rail 1.2 mm deep at y = {y}, z = {z} mm of its profile, where it ends"
    assert explanation(groove, "left", replace(result, status=status)) == reason


def test_verdicts_and_their_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    own, _ = example()
    right = judged(own)
    assert (right.kind, right.reason) == ("right", "")
    monkeypatch.setattr(judge_module, "solved", lambda _: (_ for _ in ()).throw(ZeroDivisionError("division by zero")))
    wrong = judged(own)
    assert wrong.kind == "wrong"
    assert reproduction(right) == ""
    assert f"\n{own}\n" in reproduction(wrong)
    assert "| standard | 1 | 0 | 0 | 1 |" in show([right, wrong])


def test_a_situation_without_an_end_is_a_failure() -> None:
    (verdict,) = verdicts([3], Plan(limit=0.0, quick=True))
    assert verdict.kind == "unexplained failure"
    assert verdict.reason == "no result in 0 s"


def test_a_corner_is_not_smoothed() -> None:
    """The outline of a chamfer stays below both of its lines; a spline through it overshot by 8 um."""
    side = replace(roller(), wheel=wheel("S1002"))
    y, z = side.wheel_points.T
    near = np.abs(y - 60e-3) < 2e-3
    tread = np.polyval(np.polyfit(*side.wheel_points[(y > 57e-3) & (y < 59.5e-3)].T, 2), y)
    assert (z - tread)[near].max() < 1e-6
    assert side.corners[np.argmin(np.abs(y - 60e-3))]
    assert not side.corners[np.abs(y) < 50e-3].any()


@pytest.mark.parametrize("radius", [5e-3, 10e-3])
def test_the_origin_of_a_flat_rail_is_its_middle(radius: float) -> None:
    """Points of a spline that are 2e-8 m higher at one edge of the top set the origin there, 27 mm off."""
    shape = rail("flat", radius=radius)
    y = shape.profile.point(shape.profile.s_range)[:, 0]
    assert y.sum() == pytest.approx(0.0, abs=1e-4)
    assert replace(roller(), rail=shape).rail_points[[0, -1], 0].sum() == pytest.approx(0.0, abs=2e-4)


def test_tension_that_more_cells_keep_is_solved_on_narrower_strips() -> None:
    """A worn flange under 4.3 GPa on five strips, 30 um beside the position of seed 20055."""
    worn, head = wheel("S1002", tread=0.000629231, flange=0.00224824), rail("arcs", crown=0.5, radius=0.013)
    pair = wr.Wheelset(worn.profile, head.profile, laying_angle=0.05, radius=0.585488, gauge=1.435, friction=0.108496,
                       flange_back_distance=1.36, bodies="half-space", strips=9, cells=10)  # fmt: skip
    found = pair.solve(y=-6.06796e-3, z=0.462937e-3, roll=-7.03029e-3, yaw=-1.74001e-3, speed=19.1234,
                       z_rate=-9.88798e-4, yaw_rate=3.2967e-4, sides=("right",))  # fmt: skip
    assert found.status == "converged"
    fields = found.results["right"].fields
    assert fields is not None
    assert fields.pressure.min() >= 0.0


def test_tension_found_from_an_earlier_result_is_not_kept() -> None:
    """Seed 730358: from 30 um aside 20 cells were taken for tension that ten have not, 2.3e-3 of the force off."""
    pair = wr.Wheelset(
        wheel=wheel("cone", slope=0.05, face=1.309, hollow_field=0.00102591, flange=0.000482342).profile,
        rail=rail("flat", radius=0.01).profile, laying_angle=0.0505453, radius=0.352314, gauge=1.067,
        flange_back_distance=0.992, friction=0.515148, bodies="half-space", strips=14, cells=10,
    ).element().contact  # fmt: skip
    state = WheelsetState(y=6.25888e-3, z=1.36941e-3, roll=-1.04557e-4, speed=17.8632, pitch_rate=50.7454)
    aside = replace(state, y=state.y + 3e-5, z=state.z + 1e-5)
    (near,), (cold,) = (pair.solve_side([at], "left", [None]) for at in (aside, state))
    (warm,) = pair.solve_side([state], "left", [near])
    np.testing.assert_allclose(warm.force, cold.force, atol=2e-5 * np.linalg.norm(cold.force))


def test_an_outermost_strip_with_several_places() -> None:
    """Seeds 730093 and 700345: its place is that of the pose, not that of the start; 2e-5 and 7e-5 of the force off."""
    worn = wr.Wheelset(
        wheel=wheel("S1002", hollow=0.000415191, flange=0.000761498).profile,
        rail=rail("arcs", crown=0.254, radius=0.013).profile, laying_angle=0.05, radius=0.46843, gauge=1.465,
        flange_back_distance=1.393, curvature=0.000294066, friction=0.3, bodies="half-space", strips=6, cells=7,
    )  # fmt: skip
    new = wr.Wheelset(
        wheel=wheel("S1002").profile, rail=rail("flat", radius=0.01).profile, laying_angle=0.05, radius=0.384944,
        gauge=1.435, flange_back_distance=1.353, friction=0.3, bodies="half-space", strips=11, cells=13,
    )  # fmt: skip
    turned = WheelsetState(y=6.14135e-3, z=1.299639818e-3, roll=9.12841e-5, yaw=0.0222373, speed=0.30985,
                           pitch_rate=0.30985 / 0.46843, frame_rate=(0.0, 0.0, 0.30985 * 0.000294066))  # fmt: skip
    straight = WheelsetState(y=-0.01099, z=4.863740e-3, speed=19.2452, pitch_rate=49.928)
    for wheelset, state, side in ((worn, turned, "left"), (new, straight, "right")):
        pair = wheelset.element().contact
        aside = replace(state, y=state.y + 3e-5, z=state.z + 1e-5)
        (near,), (cold,) = (pair.solve_side([at], side, [None]) for at in (aside, state))
        (warm,) = pair.solve_side([state], side, [near])
        np.testing.assert_allclose(warm.force, cold.force, atol=1e-6 * np.linalg.norm(cold.force), err_msg=side)


@pytest.mark.filterwarnings("ignore:.*the head leans")
def test_crests_of_strips_on_a_steep_flange() -> None:
    """Seed 730339: the search from the flange's tip did not end, and left strips 9 mm off that touch; the normal force
    jumped by 5 % from one height to the next.
    """
    pair = wr.Wheelset(
        wheel=wheel("cone", slope=0.05, face=1.309).profile, rail=rail("60E1", side=0.00243464).profile,
        laying_angle=0.05, radius=0.582204, gauge=1.52, flange_back_distance=1.445, curvature=-0.000362499,
        friction=0.3, bodies="half-space", strips=7, cells=8,
    ).element().contact  # fmt: skip
    normal = []
    for z in (-1.1128e-4, -1.115e-4, -1.11779e-4):
        state = WheelsetState(y=-5.48222e-3, z=z, yaw=0.0151138, speed=1.64826, pitch_rate=1.64826 / 0.582204)
        (found,) = pair.solve_side([state], "right", [None])
        normal.append(sum(patch.normal_force for patch in found.patches))
    np.testing.assert_allclose(normal, normal[0], rtol=3e-3)


def section_of_parabola(curvature: float) -> Section:
    y = np.linspace(-5e-3, 5e-3, 2001)
    return Section(y, np.column_stack([0.0 * y, y, 0.0 * y]), 1e-4 - 0.5 * curvature * y**2, 0.0 * y)


def test_what_strips_and_grids_do_not_resolve() -> None:
    """Of a parabola on n strips at the worst place 4/3 n^-2 of its depth; half a cell beside its top between points."""
    own, result = example()
    section = section_of_parabola(50.0)
    half = np.sqrt(2e-4 / 50.0)
    wide = replace(result, bands=np.array([[-half, half]]), strips=np.array([5.0]))
    assert within_strip(section, wide) == pytest.approx(1e-4 * 4.0 / 3.0 / 4.0**2, rel=0.02)
    assert within_strip(section, replace(wide, strips=np.zeros(1))) == 0.0
    grid = replace(own, wheelset={**own.wheelset, "surface_size": 2e-3})
    assert between_points(grid, section, 1000) == pytest.approx(0.5 * 50.0 * 1e-3**2)
    assert between_points(own, section, 1000) == 0.0


def test_failures_under_pressure_without_bound() -> None:
    """On the corner of a rim, and on a flange that friction holds down."""
    own, result = example()
    failed = replace(
        result, status="failed: the bodies overlap by 0.1 mm, too deep for half-spaces: 30 GPa are above ..."
    )
    assert explanation(own, "left", failed) == ""
    rim = replace(own, solve={**own.solve, "y": -0.0835})
    assert explanation(rim, "left", failed).startswith("carried by a corner of the wheel")
    rough = {**own.wheelset, "friction": 0.95}
    held, climbing = (
        replace(own, wheelset=rough, solve={**own.solve, "y": 0.008, "yaw": yaw}) for yaw in (-0.025, 0.025)
    )
    named = "failed: the wheel overlaps the rail 0.3 mm deep at y = 0.0, z = 0.0 mm of its profile, it ends"
    for failure in (failed, replace(result, status=named)):
        reasons = [explanation(case, "left", failure) for case in (held, climbing)]
        assert sorted(reasons) == ["", "held down by friction on its flange to an overlap of half a millimetre"]


@pytest.mark.parametrize("yaw", [0.02, -0.02])
def test_the_extent_of_an_overlap_is_from_the_axle(yaw: float) -> None:
    """On a cone of slope 0.05 the silhouette lies 0.05 yaw r from below the axle, whose end is wheel_y yaw off."""
    rolling = Situation(0, {**example()[0].wheelset, "wheel": wheel("cone", slope=0.05)}, {"y": 0.0, "yaw": yaw})
    rigid, depth = rolling.rigid["left"], 1e-4
    at = rolling.position("left", 0.0, 0.0)
    at = replace(at, z=rigid.first_contact(at) - depth)
    _, result = example()
    own = replace(result, z=at.z, roll=0.0, origin=np.array([-rigid.wheel_y * np.sin(yaw), 0.0, rigid.radius]))
    half = np.sqrt(2.0 * rigid.radius * depth)
    assert _extent(rolling, "left", own) == pytest.approx(half + 0.05 * 0.02 * rigid.radius, rel=0.03)


def test_a_scan_goes_on_where_no_line_has_failed() -> None:
    """Seed 800108: lines of a flange's tip followed one whose search had run to the rail's foot, "81.5 mm deep"."""
    pair = wr.Wheelset(
        wheel=wheel("cone", slope=0.05, face=1.22).profile, rail=rail("60E1", corner=0.000603921).profile,
        laying_angle=0.1, radius=0.46, gauge=1.435, flange_back_distance=1.358, curvature=0.000702494, friction=0.0,
        model="standard", normal="hertz",
    )  # fmt: skip
    found = pair.solve(y=-4.60082e-3, z=-7.767916297e-4, roll=-3.28634628e-4, yaw=0.0163129, speed=3.75344)
    assert found.status == "converged"


def test_a_file_does_not_say_how_a_corner_is_rounded() -> None:
    """A spline through all points overshoots the chamfer of the rim of S1002; a cone without one has no corner."""
    chamfered, smooth = (replace(situation(50079).rigid["left"], wheel=own) for own in (wheel("S1002"), wheel("cone")))
    assert 5e-6 < chamfered.rounding < 12e-6
    assert smooth.rounding < 1e-9


def test_wheels_whose_wear_was_calculated_lose_their_depth() -> None:
    """The profile passes the points that are moved by the depth, and its radius falls by that."""
    drawn = next(own for seed in range(MANY) if "abraded" in repr((own := situation(seed)).wheelset["wheel"]))
    shape = replace(drawn.wheelset["wheel"], parameters=(("abraded", 1.5e-3),))
    for own in (shape, drawn.wheelset["wheel"]):
        points = own.points[(np.abs(own.points[:, 0]) < 0.04)]
        assert np.abs(own.profile.closest(points).distance).max() < TOUCH  # which the oracle allows
    points = replace(drawn.rigid["left"], wheel=shape).wheel_points
    assert np.interp(0.0, *points.T) == pytest.approx(-1.5e-3 * np.cos(0.5 * np.pi * 8 / 25) ** 2, rel=0.02)


def test_wheels_below_the_points_of_a_meshed_rail_are_explained() -> None:
    own = situation(850018)
    assert _below_points(own, "left", (-40.9e-3, 19.4e-3), 3.02e-3, own.solve["roll"])
    assert not _below_points(own, "left", (-40.9e-3, 19.4e-3), 5e-4, own.solve["roll"])


def test_ellipses_of_pairs() -> None:
    """Spheres, in closed form: a^3 = 3 F R / 4 E*, approach a^2 / R, peak 3 F / 2 pi a^2."""
    load, radius, modulus = 1e4, 0.3, 1.1e11
    circle = Ellipse.of(0.5 / radius, 0.5 / radius, modulus, load, None)
    a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
    expected = (a, a, a * a / radius, 1.5 * load / (np.pi * a * a))
    np.testing.assert_allclose((*circle.axes, circle.approach, circle.peak), expected, rtol=1e-9)
    other = Ellipse.of(1.0, 0.2, modulus, None, 1e-5)
    np.testing.assert_allclose(Ellipse.of(1.0, 0.2, modulus, other.force, None).approach, 1e-5, rtol=1e-9)
    assert other.axes[0] < other.axes[1]


def test_pairs_are_judged() -> None:
    for seed in (2, 3, 32, 34):
        verdict = judged_pair(seed)
        assert verdict.kind == "right", verdict
    own = next(pair for pair in map(drawn_pair, range(20)) if pair.kind == "half-space lattice")
    result = own.solved()
    assert not [*pair_faults(own, result)]
    for change in (
        {"peak": 1.02 * result.peak},
        {"approach": 1.01 * result.approach},
        {"traction": result.traction + result.peak.max()},
    ):
        assert [*pair_faults(own, replace(result, **change))], change
