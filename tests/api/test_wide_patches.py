"""Patches wide against the radii of the bodies, and patches of few points, are named; minute ones are right."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import wheelrail as wr
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.results.resultants import rows_of_points
from wheelrail.meshes.profiles.named import named_profile


def test_half_spaces_do_not_stand_for_a_groove() -> None:
    """Radii of 10 in 10.02 mm: the patch is as wide as the ball."""
    wide = wr.Hertz((0.01, 0.01), (np.inf, -0.01002), friction=0.0, model="standard").solve(load=1e3)
    (turn,) = wide.data["patch_turn"].values[0]
    half = float(wide.data["patch_semi_axis_y"][0, 0])
    assert turn == pytest.approx(np.arcsin(half / 0.01))
    assert "too wide for half-spaces" in repr(wide)
    narrow = wr.Hertz((0.01, 0.01), (np.inf, -0.02), friction=0.0, model="standard").solve(load=1e2)
    assert "too wide" not in repr(narrow)


def clearance(angle: float) -> float:
    """E* dR / Q of a cylinder in a bore of the same material, E* of one body, over half the angle of the contact.

    A. Persson, 1964; with this b, M. Ciavarella and P. Decuzzi, Int. Journal of Solids and Structures 38 (2001).
    The pressure is in equilibrium with the load, and small angles are those of Hertz.
    """
    b = np.tan(0.5 * angle)
    return float((2.0 - np.log(b * b + 1.0) - 2.0 * b**4) / (np.pi * (b * b + 1.0) * b * b))


def pressure(angle: float, at: float = 0.0) -> float:
    """Pressure times R / Q at an angle from the middle, source as for `clearance`."""
    b, y = np.tan(0.5 * angle), np.tan(0.5 * at)
    s, d = np.sqrt(b * b + 1.0), np.sqrt(b * b - y * y)
    return float(2.0 / np.pi / s * d / (1.0 + y * y) + np.log((s + d) / (s - d)) / (2.0 * np.pi * b * b * s * s))


@pytest.mark.parametrize(
    ("load", "turn", "wider", "lower", "warns"),
    [(1e3, 0.16, 0.007, 0.010, False), (6e3, 0.30, 0.023, 0.032, False), (4e4, 0.59, 0.078, 0.102, True)],
)
def test_conforming_cylinders(load: float, turn: float, wider: float, lower: float, warns: bool) -> None:
    """The line load in the middle of a patch 99 times as long as wide, radii 1 in 1.02 mm: where the warning begins,
    half-spaces have 2.3 % more width and 3.2 % less pressure.
    """
    assert quad(lambda at: pressure(0.8, at) * np.cos(at), -0.8, 0.8)[0] == pytest.approx(1.0, rel=1e-6)
    pair = wr.Hertz((100.0, 1e-3), (np.inf, -1.02e-3), friction=0.0, model="standard", normal="hertz")
    solved = pair.solve(load=load)
    names = ("patch_semi_axis_y", "patch_max_pressure", "patch_turn")
    half, peak, turned = (float(solved.data[name][0, 0]) for name in names)
    line, modulus, mean = 0.5 * np.pi * half * peak, 2.1e11 / (1.0 - 0.3**2), np.sqrt(1e-3 * 1.02e-3)
    angle = brentq(lambda e: clearance(e) - modulus * 0.02e-3 / line, 1e-3, 1.4)
    assert turned == pytest.approx(turn, abs=0.005)
    assert half / mean / angle - 1.0 == pytest.approx(wider, abs=0.002)
    assert 1.0 - peak * mean / line / pressure(angle) == pytest.approx(lower, abs=0.002)
    assert ("too wide" in repr(solved)) is warns


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


@pytest.mark.parametrize("approach", [1e-10, 1e-9, 5e-9])
@pytest.mark.parametrize("radii", [((0.46, np.inf), (np.inf, 0.3)), ((0.1, 0.1), (np.inf, np.inf))])
def test_patches_smaller_than_a_cell_of_the_bodies(radii: tuple[tuple[float, float], ...], approach: float) -> None:
    """The bodies are blocks of many cells, however small the patch."""
    along, across = (sum(0.5 / body[k] for body in radii) for k in (0, 1))
    expected = hertz(along, across, modulus((210e9, 0.3), (210e9, 0.3)), approach=approach)
    found = wr.Hertz(*radii, friction=0.0).solve(approach=approach)
    assert float(found.data["vertical_force"][0]) == pytest.approx(expected.force, rel=6e-4)
