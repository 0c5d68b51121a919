"""Largest wheel loads that steps do not resolve are told."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.vehicle.evaluation.resolved_loads import ROUGH, unresolved_loads

MEAN, AMPLITUDE, PERIOD = 5e4, 3e4, 5e-3  # N, N, s: a wheel that rings on its contact


def ringing(samples: int, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and loads (n, 1, 2) of a vibration that decays, by a number of samples a period; the right wheel rests."""
    time = (np.arange(40 * samples) + shift) * PERIOD / samples
    load = MEAN + AMPLITUDE * np.exp(-time / 0.1) * np.sin(2.0 * np.pi * time / PERIOD)
    return time, np.stack([load, np.full_like(load, MEAN)], axis=1)[:, None]


@pytest.mark.parametrize("shift", [0.0, 0.3, 0.7])
def test_a_vibration_of_few_samples_is_told(shift: float) -> None:
    time, load = ringing(5, shift)
    (remark,) = unresolved_loads(time, 20.0 * time, ["wheelset_1"], load)
    largest = load[:, 0, 0].max()
    assert remark.startswith(f"The largest load of wheelset_1 left, {1e-3 * largest:.4g} kN at ")
    told = 0.01 * float(remark.split()[-1].rstrip("%"))
    assert MEAN + AMPLITUDE * np.exp(-PERIOD / 0.4) < (1.0 + told) * largest + 5e2


def test_a_vibration_of_many_samples_is_not_told() -> None:
    time, load = ringing(20, 0.5)
    assert AMPLITUDE / (MEAN + AMPLITUDE) * (1.0 - np.cos(2.0 * np.pi / 20)) < ROUGH
    assert unresolved_loads(time, 20.0 * time, ["wheelset_1"], load) == []


def test_samples_without_forces_are_left_out() -> None:
    time, load = ringing(20, 0.0)
    load[5::7] = np.nan
    assert unresolved_loads(time, time, ["a"], load) == []
    assert unresolved_loads(time, time, ["a"], np.full_like(load, np.nan)) == []
    assert unresolved_loads(time[:0], time[:0], ["a"], load[:0]) == []
