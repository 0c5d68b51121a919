"""Patches that are wide against the radii of the bodies, and patches of few points, are named."""

from __future__ import annotations

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.contact.results.resultants import rows_of_points
from wheelrail.meshes.profiles.named import named_profile


def test_half_spaces_do_not_stand_for_a_groove() -> None:
    """Radii of 10 in 10.02 mm: the patch is as wide as the ball; at 06d44fc it was 267 MPa without a word."""
    wide = wr.Hertz((0.01, 0.01), (np.inf, -0.01002), friction=0.0, model="standard").solve(load=1e3)
    (turn,) = wide.data["patch_turn"].values[0]
    half = float(wide.data["patch_semi_axis_y"][0, 0])
    assert turn == pytest.approx(np.arcsin(half / 0.01))
    assert "too wide for half-spaces" in repr(wide)
    narrow = wr.Hertz((0.01, 0.01), (np.inf, -0.02), friction=0.0, model="standard").solve(load=1e2)
    assert "too wide" not in repr(narrow)


def test_turn_of_profiles() -> None:
    """Half the angle between the tangents of the wheel at both edges of the patch, or more by the rail."""
    solution = wr.Wheelset("S1002", "60E1", friction=0.3, model="standard").solve(y=0.0063, wheel_load=8e4, speed=20.0)
    wheel, data = named_profile("S1002"), solution.data.sel(side="left")
    count = int(data["patches"])
    turns, halves, places = (data[name].values[:count] for name in ("patch_turn", "patch_semi_axis_y", "wheel_s"))
    assert turns.max() > 0.05
    for turn, b, s in zip(turns, halves, places, strict=True):
        ends = wheel.point(np.array([s - b, s - b + 1e-6, s + b, s + b + 1e-6]))
        first, last = np.arctan2(*(ends[1::2] - ends[::2]).T[::-1])
        assert turn >= 0.5 * abs(last - first) - 1e-4


@pytest.mark.parametrize(("rows", "columns", "fewest"), [(3, 9, 3), (6, 2, 2), (5, 5, 5)])
def test_points_of_a_grid_across_a_patch(rows: int, columns: int, fewest: int) -> None:
    assert rows_of_points(np.repeat(1e-3 * np.arange(rows), columns)) == fewest
