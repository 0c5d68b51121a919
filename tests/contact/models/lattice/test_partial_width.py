"""Strips that touch on a part of their width: the force and its tangent are continuous where strips come and go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wheelrail.bindings._contact import (
    MODES,
    moved,
    opening,
    opening_changes,
    partial_width_changes,
    partial_widths,
    pressed,
)
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.states import LatticeState, states_of
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

STEEL = Material(2.1e11, 0.3)
RADII = (0.46, 0.3)
ROLLING = RigidMotion(*(Twist(np.array([v, 0.0, 0.0]), np.zeros(3), np.zeros(3)) for v in (-0.9995, -1.0005)))


def ellipse(friction: float, strips: int = 14) -> LatticeContact:
    how = Discretisation(1e-3, bodies="half-space", points="lattice", strips=strips)
    model = hertz_pair((RADII, (np.inf, np.inf)), (STEEL, STEEL), ContactLaws(friction=friction), how, load=60e3)
    assert isinstance(model, LatticeContact)
    return replace(model, tolerance=1e-9)


def state_of(result: ContactResult) -> LatticeState:
    (state,) = states_of(result.warm_start).values()
    return state


def loaded_strips(result: ContactResult) -> int:
    return len(state_of(result).strips)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_forces_are_smooth_where_strips_enter(friction: float) -> None:
    """Forces over Hertz's and tangents at 101 approaches, over which a strip enters at either end."""
    model = ellipse(friction)
    start = hertz(0.5 / RADII[0], 0.5 / RADII[1], modulus((STEEL.E, STEEL.nu), (STEEL.E, STEEL.nu)), force=60e3)
    depths = start.approach * np.linspace(1.0, 1.3, 101)
    results = [model(hertz_pose(depth), ROLLING) for depth in depths]
    assert len({loaded_strips(result) for result in results}) > 1
    force = np.array([result.force[2] for result in results])
    ratio = force / (60e3 * (depths / start.approach) ** 1.5)
    assert np.abs(ratio - 1).max() < 1e-3
    slope = np.array([-result.tangent()[2, 2] for result in results]) / (1.5 * force / depths)
    assert np.abs(slope - 1).max() < 3e-3  # with kinks 8e-3
    assert np.abs(np.diff(slope)).max() < 4e-4  # with kinks 5e-3
    # the tangent is that of the force: the trapezoidal rule errs by the change of its slope
    means = 0.5 * (slope[1:] * force[1:] / depths[1:] + slope[:-1] * force[:-1] / depths[:-1]) * 1.5
    np.testing.assert_allclose(np.diff(force) / np.diff(depths), means, rtol=1e-4)  # with kinks 1.4e-3


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_tangents_beside_strips_that_touch_on_a_part(friction: float) -> None:
    """Against central differences, with strips on less than half of their width."""
    model, partial = ellipse(friction), 0
    for depth in np.linspace(70e-6, 90e-6, 9):
        result = model(hertz_pose(depth), ROLLING)
        state = state_of(result)
        problem = model.problem(hertz_pose(depth), ROLLING)
        partial += int((state.load < 0.25 * problem.of(state.strips).places.whole).sum())
        h = 1e-9
        ahead, behind = (model(hertz_pose(depth + side * h), ROLLING, result).force for side in (1, -1))
        found = -result.tangent()[:3, 2]
        assert np.abs((ahead - behind) / (2 * h) - found).max() < 1e-5 * np.abs(found).max()
    assert partial >= 2


@pytest.mark.parametrize("depth", [3e-7, 4e-7])
def test_a_patch_of_two_strips_on_a_part_of_their_width_has_an_area(depth: float) -> None:
    """That of whole strips, as the squared length, continued beyond the end of the contact, may be negative."""
    model = ellipse(0.0)
    problem = model.problem(hertz_pose(depth), ROLLING)
    result = model.solve(problem)
    state = state_of(result)
    assert loaded_strips(result) == 2
    assert (state.load < 0.25 * problem.of(state.strips).places.whole).all()
    assert result.patches[0].area == pytest.approx(float(2 * state.half @ problem.of(state.strips).places.width))


def test_onset_of_a_parabola() -> None:
    """Gap beside a line contact that ends b from the middle: kappa sqrt(2 b) 2/3 y^(3/2), in the mean over w."""
    kappa, width, b = 20.0, 1e-4, 2e-3
    middle = width * np.arange(-60.0, 61.0)
    depth = 0.5 * kappa * (2 * b * b - middle**2)  # of a circle: the approach is kappa b^2
    at_strips = partial_widths(depth, np.full(121, kappa), middle, np.full(121, width))
    onset, whole = at_strips.onset, at_strips.whole
    at = int(np.searchsorted(middle, b))
    y = (np.arange(1000) + 0.5) / 1000 * width
    exact = float(np.mean(kappa * np.sqrt(2 * b) * 2 / 3 * y**1.5))
    short = 0.5 ** (0.5 * (1 - 2 / np.pi))  # where the end of a circle counts as sharp
    assert onset[at] == pytest.approx(short * exact, rel=0.05)
    assert whole[at] == pytest.approx(0.5 * kappa * b * width, rel=0.05)
    assert onset[[0, -1]].tolist() == whole[[0, -1]].tolist() == [0.0, 0.0]
    assert (onset[1:-1] > 0).all()


