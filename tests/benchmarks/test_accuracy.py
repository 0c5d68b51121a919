"""Accuracy beside closed forms, Kalker's table and CONTACT on a small part of `benchmarks.accuracy.report`.

HOLDS is what the discretisation reaches today, TARGET what it is to reach; where both differ the target is not reached.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

from benchmarks.accuracy.contact_frames import FrameDifference, difference, rail_position, state, wheel_force
from benchmarks.accuracy.fastsim import Bound, contact_fastsim, errors, standard
from benchmarks.accuracy.rolling import coefficients, curve_errors
from benchmarks.accuracy.wheelset import loaded_wheel, track_of
from benchmarks.common.hertz_cases import block_correction, pair_of, reference_steel
from benchmarks.common.models import Ellipse, frictional, hertz_model, loads, pressed, rolling, solved, wheelset_model
from benchmarks.common.reference_table import TableSection, measure, reference, show
from benchmarks.error_vs_time.cases import TimedCase, creep_cases
from wheelrail.contact.analytical.kalker import Name, kalker
from wheelrail.contact.elasticity.compliance import Compliance
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array, Nodes

TARGET = {
    "p0": 0.5,  # %
    "axes": 1.0,  # %
    "approach": 1.0,  # %
    "Kalker": 1.0,  # %
    "creep RMS": 0.4,  # % of mu F_n
    "creep worst": 1.0,  # % of mu F_n
    "moment": 2.0,  # % of its largest
    "place": 0.3,  # mm
    "area": 3.0,  # %
    "peak": 2.0,  # %
    "force": 1.5,  # % of mu F_n
}
HOLDS = {
    **TARGET,
    "force": 2.0,  # not reached: 1.8 on the tread, against CONTACT's conformal variant; flange 0.2
}
NARROW = 5.0  # %, finite bodies at y = 0: load shifts to the narrow local maximum; half-spaces reach the target
PUSHED = 8.0  # %, difference of areas between finite bodies and half-spaces, as sections rotate under the load
ROLLED = 2.2  # % of mu N, the same of longitudinal forces: the wheel rolls on another radius; 1.9 at y = 2 mm, left
STEEL = Material(2.1e11, 0.3)
COARSE = 1e-3  # m


def test_bounds_of_the_tests_are_not_stricter_than_targets() -> None:
    assert all(HOLDS[name] >= target for name, target in TARGET.items())


def test_hertz_at_twenty_points_across() -> None:
    (case,) = (case for case in reference("hertz")["cases"] if case["name"] == "circ_R300_50kN")
    assert reference_steel() == STEEL
    pair = pair_of(case, STEEL)
    assert pair.exact.peak == pytest.approx(1e6 * case["hertz"]["p0"], rel=1e-6)
    size = pair.size(across=20.0)
    depth, result = pressed(pair, size)
    (patch,) = result.patches
    kappa, spread = block_correction(STEEL.nu)
    assert abs(spread) < 0.01  # the correction is proportional to the inverse of the block size
    approach = depth + 2 * kappa * pair.load / (STEEL.E * pair.half_width(size))
    assert abs(patch.max_pressure / pair.exact.peak - 1) < 1e-2 * HOLDS["p0"]
    np.testing.assert_allclose(patch.semi_axes, pair.exact.semi_axes, rtol=1e-2 * HOLDS["axes"])
    assert abs(approach / pair.exact.approach - 1) < 1e-2 * HOLDS["approach"]
    assert abs(approach / pair.exact.approach - 1) < 0.5 * abs(depth / pair.exact.approach - 1)


@pytest.mark.parametrize("ratio", [0.3, 1.0, 1 / 0.3])
def test_pair_has_the_requested_axis_ratio(ratio: float) -> None:
    a, b = Ellipse.of_ratio(ratio, 0.46, 57e3, STEEL).exact.semi_axes
    assert a / b == pytest.approx(ratio, rel=1e-6)


def test_kalkers_coefficients() -> None:
    pair = Ellipse.of_ratio(1.0, 0.46, 57e3, STEEL)
    found, points = coefficients(pair, pair.size(points=285))
    assert points <= 300
    names: tuple[Name, ...] = ("C11", "C22", "C23")
    table = [kalker(name, 1.0, STEEL.nu) for name in names]
    np.testing.assert_allclose(found[:3], table, rtol=1e-2 * HOLDS["Kalker"])
    assert found[2] == pytest.approx(found[3], rel=0.02)  # reciprocity of spin and lateral creepage


def test_creep_curves() -> None:
    forces, moments = [], []
    for curve in reference("creep_curves")["curves"][1:]:
        errors, points = curve_errors(curve, LatticeResolution(), every=5)
        assert points <= 300
        forces.append(100 * errors[:, :2])
        moments.append(100 * errors[:, 2] / np.abs([case[6] for case in curve["cases"]]).max())
    e = np.concatenate(forces)
    assert np.sqrt((e**2).mean()) < HOLDS["creep RMS"]
    assert np.abs(e).max() < HOLDS["creep worst"]
    assert np.abs(np.concatenate(moments)).max() < HOLDS["moment"]


@pytest.mark.parametrize(
    ("bound", "grid", "force"),
    [("parabolic", 44, -0.6118), ("parabolic", 220, -0.6359), ("elliptic", 44, -0.6016), ("elliptic", 220, -0.5956)],
)
def test_fastsim_is_that_of_contact(bound: Bound, grid: int, force: float) -> None:
    """Printed results of its example `fastsim` (revision of 2025): 8 x 4 mm, 82 kN, lateral creepage and spin."""
    radius, steel = 0.5, Material(2 * 1.28 * 82e9, 0.28)
    a, _ = Ellipse.of_ratio(2.0, radius, 82e3, steel).exact.semi_axes
    pair = Ellipse.of_ratio(2.0, radius * (8e-3 / a) ** 3, 82e3, steel)
    np.testing.assert_allclose(pair.exact.semi_axes, (8e-3, 4e-3), rtol=1e-6)
    found = contact_fastsim(TimedCase(pair, 0.3, (0.0, -6.25e-4, 0.625), None), bound, grid, 1.1)
    np.testing.assert_allclose(found, (0.0, force), atol=6e-5)


def test_standard_is_no_worse_than_fastsim_in_contact() -> None:
    cases = creep_cases(4)
    right = [np.array(case.contact_forces) for case in cases]
    own = np.hypot(*errors(standard, cases, right).T)
    for bound in ("parabolic", "elliptic"):
        other = np.hypot(*errors(partial(contact_fastsim, bound=bound, grid=44), cases, right).T)
        assert np.sqrt((own**2).mean()) < 0.85 * np.sqrt((other**2).mean())


def test_signs_of_creepage_and_spin() -> None:
    # the force opposes the creepage; spin causes a lateral force and an opposing moment
    pair = Ellipse.of_ratio(1.0, 0.46, 57e3, STEEL)
    size = pair.size(points=140)
    model = hertz_model(pair, frictional(0.3), size)
    depth, _ = pressed(pair, size)
    forward, left, turned = (
        loads(solved(model, depth, rolling(*creep))) for creep in ((1e-3, 0, 0), (0, 1e-3, 0), (0, 0, 0.3))
    )
    assert forward[0] < -1e3
    assert left[1] < -1e3
    assert left[2] > 0
    assert turned[1] < -1e3
    assert turned[2] < 0


@cache
def compared(
    series: str, y: float, side: Side, bodies: str = "waveguide", **choices: Any
) -> tuple[ContactResult, FrameDifference]:
    data = reference("wheelset")
    given = data["input"]
    normal = series == "normal_only"
    (case,) = (case for case in data["series"][series] if case["y"] == y)
    at = state(case, speed=given["speed"], pitch_rate=given["pitch_rate"])
    friction = 0.0 if normal else given["mu"]
    result = loaded_wheel(track_of(given), friction, at, side, given["load"], COARSE, bodies=bodies, **choices)
    return result, difference(result, case[side], side)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    ("series", "y"),
    [("normal_only", 0.0), ("normal_only", 3.0), ("rolling_conformal", 2.0), ("rolling_conformal", 4.5)],
)
def test_wheelset_on_half_spaces(series: str, y: float, side: Side) -> None:
    # the same bodies as CONTACT's: remaining differences are discretisation and the definition of creepage
    result, apart = compared(series, y, side, "half-space")
    assert result.force[2] == pytest.approx(57e3, rel=1e-4)
    assert apart.same_patches
    assert abs(1e3 * apart.position) < 0.1 * HOLDS["place"]
    assert abs(100 * apart.area) < HOLDS["area"]
    assert abs(100 * apart.peak) < HOLDS["peak"]
    if series != "normal_only":
        assert np.abs(apart.forces).max() / (0.3 * 57e3) < 1e-2 * HOLDS["force"]


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(("series", "y"), [("normal_only", 0.0), ("normal_only", 3.0), ("rolling_conformal", 2.0)])
def test_wheelset_of_finite_bodies(series: str, y: float, side: Side) -> None:
    result, apart = compared(series, y, side, cells=20)
    assert result.force[2] == pytest.approx(57e3, rel=1e-4)
    assert apart.same_patches
    assert abs(1e3 * apart.position) < HOLDS["place"]
    assert abs(100 * apart.area) < PUSHED
    assert abs(100 * apart.peak) < (HOLDS["peak"] if y else NARROW)
    if series != "normal_only":
        along, across = np.abs(apart.forces) / (0.3 * 57e3)
        assert along < 1e-2 * ROLLED
        assert across < 1e-2 * HOLDS["force"]


@pytest.mark.parametrize("points", ["lattice", "grid"])
def test_material_that_touches_and_common_surface_of_finite_bodies(points: str) -> None:
    """By an independent finite-element code (quadratic tetrahedra, its own gap and near field; positions within 0.02
    mm): 5.524 and 5.530 mm between the places on wheel and rail, wheel_y -17.811 and -28.369 mm, angles 127 and 292 to
    295 mrad. Undeformed, they were 5.378 and 5.402 mm, -17.956 and -28.471 mm, 130.0 and 296.4 mrad. A grid of 1 mm
    has one line in the patch on the flange, and its patch on the tread is 0.08 mm off.
    """
    result, _ = compared("normal_only", 5.0, "right", points=points)
    tread, flange = result.patches
    assert [1e3 * (patch.wheel_y - patch.rail_y) for patch in (tread, flange)] == pytest.approx(
        [5.524, 5.530], abs=0.02
    )
    assert 1e3 * tread.wheel_y == pytest.approx(-17.811, abs=0.04 if points == "lattice" else 0.1)
    assert -1e3 * tread.contact_angle == pytest.approx(127.0, abs=1.5)
    if points == "lattice":
        assert 1e3 * flange.wheel_y == pytest.approx(-28.369, abs=0.07)
        assert 290.5 < -1e3 * flange.contact_angle < 295.5


@dataclass(frozen=True)
class YieldingAlongTheAxle:
    """Compliance of a wheel that a force moves along its axle as a whole, besides, by flexibility [m/N]."""

    body: Compliance
    flexibility: float

    @property
    def shape(self) -> tuple[int, int]:
        return self.body.shape

    def turned(self, nodes: Nodes, directions: Sequence[int] = (0, 1, 2)) -> tuple[sp.csr_array, Array]:
        turn, matrix = self.body.turned(nodes, directions)
        axial = np.arange(1, len(matrix), 3)
        matrix[np.ix_(axial, axial)] += self.flexibility
        return turn, matrix


@pytest.mark.parametrize(("y", "z"), [(1.5e-3, -2.5e-4), (3.2e-3, -1.2e-4)])
def test_wheel_that_yields_along_its_axle_creeps_like_one_that_is_moved(y: float, z: float) -> None:
    """By 0.46 and 0.64 mm: longitudinal forces are 0.1 and 0.2 % of mu N apart, and would be 2.2 and 3.3 % if the slip
    counted the undeformed radius of the place on the wheel. Places of a patch on a 1 mm grid scatter by 0.8 %.
    """
    mu = 0.3
    track = track_of(reference("wheelset")["input"])
    contact = wheelset_model(track, frictional(mu), COARSE, points="grid")
    assert isinstance(contact.model, CondensedContact)
    flexibility = 4e-7  # m/N
    wheel = YieldingAlongTheAxle(contact.model.wheel, flexibility)
    yielding = replace(contact, model=replace(contact.model, wheel=wheel))
    at = WheelsetState(y=y, z=z, speed=2.0, pitch_rate=2.0 / track.radius)
    elastic = yielding(at, "left")
    displacement = flexibility * elastic.force[1]
    assert displacement < -4e-4
    moved = contact(replace(at, y=at.y + displacement), "left")
    assert abs(elastic.force[0] - moved.force[0]) < 1e-2 * mu * moved.force[2]
    assert elastic.force[2] == pytest.approx(moved.force[2], rel=2e-2)
    assert contact(at, "left").force[0] - moved.force[0] > 0.1 * mu * moved.force[2]


def test_two_patches_at_the_gauge_corner() -> None:
    result, apart = compared("normal_only", 5.0, "right", "half-space")
    assert apart.patches == (2, 2)
    assert abs(apart.load_fraction) < 0.01
    assert abs(apart.position) < 0.1e-3
    assert abs(np.diff([patch.rail_y for patch in result.patches])[0]) == pytest.approx(10e-3, abs=1e-3)


def test_frames_differ_by_half_a_turn_about_x() -> None:
    # wheelset to the right, right wheel lower, yaw about a downward axis, rolling forward
    seen = state({"y": 2.0, "roll": 1e-3}, speed=2000.0, pitch_rate=-4.35, yaw=5e-3)
    assert seen.y == pytest.approx(-2e-3)
    assert (seen.roll, seen.yaw, seen.pitch_rate, seen.speed) == (1e-3, -5e-3, 4.35, 2.0)
    # the load presses the rail down and the wheel up; forward on the rail is backward on the wheel
    np.testing.assert_array_equal(wheel_force([1.0, 2.0, 3.0]), [-1.0, 2.0, 3.0])
    # towards the gauge corner is to the right on the left rail and to the left on the right rail
    assert rail_position(10.0, "left") == rail_position(-10.0, "right") == pytest.approx(-10e-3)


@pytest.mark.parametrize("series", ["normal_only", "rolling"])
def test_references_are_mirror_images_at_y_zero(series: str) -> None:
    case = reference("wheelset")["series"][series][0]
    left, right = (case[side] for side in ("left", "right"))
    np.testing.assert_allclose(
        wheel_force(left["force"]), wheel_force(right["force"]) * [1, -1, 1], rtol=1e-5, atol=1e-3
    )
    places = [rail_position(case[side]["islands"][0]["y_rail"], side) for side in SIDES]
    assert places[0] == pytest.approx(places[1], abs=1e-6)


def test_sign_errors_are_detected() -> None:
    result, apart = compared("rolling_conformal", 2.0, "right")
    case = next(case for case in reference("wheelset")["series"]["rolling"] if case["y"] == 2.0)
    assert apart.patches == (1, 1)
    mirrored = difference(replace(result, force=result.force * [-1, 1, 1]), case["right"], "right")
    assert abs(mirrored.forces[0]) > 10 * abs(apart.forces[0])
    assert abs(difference(result, case["left"], "left").position) > 5e-3


def test_missed_targets_are_marked() -> None:
    section = TableSection("one", "One", ("a",), [[1.0]])
    section.measures = [measure("e", "%", [0.3, -0.4], rms=0.4, worst=0.35), measure("f", "%", [1.0])]
    section.count(10)
    section.count(7)
    assert section.points == (7, 10)
    assert section.named("e").rms == pytest.approx(np.sqrt(0.125))
    assert (section.named("e").met, section.named("f").met) == (False, None)
    assert "NO" in show(section)
    assert section.data()["measures"][0]["met"] is False
    with pytest.raises(KeyError):
        section.named("g")
