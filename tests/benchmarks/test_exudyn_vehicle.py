"""The vehicle in three dimensions beside the same one in Exudyn, with the contact element and on moving tracks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.exudyn.on_tracks import OnTracks
from benchmarks.exudyn_vehicle import difference, initial_state, ours, theirs

END, STEP = 0.01, 2e-4  # s
TRACKS = Path(__file__).with_name("exudyn_tracks.json")  # by benchmarks.exudyn.tracks_model, Exudyn 1.13.6


@pytest.mark.parametrize("curve", [False, True], ids=["straight", "curve"])
def test_the_vehicle_is_that_of_exudyn_with_the_element(curve: bool) -> None:
    pytest.importorskip("exudyn")
    state = initial_state()
    rows = theirs(state, END, STEP, curve=curve)
    own = ours(state, END, curve=curve)
    lengths, angles = difference(own, rows)
    assert lengths < 1e-8  # m; 2e-9 of it by Exudyn's step
    assert angles < 1e-8  # rad
    moved, _ = difference(own, state[: own.size].reshape(own.shape))
    assert moved > 1e-4  # m


def test_the_vehicle_on_co_running_tracks_is_that_of_exudyn() -> None:
    """Random start on rails and sleepers with mass below each wheelset; the contact is a smooth law, written twice."""
    case, known = OnTracks(), json.loads(TRACKS.read_text(encoding="utf-8"))
    tracks = 1e-9  # m: stiffnesses of rails, sampled to a tolerance, differ by 6e-6 between versions of libraries
    np.testing.assert_allclose(case.initial[: len(known["initial"])], known["initial"], rtol=1e-10, atol=tracks)
    position = np.array(known["position"])
    lengths, angles = difference(own := case.ours(known["time"]), position)
    assert lengths < tracks  # 2e-11 m with the same stiffness, by Exudyn's step
    assert angles < tracks
    moved, _ = difference(own, case.initial[: own.size].reshape(own.shape))
    assert moved > 1e-4  # m
