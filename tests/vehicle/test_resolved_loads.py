"""Largest wheel loads that steps do not resolve are told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.vehicle.evaluation.resolved_loads import ROUGH, unresolved_loads

JOINT = Path(__file__).parents[2] / "scenes" / "vehicle_joint.toml"
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


def test_a_kink_that_fine_rows_resolve_is_not_told() -> None:
    """A wheel that meets a joint: its load rises within 0.3 ms and falls as fast."""
    time = np.linspace(0.0, 0.1, 667)
    load = np.stack([MEAN + AMPLITUDE * np.exp(-np.abs(time - time[300]) / 3e-4)] * 2, axis=1)[:, None]
    assert load.max() > (1.0 + ROUGH) * load[301].max()
    assert unresolved_loads(time, time, ["a"], load) == []
    assert len(unresolved_loads(time[::2], time[::2], ["a"], load[::2])) == 2


def test_a_run_tells_of_loads_that_its_rows_do_not_resolve() -> None:
    """A joint at 30 m/s, of which rows at an interval miss the peak of 101 kN; rows at all steps do not."""
    sparse, all_steps = (wr.run(JOINT, **{"output.interval": interval}) for interval in (4e-3, 0.0))
    assert all_steps.remarks == []
    for side, remark in zip(("left", "right"), sparse.remarks, strict=True):
        assert remark.startswith(f"The largest load of wheelset {side}, ")
        assert "is not resolved by rows 4 ms apart" in remark
    least, most = (float(run.data["vertical_force"].max()) for run in (sparse, all_steps))
    assert least < (1.0 - ROUGH) * most


def test_samples_without_forces_are_left_out() -> None:
    time, load = ringing(20, 0.0)
    load[5::7] = np.nan
    assert unresolved_loads(time, time, ["a"], load) == []
    assert unresolved_loads(time, time, ["a"], np.full_like(load, np.nan)) == []
    assert unresolved_loads(time[:0], time[:0], ["a"], load[:0]) == []
