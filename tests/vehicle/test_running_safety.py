"""Evaluation after EN 14363: filters, sliding means, percentiles, limits."""

from __future__ import annotations

import re

import numpy as np
import pytest

from wheelrail.scenes.html_report.elements import PageTable
from wheelrail.scenes.runs.safety_table import safety_table
from wheelrail.vehicle.evaluation.running_safety import (
    INTERVAL,
    instability,
    largest_wheel_load,
    low_pass,
    sliding_mean,
    wheelset_safety,
)


def test_sliding_mean_of_a_piecewise_linear_signal_is_exact() -> None:
    """Uneven samples; the mean of a straight line is its value in the middle of the window."""
    distance = np.cumsum(np.random.default_rng(1).uniform(0.01, 0.3, 200))
    means = sliding_mean(distance, 3.0 - 2.0 * distance)
    middles = distance[0] + 1.0 + 0.5 * np.arange(len(means))
    np.testing.assert_allclose(means, 3.0 - 2.0 * middles, rtol=1e-12)
    step = np.where(distance > 10.0, 1.0, 0.0)
    assert sliding_mean(distance, step).max() == pytest.approx(1.0)
    with pytest.raises(ValueError, match="must be 2 m at least"):
        sliding_mean(distance[:4], step[:4])


@pytest.mark.parametrize("frequency", [2.0, 20.0, 40.0])
def test_low_pass_filter(frequency: float) -> None:
    """Gain of a Butterworth filter of order 4 by the bilinear transformation: 3 dB at 20 Hz, 24 dB an octave above."""
    gain = (1.0 + (np.tan(np.pi * frequency * INTERVAL) / np.tan(np.pi * 20.0 * INTERVAL)) ** 8) ** -0.5
    time = INTERVAL * np.arange(5000)
    filtered = low_pass(np.sin(2 * np.pi * frequency * time))[1000:]
    assert np.abs(filtered).max() == pytest.approx(gain, rel=0.01)
    np.testing.assert_allclose(low_pass(np.full(100, 7.0)), 7.0, rtol=1e-9)


def test_a_steady_run_has_its_own_forces_and_the_limits_of_its_load() -> None:
    time = np.linspace(0.0, 4.0, 50)
    guiding = np.tile([5e3, 20e3], (50, 1))
    load = np.tile([50e3, 70e3], (50, 1))
    safety = wheelset_safety(time, 30.0 * time, guiding, load, 60e3)
    assert safety.track_shifting.value == pytest.approx(15e3)
    assert [one.value for one in safety.quotient] == pytest.approx([0.1, 2 / 7])
    assert [one.value for one in safety.load] == pytest.approx([50e3, 70e3])
    assert safety.track_shifting.limit == pytest.approx(50e3)  # 10 kN and a third of 120 kN
    assert safety.load[0].limit == pytest.approx(150e3)
    assert safety.instability.value == pytest.approx(0.0, abs=1.0)
    freight = wheelset_safety(time, 30.0 * time, guiding, load, 60e3, 0.85)
    assert freight.track_shifting.limit == pytest.approx(42.5e3)
    mirrored = wheelset_safety(time, 30.0 * time, guiding[:, ::-1], load[:, ::-1], 60e3)
    assert mirrored.track_shifting.value == pytest.approx(-15e3)


def test_limits_are_exceeded_at_their_places() -> None:
    """A push of 60 kN on the left wheel, with twice the load on the right one, from 80 to 90 m of 300 m."""
    time = np.linspace(0.0, 10.0, 3001)
    there = (30.0 * time >= 80.0) & (30.0 * time <= 90.0)
    guiding = np.stack([np.where(there, 60e3, 1e3), np.full(3001, 2e3)], axis=1)
    load = np.stack([np.full(3001, 60e3), np.where(there, 160e3, 60e3)], axis=1)
    safety = wheelset_safety(time, 30.0 * time, guiding, load, 60e3)
    assert safety.track_shifting.value == pytest.approx(-58e3, rel=0.05)
    for one in (safety.track_shifting, safety.quotient[0], safety.load[1]):
        assert one.passed is False
        assert 80.0 < one.place < 92.0  # the filter lags by a third of a metre
    assert safety.quotient[1].passed is safety.load[0].passed is True
    short = wheelset_safety(time[:600], 30.0 * time[:600], guiding[:600], load[:600], 60e3)
    assert short.instability.passed is None
    rows = {str(row[0]): row for row in PageTable.of(safety_table({"front": safety, "rear": short})).rows}
    assert rows["Y/Q, 2 m mean, left"][-2:] == ["0.8", "FAIL"]
    assert rows["Y/Q, 2 m mean, right"][-1] == "pass"
    assert rows["Q, right [kN]"][-2:] == ["150", "FAIL"]
    assert rows["rms of the sum of Y over 100 m [kN]"][2] == "-"
    assert re.fullmatch(r"1\.0\d\d at 8\d", rows["Y/Q, 2 m mean, left"][1])


def test_instability_is_the_rms_about_the_main_frequency() -> None:
    """Hunting of 8 kN at 6 Hz; noise at 15 Hz and a steady force do not count."""
    time = INTERVAL * np.arange(4000)
    force = 3e3 + 8e3 * np.sin(2 * np.pi * 6.0 * time) + 5e3 * np.sin(2 * np.pi * 15.0 * time)
    value, place = instability(50.0 * time, force)
    assert value == pytest.approx(8e3 / np.sqrt(2.0), rel=0.01)
    assert 50.0 <= place <= 350.0
    assert np.isnan(instability(10.0 * time, force)).all()


def test_largest_wheel_loads() -> None:
    assert [largest_wheel_load(v / 3.6) for v in (100, 180, 240, 290, 320)] == [200e3, 190e3, 180e3, 170e3, 160e3]