def test_strips_beside_the_end_of_the_rail_touch_on_their_whole_width() -> None:
    depth = np.array([1e-5, 2e-5, 1e-5, -np.inf, -np.inf])
    at_strips = partial_widths(depth, np.ones(5), 1e-3 * np.arange(5.0), np.full(5, 1e-3))
    onset, whole = at_strips.onset, at_strips.whole
    assert (onset > 0).tolist() == (whole > 0).tolist() == [False, True, False, False, False]
    assert opening(1e3, float(onset[2]), float(whole[2])) == (0.0, 0.0)


def test_changes_of_onset_and_whole() -> None:
    random = np.random.default_rng(3)
    middle, width = np.cumsum(random.uniform(0.5e-3, 1e-3, (4, 3)), axis=1), random.uniform(0.5e-3, 1e-3, 4)
    depth, change = random.uniform(-1e-5, 1e-4, (4, 3)), random.uniform(-1.0, 1.0, (4, 3, 2))
    curvature, h = random.uniform(1.0, 4.0, 4), 1e-9

    def at(k: int, i: int, side: float) -> Array:
        own, width_of = depth[i] + side * h * change[i, :, k], np.full(3, width[i])
        there = partial_widths(own, np.full(3, curvature[i]), middle[i], width_of)
        return np.array([there.onset[1], there.whole[1]])

    changes = partial_width_changes(depth, curvature, middle, width, change)
    found = np.array([changes.onset, changes.whole])
    for i in range(4):
        for k in range(2):
            expected = (at(k, i, 1.0) - at(k, i, -1.0)) / (2 * h * at(k, i, 0.0))
            np.testing.assert_allclose(found[:, i, k], expected, rtol=1e-5)


def test_opening_and_its_slopes() -> None:
    onset, whole = 3e-6, 2e5
    for load in np.array([-0.3, 1e-3, 0.2, 0.9, 1.5]) * whole:
        slope = opening(load, onset, whole)[1]
        ahead, behind = (opening(load + side * 1e-4 * whole, onset, whole)[0] for side in (1, -1))
        assert slope == pytest.approx((ahead - behind) / (2e-4 * whole), rel=1e-2 if abs(load) < 0.01 * whole else 1e-4)
    assert opening(1e-12, onset, whole)[0] == pytest.approx(onset, rel=1e-6)
    assert opening(whole, onset, whole) == (0.0, 0.0)
    h = 1e-5
    for load in np.array([0.1, 0.7]) * whole:
        by_onset, by_whole = opening_changes(load, onset, whole)
        higher, lower = (opening(load, onset, whole * (1 + side * h))[0] for side in (1, -1))
        assert by_whole == pytest.approx((higher - lower) / (2 * h), rel=1e-6)
        assert by_onset == pytest.approx(opening(load, onset, whole)[0])


def test_part_under_a_penetration() -> None:
    compliance, onset = np.full(3, 5e-6), np.full(3, 2e-6)
    depth = np.array([1e-8, 3e-6, 20e-6])
    c = pressed(depth, compliance, onset)
    gap = np.where(c < 1, onset * (1 - np.minimum(c, 1)) ** 2.5, 0.0)
    np.testing.assert_allclose(depth - onset - compliance * c**2 + gap, 0.0, atol=1e-11)
    assert c[0] < 0.01 < c[1] < 1 < c[2]


def test_steps_pass_from_the_whole_width_to_a_part() -> None:
    """A step to less than the load on the whole width ends at the square of the mean of both; small ones are linear."""
    values = np.zeros((1, MODES + 2))
    values[0, 0], values[0, -2:] = 1e9, (-2e-3, 2e-3)
    load = 1e9 * 2e-3
    step = np.zeros_like(values)
    step[0, 0] = -0.8e9
    after = moved(values, step, 1.0, np.array([0.5 * load]))
    assert after[0, 0] * 2e-3 == pytest.approx(0.5 * load * (0.5 * (1 + 0.4)) ** 2)
    np.testing.assert_array_equal(after[0, -2:], values[0, -2:])
    np.testing.assert_allclose(moved(values, step, 0.1, np.array([0.5 * load])), values + 0.1 * step)
    np.testing.assert_allclose(moved(values, step, 1.0, np.array([2 * load])), values + step)
