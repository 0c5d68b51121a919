"""Contacts that are narrow against the strips: levels of narrower strips, and the passage between two of them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from test_lattice import STEEL, flowing, rolling, wheelset

from wheelrail.bindings._contact import (
    BulkDisplacement,
    LatticeProblem,
    LatticeStart,
    level_shares,
    maxima,
    penetrated_width,
)
from wheelrail.contact.analytical.hertz import Hertz, axis_stress, hertz, modulus
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.friction import FallingFriction
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Bodies, Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.stress.subsurface import LoadedBody
from wheelrail.support.arrays import Array
from wheelrail.support.plain_data import decode, encode

HEAVY = 60e3  # N, load for which the strips are chosen
NONE = np.zeros((2, 1))  # lift
ENOUGH = 4 / 3  # of the least strips across, from which on one level counts alone
TREAD, FLANGE = (-5.455e-3, -2.53e-4), (6.430e-3, 7.62e-4)  # lateral position m, height m where the surfaces touch


def exact(radii: tuple[float, float], load: float) -> Hertz:
    return hertz(0.5 / radii[0], 0.5 / radii[1], modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu)), force=load)


def ellipse(radii: tuple[float, float], laws: ContactLaws | None = None) -> LatticeContact:
    how = Discretisation(1e-3, bodies="half-space", points="lattice")
    model = hertz_pair((radii, (np.inf, np.inf)), (STEEL, STEEL), laws or ContactLaws(friction=0.0), how, load=HEAVY)
    assert isinstance(model, LatticeContact)
    return model


@cache
def wheel(bodies: Bodies) -> LatticeContact:
    model = wheelset(0.3, bodies).model
    assert isinstance(model, LatticeContact)
    return model


def levels_of(result: ContactResult) -> tuple[int, ...]:
    assert isinstance(result.warm_start, LatticeStart)
    return tuple(result.warm_start.levels)


def across(problem: LatticeProblem) -> tuple[float, Array]:
    """Strips across the penetration, and their derivative by the pose."""
    at, strips = problem.motion, problem.lattice
    lattice = problem.surface, at.origin, at.rotation, at.plan, NONE, strips.middle, strips.width
    counted = *lattice[:-1], strips.width * problem.tables.slenderness
    number, slopes = penetrated_width(*counted, *maxima(*lattice, problem.depth), True)
    return number, slopes[:6]


def least_strips(strips: int) -> float:
    """Across the penetration, for a number of strips over a usual patch."""
    return max(strips / 2, 2.5)


def load(model: LatticeContact, pose: Pose, motion: RigidMotion, shift: Array) -> Array:
    """Force and moment of a wheel moved by a shift (3,) m."""
    moved = replace(motion, wheel=replace(motion.wheel, reference=motion.wheel.reference + shift))
    result = model(replace(pose, origin=pose.origin + shift), moved)
    return np.concatenate([result.force, result.moment])


@pytest.mark.parametrize("radii", [(0.46, 0.30), (0.46, 0.05), (0.3, 1.2)])
@pytest.mark.parametrize("offset", [0.0, 0.3])
def test_ellipses_from_one_newton(radii: tuple[float, float], offset: float) -> None:
    model = replace(ellipse(radii), offset=offset)
    for load in np.geomspace(1.0, HEAVY, 12):
        pair = exact(radii, load)
        result = model(hertz_pose(pair.approach), flowing())
        assert result.status == "converged"
        assert result.force[2] == pytest.approx(load, rel=0.01)
        (patch,) = result.patches
        assert not patch.rough
        assert patch.area == pytest.approx(np.pi * pair.semi_axes[0] * pair.semi_axes[1], rel=0.04)
        assert patch.max_pressure == pytest.approx(pair.peak, rel=0.015)


def test_force_follows_the_power_law_of_the_approach() -> None:
    """Through three levels: the force over approach^1.5 does not jump, nor does its slope, which the tangent gives."""
    radii = 0.46, 0.30
    model = replace(ellipse(radii), tolerance=1e-9)
    approach = exact(radii, 9e3).approach * np.geomspace(0.05, 1.0, 150)
    results = [model(hertz_pose(d), flowing()) for d in approach]
    assert {(0,), (0, 1), (1,), (1, 2), (2,)} <= {levels_of(result) for result in results}
    force = np.array([result.force[2] for result in results])
    ratio = force / force[-1] * (approach[-1] / approach) ** 1.5
    np.testing.assert_allclose(ratio, 1.0, atol=5e-3)
    slopes = np.array([-result.tangent()[2, 2] for result in results])
    trapezoids = np.diff(approach) * 0.5 * (slopes[1:] + slopes[:-1])
    np.testing.assert_allclose(np.diff(force), trapezoids, rtol=1e-2)  # kinks where strips come or go
    assert trapezoids.sum() == pytest.approx(force[-1] - force[0], rel=1e-3)


@pytest.mark.parametrize("bound", [1.0, ENOUGH])
def test_level_changes_without_a_step(bound: float) -> None:
    """Where the share of a level reaches 0 or 1, force and tangent are the same on both sides."""
    radii = 0.46, 0.30
    model = replace(ellipse(radii), tolerance=1e-10)

    def excess(approach: float) -> float:
        return across(model.problem(hertz_pose(approach), flowing()))[0] - bound * least_strips(model.resolution.strips)

    low, high = (exact(radii, load).approach for load in (1e3, HEAVY))
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if excess(middle) > 0 else (middle, high)
    below, above = (model(hertz_pose(d * high), flowing()) for d in (1 - 1e-7, 1 + 1e-7))
    assert levels_of(below) != levels_of(above)
    slope = above.tangent()
    np.testing.assert_allclose(above.force[2] - below.force[2], -slope[2, 2] * 2e-7 * high, rtol=1e-3)
    np.testing.assert_allclose(below.tangent()[2, 2], slope[2, 2], rtol=1e-5)


@cache
def light_wheels(bodies: Bodies) -> tuple[LatticeContact, LatticeContact]:
    """The wheel, and the same on 1.5 times as many strips and cells."""
    model = replace(wheel(bodies), tolerance=1e-9)
    return model, replace(model, resolution=LatticeResolution(21, 18))


@pytest.mark.parametrize("bodies", ["half-space", "waveguide"])
@pytest.mark.parametrize("place", [TREAD, FLANGE])
def test_light_wheel(bodies: Bodies, place: tuple[float, float]) -> None:
    """Some newtons to some kilonewtons: force against the finer strips and cells, tangent against differences."""
    model, fine = light_wheels(bodies)
    y, touching = place
    seen = set()
    for depth in np.geomspace(2e-7, 2e-5, 5):
        pose, motion = wheelset(0.3, bodies).mounting.left_pair(rolling(y, touching - depth, 5e-3, 1e-3))
        result, better = model(pose, motion), fine(pose, motion)
        seen.add(levels_of(result))
        assert min(patch.strips for patch in result.patches) >= 4
        assert np.linalg.norm(result.force - better.force) < 0.01 * np.linalg.norm(better.force)
        tangent = result.tangent()
        for k in (1, 2):
            step = 1e-5 * result.approach * np.eye(3)[k]
            above, below = (load(model, pose, motion, shift) for shift in (step, -step))
            difference = (above - below) / (2 * step[k])
            np.testing.assert_allclose(tangent[:, k], difference, atol=1e-3 * np.abs(difference[:3]).max())
    assert any(len(pair) == 2 for pair in seen)
    assert any(min(pair) > 0 for pair in seen)


def strips_across(bodies: Bodies, depth: float) -> tuple[float, float]:
    """Strips across the contact of a flange without the bulk displacement, and the load N."""
    model = wheel(bodies)
    pose, motion = wheelset(0.3, bodies).mounting.left_pair(rolling(FLANGE[0], FLANGE[1] - depth, 5e-3, 1e-3))
    problem = model.problem(pose, motion)
    result = model.solve(problem)
    assert isinstance(result.warm_start, LatticeStart)
    (solution,) = result.warm_start.solutions
    lift = BulkDisplacement(problem, solution).lift
    at, strips = problem.motion, problem.lattice
    surfaces, lattice = (problem.surface, at.origin, at.rotation, at.plan, lift), (strips.middle, strips.width)
    pieces = maxima(*surfaces, *lattice, problem.depth - np.interp(strips.middle, *lift))
    return penetrated_width(*surfaces, *lattice, *pieces, False)[0], float(np.linalg.norm(result.force))


def test_width_of_bodies_that_bend() -> None:
    """On a flange most of the penetration bends wheel and rail: under the same load the contact is as wide on
    half-spaces, with less of it.
    """
    bent, load = strips_across("waveguide", 6e-5)
    low, high = 0.0, 6e-5
    for _ in range(25):
        depth = 0.5 * (low + high)
        low, high = (depth, high) if strips_across("half-space", depth)[1] < load else (low, depth)
    assert depth < 0.5 * 6e-5
    assert bent == pytest.approx(strips_across("half-space", depth)[0], rel=0.1)


@pytest.mark.parametrize("depth", [4.5e-5])
def test_flange_of_bodies_that_bend(depth: float) -> None:
    """Peak pressure and area against strips and cells twice as fine; the tangent, of shares of levels that follow the
    bulk displacement, against differences.
    """
    model = replace(wheel("waveguide"), tolerance=1e-10)
    pose, motion = wheelset(0.3, "waveguide").mounting.left_pair(rolling(FLANGE[0], FLANGE[1] - depth, 5e-3, 1e-3))
    result = model(pose, motion)
    assert len(levels_of(result)) == 2
    (own,) = result.patches
    (fine,) = replace(model, resolution=LatticeResolution(28, 24))(pose, motion).patches
    assert own.max_pressure == pytest.approx(fine.max_pressure, rel=0.03)
    assert own.area == pytest.approx(fine.area, rel=0.05)
    tangent = result.tangent()
    for k in (1, 2):
        step = 2e-8 * np.eye(3)[k]
        difference = (load(model, pose, motion, step) - load(model, pose, motion, -step)) / 4e-8
        np.testing.assert_allclose(tangent[:, k], difference, atol=1e-6 * np.abs(difference[:3]).max())
    for k in range(3):
        step = 1e-5 * np.eye(3)[k]
        sides = [
            model(
                pose, replace(motion, wheel=replace(motion.wheel, velocity=motion.wheel.velocity + sign * step))
            ).force
            for sign in (1, -1)
        ]
        difference = (sides[0] - sides[1]) / 2e-5
        np.testing.assert_allclose(tangent[:3, 6 + k], difference, atol=1e-5 * np.abs(tangent[:3, 6:9]).max())


@pytest.fixture(scope="module")
def between() -> tuple[Pose, ContactResult]:
    """A wheel on finite bodies between two levels."""
    y, touching = TREAD
    contact = wheelset(0.3, "waveguide")
    for depth in np.linspace(1.0e-6, 3e-6, 9):
        pose, motion = contact.mounting.left_pair(rolling(y, touching - depth, 5e-3, 1e-3))
        result = wheel("waveguide")(pose, motion)
        if len(levels_of(result)) == 2:
            return pose, result
    raise AssertionError("no pose between levels")


def test_patches_and_fields_between_levels_carry_the_force(between: tuple[Pose, ContactResult]) -> None:
    _, result = between
    (patch,) = result.patches
    np.testing.assert_allclose(patch.force, result.force, rtol=1e-9)
    assert patch.strips > 4
    fields = result.fields
    assert fields is not None
    local = np.column_stack([fields.traction, -fields.pressure]) * fields.area[:, None]
    np.testing.assert_allclose(np.einsum("nk,nkc->c", local, fields.axes), result.force, rtol=1e-9)
    assert set(fields.patch.tolist()) == {0}
    assert patch.area == pytest.approx(fields.area.sum(), rel=0.05)
    assert patch.wheel_band[0] < patch.wheel_y < patch.wheel_band[1]
    assert result.mirrored().patches[0].force[1] == -patch.force[1]
    levels = [wheel("waveguide").on(level) for level in levels_of(result)]
    assert levels[1].tables is not levels[0].tables


@pytest.mark.parametrize("load", [477.0, 4004.0])
def test_stress_between_levels(load: float) -> None:
    """Below a circle, closed form; on the axis at 0.1 to 1.5 of its radius within 1.5 % of the peak pressure."""
    radii = 0.3, 0.3
    result = ellipse(radii)(hertz_pose(exact(radii, load).approach), flowing())
    assert len(levels_of(result)) == 2
    assert result.fields is not None
    assert result.fields.share is not None
    assert 0.05 < result.fields.share.min() < 0.5  # the other level counts
    pair = exact(radii, float(result.force[2]))
    depth = pair.semi_axes[0] * np.array([0.1, 0.2, 0.5, 1.0, 1.5])
    (below,) = LoadedBody.block(False, STEEL).below(result, depth).patches
    radial, axial = axis_stress(depth, radius=pair.semi_axes[0], peak=pair.peak, nu=STEEL.nu)
    closed = np.einsum("am,ab->mab", [radial, radial, axial], np.eye(3))
    assert np.abs(below.stress - closed).max() < 0.015 * pair.peak


def test_the_right_wheel_between_levels_is_the_mirror_image(between: tuple[Pose, ContactResult]) -> None:
    del between
    contact = wheelset(0.3, "waveguide")
    state = rolling(TREAD[0], TREAD[1] - 2e-6, 5e-3, 1e-3)
    mirrored = replace(state, y=-state.y, roll=-state.roll, yaw=-state.yaw)
    left, right = contact(state, "left"), contact(mirrored, "right")
    np.testing.assert_array_equal(left.force, [1, -1, 1] * right.force)


def test_resumed_solves_between_levels_are_the_same(between: tuple[Pose, ContactResult]) -> None:
    """A stored start gives every bit of the next solve, and the result does not depend on it."""
    pose, result = between
    model = wheel("waveguide")
    motion = wheelset(0.3, "waveguide").mounting.left_pair(rolling(*TREAD, 5e-3, 1e-3))[1]
    moved = replace(pose, origin=pose.origin - [0, 0, 2e-8])
    result.tangent()
    stored = decode(encode(result.warm_start), ("wheelrail.bindings",))
    assert isinstance(stored, LatticeStart)
    resumed, uninterrupted = (model(moved, motion, ContactResult.guess(start)) for start in (stored, result.warm_start))
    cold = model(moved, motion)
    assert levels_of(resumed) == levels_of(result)
    assert resumed.statistics.newton < cold.statistics.newton
    np.testing.assert_array_equal(resumed.force, uninterrupted.force)
    np.testing.assert_allclose(resumed.force, cold.force, rtol=1e-6)


@pytest.mark.parametrize("strips", [10, 14])
def test_wide_contacts_are_on_ordinary_strips(strips: int) -> None:
    model = replace(wheel("half-space"), resolution=LatticeResolution(strips, 12))
    for y, height in ((-5.455e-3, -0.353e-3), (4.79e-3, 0.13e-3), (6.43e-3, 0.602e-3)):  # 50 to 100 kN
        problem = model.problem(*wheelset(0.3).mounting.left_pair(rolling(y, height)))
        assert level_shares(problem, strips) == ([0], 1.0)


def test_width_is_continuous_where_regions_merge() -> None:
    """A second region beside the first one, from its birth to beyond their merging."""
    model = wheel("half-space")
    heights = np.linspace(0.226e-3, 0.04e-3, 400)
    numbers, slopes = [], []
    for height in heights:
        pose, motion = wheelset(0.3).mounting.left_pair(rolling(4.79e-3, height, 5e-3))
        number, slope = across(model.problem(pose, motion))
        numbers.append(number)
        slopes.append(slope[2])
    from_slopes = numbers[20] + np.cumsum(0.5 * np.diff(heights[20:]) * np.add(slopes[21:], slopes[20:-1]))
    np.testing.assert_allclose(numbers[21:], from_slopes, rtol=2e-2)


def test_falling_friction_on_a_small_ellipse() -> None:
    radii = 0.46, 0.30
    laws = ContactLaws(friction=FallingFriction(0.4, 0.5, 0.6))
    small, large = (
        ellipse(radii, laws)(hertz_pose(exact(radii, load).approach), flowing(0.0, 0.02)) for load in (3.0, HEAVY)
    )
    for result, load in ((small, 3.0), (large, HEAVY)):
        assert 0.9 * 0.2 * load < -result.force[1] < 0.4 * load


def test_models_without_friction_share_the_tables_of_all_levels() -> None:
    model = wheel("half-space")
    assert model.frictionless.on(2).tables is model.on(2).tables
    assert np.median(model.on(2).tables.width) == pytest.approx(0.25 * np.median(model.tables.width), rel=1e-2)
