"""Equivalent conicity against the closed form of a cubic and the reference cases of EN 15302."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.special import beta

import wheelrail as wr
from wheelrail.contact.geometry.conicity import equivalent_conicity
from wheelrail.meshes.curves.arc_length import arc, line
from wheelrail.meshes.profiles.profile import Kind, Profile, from_sections
from wheelrail.support.arrays import Array

# profiles and conicities of the standard's cases, from the same repository; too large to be kept here
TABLES = Path(__file__).parents[4] / "shared" / "reference" / "en15302.json"

# EN 15302:2008+A1:2010, annex E, cases E1 (wheels A) and E2 (wheels B) on rail A, as tabulated in the repository
# criogenox/B_ECC-Equivalent-Conicity-Calculation: differences of the rolling radii in mm every 0.1 mm of y from 0 on,
# and the conicity at amplitudes in mm, to three decimals
SMOOTH = """0 0.032 0.051 0.071 0.092 0.116 0.142 0.167 0.197 0.227 0.257 0.292 0.328 0.361 0.402 0.443 0.481 0.527
    0.574 0.616 0.667 0.719 0.766 0.822 0.879 0.931 0.992 1.055 1.111 1.177 1.236 1.299 1.346 1.407 1.471 1.539 1.598
    1.673 1.752 1.834 1.906 1.995 2.088 2.185 2.286 2.373 2.481 2.593 2.709 2.808 2.931 3.058 3.189 3.324 3.44 3.582
    3.729 3.879 4.008 4.166 4.328 4.494 4.636 5.064 5.692 6.521 7.597 9.01 10.954"""
SMOOTH_CONICITY = """1 0.125 1.5 0.139 2 0.155 2.5 0.171 3 0.188 3.5 0.202 4 0.216 4.5 0.234 5 0.254 5.5 0.277 6 0.303
    6.3 0.321 6.5 0.348 6.8 0.427"""
JUMPING = """0 0.005 0.01 0.015 0.02 0.025 0.03 0.035 0.04 0.045 0.05 0.055 0.06 0.065 0.07 0.075 0.08 0.085 0.09 0.095
    0.1 0.105 0.11 0.115 0.12 0.125 0.13 0.135 0.14 0.145 1.95 2.003 2.057 2.112 2.167 2.224 2.281 2.339 2.397 2.457
    2.517 2.578 2.64 2.702 2.766 2.83 2.895 2.961 3.027 3.095 3.163 3.232 3.302 3.372 3.444 3.516 3.589 3.663 3.737
    3.813 3.889 3.966 4.044 4.123 5.392 6.111 7.05 8.27 9.895"""
JUMPING_CONICITY = """2 0.025 2.9 0.025 3 0.058 3.1 0.097 3.2 0.128 3.5 0.189 4 0.241 4.5 0.267 5 0.283 5.5 0.293
    6 0.302 6.3 0.306 6.4 0.319 6.5 0.336 6.8 0.407"""


@pytest.mark.parametrize(("difference", "conicity"), [(SMOOTH, SMOOTH_CONICITY), (JUMPING, JUMPING_CONICITY)])
def test_reference_cases_of_en_15302(difference: str, conicity: str) -> None:
    """To the last decimal of the standard's table, where it allows 0.05 or half of the value."""
    difference_m = 1e-3 * np.array(difference.split(), dtype=float)
    amplitude, expected = np.array(conicity.split(), dtype=float).reshape(-1, 2).T
    y = 1e-4 * np.arange(len(difference_m))
    found = equivalent_conicity(y, difference_m, 1e-3 * amplitude, base=1.5, radius=0.46)
    np.testing.assert_allclose(found, expected, rtol=0, atol=6e-4)


def test_conicity_of_a_cubic_radius_difference() -> None:
    """y'' + c y^3 = 0 swings in 7.4163 / (sqrt(c) A) m (a quarter is B(1/4, 1/2) sqrt(2) / 4 over that)."""
    y, c, base, radius = np.linspace(0.0, 6e-3, 1201), 3.0, 1.5, 0.46
    found = equivalent_conicity(y, base * radius * c * y**3, np.array([3e-3, 6e-3]), base=base, radius=radius)
    length = np.sqrt(2.0) * beta(0.25, 0.5) / (np.sqrt(c) * np.array([3e-3, 6e-3]))
    assert found == pytest.approx(2.0 * base * radius * (np.pi / length) ** 2, rel=1e-4)


