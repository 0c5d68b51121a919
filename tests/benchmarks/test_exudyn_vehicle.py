"""The vehicle in three dimensions beside the same one in Exudyn with the contact element, for a short time."""

from __future__ import annotations

import pytest

from benchmarks.exudyn_vehicle import difference, initial_state, ours, theirs

END, STEP = 0.01, 2e-4  # s


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
