"""Maxima of the penetration that join into one contact: weights without jumps, and their derivatives."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.bindings._contact import VIRTUAL, covered, merging_weights
from wheelrail.support.arrays import Array

MERGE = 4e-3
HEIGHTS, PLACES = np.array([45.1, 38.05, 38.84]) * 1e-6, np.array([-35.46, -30.27, -22.35]) * 1e-3
MINIMA, BETWEEN = np.array([37.18, 27.81]) * 1e-6, np.array([-30.64, -29.3]) * 1e-3


def rows(place: Array, height: Array) -> Array:
    return np.asarray(np.column_stack([place, height, np.zeros(len(place))]))


def weights(top: Array, low: Array) -> Array:
    return merging_weights(top, low, MERGE, np.zeros((len(top), 3, 0)), np.zeros((len(low), 3, 0)))[0]


@pytest.mark.parametrize(("place", "height", "where"), [(-31.48, 39.99, 1), (-33.0, 42.0, 1), (-38.0, 30.0, 0)])
def test_no_weight_jumps_where_a_maximum_appears(place: float, height: float, where: int) -> None:
    """At 06d44fc, a maximum born on the slope between two others took 0.12 of the third one's weight."""
    before = weights(rows(PLACES, HEIGHTS), rows(BETWEEN, MINIMA))
    # on the slope of its neighbour it appears together with a minimum of nearly its own height
    top = rows(np.insert(PLACES, where, 1e-3 * place), np.insert(HEIGHTS, where, 1e-6 * height))
    low = rows(np.insert(BETWEEN, 0, 1e-3 * place + 1e-7), np.insert(MINIMA, 0, 1e-6 * height * (1 - 1e-9)))
    after = weights(top, low)
    assert after[where] == 0.0
    np.testing.assert_allclose(np.delete(after, where), before, atol=1e-6)


def test_weights_of_maxima_without_valleys_and_far_apart() -> None:
    shallow = weights(rows(PLACES, np.array([40.0, 40.0, 40.0]) * 1e-6), rows(BETWEEN, np.full(2, 39.999e-6)))
    np.testing.assert_allclose(shallow, 1 / 3, atol=2e-4)
    apart = weights(rows(PLACES * [1.5, 1.0, 1.0], HEIGHTS), rows(BETWEEN, np.zeros(2)))
    np.testing.assert_array_equal(apart, 1.0)


@pytest.mark.parametrize("minimum", [20.0, 25.0, 30.0, 34.0, 37.0, 39.9])
def test_no_load_is_counted_twice(minimum: float) -> None:
    """Two equal humps: each of their contacts has its own load and what its region covers of the other one's; at
    06d44fc up to 1.2 loads.
    """
    height = 40e-6
    (one, other) = weights(rows(np.array([0.0, 0.01]), np.full(2, height)), rows(np.array([5e-3]), [1e-6 * minimum]))
    level = (1 - VIRTUAL) * height
    part = covered(VIRTUAL * height, 1e-6 * minimum - level, 0.01, MERGE)[0] / (VIRTUAL * height)
    assert one == other == pytest.approx(1 / (1 + part), abs=2e-4)


def test_order_of_equal_minima_does_not_matter() -> None:
    low = np.array([30.0, 30.0])
    one, other = (
        weights(rows(PLACES, HEIGHTS), rows(BETWEEN, 1e-6 * (low + way * np.array([1e-9, 0.0])))) for way in (1, -1)
    )
    np.testing.assert_allclose(one, other, atol=1e-8)


@pytest.mark.parametrize("count", [2, 3, 5])
def test_derivatives_of_weights(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(20):
        height, place = rng.uniform(1, 5, count) * 1e-5, np.sort(rng.uniform(0, 0.015, count))
        minimum = np.minimum(height[1:], height[:-1]) * rng.uniform(0.1, 0.98, count - 1)
        top, low = rows(place, height), rows(0.5 * (place[1:] + place[:-1]), minimum)
        by_top, by_low = 1e-5 * rng.normal(size=(count, 3, 1)), 1e-5 * rng.normal(size=(count - 1, 3, 1))
        by_top[:, 0] *= 100
        exact = merging_weights(top, low, MERGE, by_top, by_low)[1][:, 0]
        ahead, behind = (weights(top + h * by_top[..., 0], low + h * by_low[..., 0]) for h in (1e-6, -1e-6))
        np.testing.assert_allclose((ahead - behind) / 2e-6, exact, atol=1e-7 * (1 + np.abs(exact).max()))


def test_penetration_behind_a_minimum() -> None:
    """It grows from none where the minimum leaves the region to its own where there is no minimum."""
    depth = 20e-6
    values = [covered(depth, valley, 8e-3, MERGE)[0] for valley in np.linspace(0.0, depth, 101)]
    assert values[0] == 0.0
    assert values[-1] == depth
    assert (np.diff(values) >= 0.0).all()
    assert covered(depth, -1e-6, 3e-3, MERGE)[0] == depth  # nearer than two contacts can be
    for away in (5e-3, 8e-3):
        value, *slopes = covered(depth, 8e-6, away, MERGE)
        for slope, step in zip(slopes, np.diag([1e-10, 1e-10, 1e-8]), strict=True):
            ahead = covered(depth + step[0], 8e-6 + step[1], away + step[2], MERGE)[0]
            assert (ahead - value) / step.sum() == pytest.approx(slope, abs=1e-4, rel=1e-4)