def test_a_narrower_track_makes_s1002_more_conical() -> None:
    """Known for its wear-adapted shape: the flange root is closer to the rail."""
    found = [
        wr.contact_geometry("S1002", "60E1", [3e-3], gauge=gauge).equivalent_conicity.item()
        for gauge in (1.432, 1.435, 1.438)
    ]
    assert found[0] > found[1] > found[2] > 0.025


@pytest.mark.parametrize("slope", [0.025, 0.05, 0.1])
def test_a_cone_has_the_conicity_of_its_slope(slope: float) -> None:
    """The standard's wheelset does not roll; with roll the crown of 300 mm under the wheel moves the contact."""
    wheel = from_sections([line(-0.06 + 0.06j * slope, 0.06 - 0.06j * slope)], name="cone", kind="wheel")
    rail = from_sections([arc(-0.3j, 0.3, np.pi / 2 + 0.2, np.pi / 2 - 0.2)], name="crown", kind="rail")
    found = wr.contact_geometry(wheel, rail, [1e-3, 3e-3], gauge_height=0.005)
    np.testing.assert_allclose(found.equivalent_conicity, slope, rtol=1e-4)
    assert found.equivalent_conicity_with_roll.values[0] > 1.02 * slope


@pytest.mark.skipif(not TABLES.exists(), reason="the tables of the standard are not here")
@pytest.mark.parametrize("case", ["E1", "E2", "E4", "E5", "E7"])
def test_reference_profiles_of_en_15302(tmp_path: Path, case: str) -> None:
    """Within the standard's tolerances; from E5 on the left wheel is 1 mm smaller."""
    tables = json.loads(TABLES.read_text())
    given, track = tables["cases"][case], tables["track"]

    def profile(name: str, kind: Kind, sign: float) -> Profile:
        np.savetxt(tmp_path / f"{name}.txt", np.array(tables["profiles"][name]) * (1.0, sign), fmt="%.5f")
        return wr.profile(tmp_path / f"{name}.txt", kind, noise=0.0)

    rows = np.array(given["values"])[[0, 2, 4, 6]]
    found = wr.contact_geometry(
        profile(f"wheel {given['left']}", "wheel", -1.0),
        profile("rail", "rail", 1.0),
        1e-3 * rows[:, 0],
        gauge=1e-3 * track["gauge"],
        gauge_height=1e-3 * track["gauge_height"] - 1e-7,  # the table ends at it
        laying_angle=0.0,
        flange_back_distance=1e-3 * track["flange_back_distance"],
        left={"radius": 1e-3 * given["left_radius"]},
        right={"radius": 1e-3 * given["right_radius"]},
    ).equivalent_conicity.values
    assert (found <= rows[:, 2]).all()
    assert (found >= rows[:, 3]).all()


def test_a_motion_that_does_not_return_has_no_conicity() -> None:
    """Equal radii within 1.6 mm of the middle, as in case E4, or a difference that drives outwards."""
    y = np.linspace(0.0, 4e-3, 401)
    for inner in (0.0, -1e-4):
        difference = np.where(y < 1.6e-3, inner * (y > 0.0), 2e-3)
        found = equivalent_conicity(y, difference, np.array([1e-3, 3e-3, 5e-3]), base=1.5, radius=0.46)
        assert found[0] == 0.0
        assert 0.2 < found[1] < 0.4
        assert np.isnan(found[2])


def test_sides_that_differ_oscillate_about_equal_radii() -> None:
    """Cones of different radii have the conicity of their slope, about another position; a motion beyond y has none."""
    y, slope = np.linspace(-8e-3, 8e-3, 161), 0.05
    amplitude = np.array([1e-3, 5e-3, 6e-3])
    conicity = equivalent_conicity(y, 2 * slope * (y - 2.05e-3), amplitude, base=1.5, radius=0.46)
    np.testing.assert_allclose(conicity[:2], slope, rtol=1e-9)
    assert np.isnan(conicity[2])


def test_a_shifted_difference_has_the_conicity_of_the_centred_one() -> None:
    y, amplitude = np.linspace(-8e-3, 8e-3, 1601), np.array([2e-3, 4e-3])

    def difference(y: Array) -> Array:
        return np.asarray(0.2 * y + 2e4 * y**3)

    centred = equivalent_conicity(y[800:], difference(y[800:]), amplitude, base=1.5, radius=0.46)
    shifted = equivalent_conicity(y, difference(y - 1.5e-3), amplitude, base=1.5, radius=0.46)
    np.testing.assert_allclose(shifted, centred, rtol=1e-5)
