"""Gap of separated wheels and rails: always a number, the smallest distance of the undeformed surfaces."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from dense_surfaces import DenseSurfaces
from grooved_rails import grooved
from scipy.spatial import cKDTree

from wheelrail.bindings._contact import lines_to_scan, scan
from wheelrail.contact.geometry.rigid_surfaces import RigidQuadrics, RigidWheelRail
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips, QuadricStrips
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

RADIUS = 0.46
WHEEL = named_profile("S1002")


@cache
def pair(inclination: float) -> tuple[RigidWheelRail, DenseSurfaces]:
    rail = named_profile("60E1").inclined(inclination)
    return RigidWheelRail(WHEEL, rail, RADIUS), DenseSurfaces(WHEEL, rail, RADIUS)


def pose(state: WheelsetState, rail_y: float = 0.7535) -> Pose:
    return Mounting(0.75, rail_y, RADIUS).left_pair(state)[0]


def drawn(seed: int, count: int) -> list[WheelsetState]:
    """Wheels above their rail, from the flange beside it to the end of the tread on it."""
    draw = np.random.default_rng(seed)
    lowest, highest = np.array([-0.07, 3e-5, -0.01, -0.03]), np.array([0.03, 0.03, 0.01, 0.03])
    values = lowest + (highest - lowest) * draw.random((count, 4)) ** np.array([1.0, 3.0, 1.0, 1.0])
    return [WheelsetState(y=y, z=z + 0.75 * abs(roll), roll=roll, yaw=yaw) for y, z, roll, yaw in values.tolist()]


@pytest.mark.parametrize("inclination", [0.025, 0.05])
def test_gap_is_the_smallest_distance_of_densely_sampled_surfaces(inclination: float) -> None:
    rigid, dense = pair(inclination)
    at = [pose(state) for state in drawn(1, 6)]
    found, exact = np.array([-rigid.approach(p) for p in at]), np.array([dense.gap(p) for p in at])
    separated = found > 0.0
    assert separated.sum() > 3
    np.testing.assert_allclose(found[separated], exact[separated], rtol=1e-6, atol=1e-8)
    assert (exact[~separated] < 2e-5).all()  # surfaces that cross: samples lie on both sides


def test_moving_by_the_gap_along_any_direction_makes_no_contact() -> None:
    rigid, _ = pair(0.025)
    for state in drawn(2, 20):
        here = pose(state)
        gap = -rigid.approach(here)
        for angle in np.linspace(0.0, np.pi, 5) if gap > 0.0 else ():
            step = (gap - 1e-9) * np.array([0.0, np.cos(angle), -np.sin(angle)])
            assert rigid.approach(Pose(here.origin + step, here.rotation)) < 1e-8


def test_every_model_gives_a_separated_contact_the_same_finite_gap() -> None:
    profiles, laws = (WHEEL, named_profile("60E1").inclined(0.025)), ContactLaws.penalty()
    rigid, steels = RigidWheelRail(*profiles, RADIUS), (Material(), Material())
    standard = StandardContact(rigid, ContactLaws(friction=0.0))
    strips = wheel_rail_pair(
        profiles, RADIUS, steels, ContactLaws(friction=0.0), Discretisation(3e-3, bodies="half-space")
    )
    points = wheel_rail_pair(profiles, RADIUS, steels, laws, Discretisation(3e-3, bodies="waveguide"))
    for z in (2e-4, 3e-3, 0.05, 2.0):
        place, motion = Mounting(0.75, 0.7535, RADIUS).left_pair(WheelsetState(y=-3e-3, z=z, pitch_rate=1.0))
        results = [model(place, motion, None) for model in (standard, strips, points)]
        assert [result.status for result in results] == ["separated"] * len(results)
        np.testing.assert_allclose([result.approach for result in results], rigid.approach(place), rtol=1e-9)
        assert results[0].approach < 0.0


def test_gap_of_quadrics_does_not_depend_on_their_lines() -> None:
    upper, lower = (0.4, 0.3), (np.inf, -0.9)
    apart = Pose(np.array([3e-4, -2e-4, 7e-3]), np.eye(3))
    x, y = np.meshgrid(np.linspace(-1e-3, 1e-3, 401), np.linspace(-2e-3, 2e-3, 801))
    gaps = 7e-3 + (x - 3e-4) ** 2 / 0.8 + (y + 2e-4) ** 2 / 0.6 + y**2 / 1.8 * -1.0
    strips = QuadricStrips(upper, lower, 5e-3, (1e-3, 1e-3))
    assert strips.nearest(apart)[1] == pytest.approx(-gaps.min(), abs=1e-9)
    assert RigidQuadrics(upper, lower).regions(apart)[1] == pytest.approx(-gaps.min(), abs=1e-9)


@pytest.mark.parametrize("groove", [(28e-3, 45e-3), (33e-3, 42e-3)])
def test_flange_in_a_groove_is_searched_whole(tmp_path: Path, groove: tuple[float, float]) -> None:
    """Back, tip and flank of a flange lie near the check rail, the floor and the gauge face at once."""
    rail = grooved(tmp_path, *groove).inclined(0.0)
    rigid, dense = RigidWheelRail(WHEEL, rail, RADIUS), DenseSurfaces(WHEEL, rail, RADIUS)
    for y, z in ((0.0, 1.5e-3), (-4e-3, 1e-3), (3e-3, 2e-3), (-2e-3, 8e-3)):
        here = pose(WheelsetState(y=y, z=z, yaw=3e-3))
        assert -rigid.approach(here) == pytest.approx(dense.gap(here), rel=1e-6, abs=1e-8)


def overlapping(rigid: RigidWheelRail, place: Pose) -> Array:
    """Lines of the whole profile that overlap the rail."""
    return scan(rigid.rail.shape, rigid.lines, RADIUS, *place.arrays, (0, len(rigid.lines.s))).depth > 0.0


def test_lines_of_a_steep_flange_at_large_yaw_are_scanned_right() -> None:
    """Penetration of lines on the flange, 10 to 40 mm ahead of the axle, against circles and a rail sampled densely."""
    rigid, _ = pair(0.025)
    rail, places = rigid.rail, np.arange(-0.06, 0.0, 2e-5)
    arc = np.arange(rail.s_range[0], -0.01, 5e-6)
    points, tangents = rail.point(arc), rail.tangent(arc)
    tree, checked = cKDTree(points), 0
    for y, yaw in ((6e-3, -0.04), (7e-3, -0.03), (8e-3, -0.04), (8e-3, -0.02)):
        z = next(z for z in np.arange(12e-3, 0.0, -2e-4) if rigid.approach(pose(WheelsetState(y=y, z=z, yaw=yaw))) > 0)
        place = pose(WheelsetState(y=y, z=z - 1e-4, yaw=yaw))
        found = scan(rail.shape, rigid.lines, RADIUS, *place.arrays, (0, len(rigid.lines.s)))
        near = np.flatnonzero((found.depth > -5e-4) & (rigid.lines.point.real < -0.02))
        for i in near[::4].tolist():
            line = rigid.lines.point[i]
            angle, r = places / RADIUS, RADIUS + line.imag
            circle = np.stack([r * np.sin(angle), np.full(len(angle), line.real), -r * np.cos(angle)], axis=1)
            at = (place.origin + circle @ place.rotation.T)[:, 1:]
            closest = tree.query(at)[1]
            offset, tangent = at - points[closest], tangents[closest]
            height = tangent[:, 0] * offset[:, 1] - tangent[:, 1] * offset[:, 0]
            assert found.depth[i] == pytest.approx(-height.min(), abs=2e-6)
            checked += 1
    assert checked > 15


def test_no_overlap_of_a_wheel_at_large_yaw_is_missed() -> None:
    """Flanges that touch 40 to 110 mm ahead of the axle: places of contact against surfaces sampled densely."""
    rigid, dense = pair(0.025)
    standard = StandardContact(rigid, ContactLaws(friction=0.0))
    steels, how = (Material(), Material()), Discretisation(3e-3, bodies="half-space")
    strips = wheel_rail_pair((WHEEL, rigid.rail), RADIUS, steels, ContactLaws(friction=0.0), how)
    assert isinstance(strips, LatticeContact)
    yaws = np.random.default_rng(5).uniform(-0.2, 0.2, 6).tolist()
    for yaw in (0.03, 0.06, 0.08, 0.1, 0.2, *yaws):
        place, motion = Mounting(0.75, 0.7605, RADIUS).left_pair(WheelsetState(y=8e-3, yaw=yaw, pitch_rate=1.0))
        expected = dense.deepest(place)
        assert expected > 1e-4
        assert rigid.regions(place)[1] == pytest.approx(expected, rel=2e-3)
        assert standard(place, motion).approach == pytest.approx(expected, rel=2e-3)
        assert strips.problem(place, motion).approach == pytest.approx(expected, rel=2e-2)


def test_lines_left_out_of_a_scan_do_not_overlap(tmp_path: Path) -> None:
    draw, whole, skipped = np.random.default_rng(3), 0, 0
    for rail in (named_profile("60E1").inclined(0.025), grooved(tmp_path, 28e-3, 45e-3)):
        rigid = RigidWheelRail(WHEEL, rail, RADIUS)
        for y, z, roll, yaw in draw.uniform([-0.09, -5e-3, -0.02, -0.05], [0.06, 0.03, 0.02, 0.05], (300, 4)).tolist():
            place = pose(WheelsetState(y=y, z=z, roll=roll, yaw=yaw))
            first, stop = lines_to_scan(rigid.lines, RADIUS, *place.arrays)
            over = overlapping(rigid, place)
            assert not np.delete(over, slice(first, stop)).any()
            whole, skipped = whole + over.any(), skipped + (first > 0) + (stop < len(over))
    assert whole > 100
    assert skipped > 100


def test_ordinary_running_scans_the_ordinary_lines() -> None:
    """What a scene does not need costs nothing: the flange's back and tip and the end of the tread are left out."""
    lines = pair(0.025)[0].lines
    for y in np.linspace(-8e-3, 5e-3, 9).tolist():
        for yaw in (-5e-3, 0.0, 5e-3):
            place = pose(WheelsetState(y=y, z=-2e-4, yaw=yaw))
            assert lines_to_scan(lines, RADIUS, *place.arrays) == (lines.first, lines.stop)


def test_an_overlap_that_no_line_solves_is_named() -> None:
    rigid, _ = pair(0.025)
    climbed = pose(WheelsetState(y=0.03, z=0.0262))
    assert rigid.unsolved(climbed, *WHEEL.s_range) == ""
    text = rigid.unsolved(climbed, float(rigid.lines.s[rigid.lines.first]), WHEEL.s_range[1])
    assert "mm deep at y = -" in text
    assert rigid.unsolved(pose(WheelsetState(y=0.03, z=0.03)), -0.05, 0.05) == ""


def test_strips_and_rigid_surfaces_agree_on_the_approach() -> None:
    rigid, _ = pair(0.05)
    strips = ProfileStrips(rigid.wheel, rigid.rail, rigid.radius)
    place = pose(WheelsetState(z=4e-3, roll=2e-3))
    assert strips.nearest(place) == rigid.nearest(place)
