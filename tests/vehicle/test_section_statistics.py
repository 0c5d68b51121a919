"""Estimates over sections of track, against scipy.stats and the rate at which bounds are exceeded."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import linregress

from wheelrail.vehicle.evaluation.section_statistics import (
    SAFETY,
    estimated_maximum,
    target_estimate,
)


def test_maximum_of_equal_sections() -> None:
    assert estimated_maximum(np.array([1.0, 2.0, 3.0]), SAFETY) == pytest.approx(5.0)
    with pytest.raises(ValueError, match="must be 2 at least"):
        estimated_maximum(np.array([1.0]), SAFETY)


def test_line_at_the_target_is_that_of_scipy() -> None:
    rng = np.random.default_rng(3)
    variable = rng.uniform(60.0, 130.0, 25)
    values = 10.0 + 0.2 * variable + rng.normal(0.0, 2.0, 25)
    line, estimate = linregress(variable, values), target_estimate(variable, values, 150.0)
    assert (estimate.slope, estimate.mean) == pytest.approx((line.slope, line.intercept + 150.0 * line.slope))
    assert estimate.extrapolated
    assert not target_estimate(variable, values, 100.0).extrapolated
    # the error of the line's own value alone is that of the intercept at the target
    error = linregress(variable - 150.0, values).intercept_stderr
    scatter = np.sum((values - line.intercept - line.slope * variable) ** 2) / 23
    assert estimate.bound - estimate.mean == pytest.approx(2.807336 * np.sqrt(error**2 + scatter))  # t table, 23, 99 %
    with pytest.raises(ValueError, match="different conditions"):
        target_estimate(np.ones(5), np.arange(5.0), 1.0)


def test_one_in_two_hundred_sections_exceeds_the_bound() -> None:
    rng, exceeded, trials = np.random.default_rng(7), 0, 6000
    for _ in range(trials):
        variable, noise = rng.uniform(0.0, 1.0, 10), rng.normal(size=11)
        estimate = target_estimate(variable, 2.0 * variable + noise[:10], 1.2)
        exceeded += 2.4 + noise[10] > estimate.bound
    assert exceeded / trials == pytest.approx(0.005, abs=0.003)  # three standard errors
