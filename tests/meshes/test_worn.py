"""Worn profiles: areas of cells, continuity, what stays, and wear that does not fit on a profile."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import wheelrail as wr
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.meshes.profiles.reader import read_profile
from wheelrail.meshes.profiles.worn import cell_bounds, new_arc_length, removed_section

PROFILES = {name: named_profile(name) for name in ("S1002", "60E1", "UIC60-benchmark")}


def measured(folder: Path) -> Profile:
    """S1002 through points of 0.2 mm, as of a file."""
    new = PROFILES["S1002"]
    points = 1e3 * new.point(np.arange(-0.09, 0.058, 2e-4))
    np.savetxt(folder / "wheel.txt", points, fmt="%.6f")
    return read_profile(folder / "wheel.txt", "wheel", rolling_circle=0.0)


def smooth(s: np.ndarray, seed: int, depth: float) -> np.ndarray:
    """Depths m at s m that are as of a duty: bumps 3 to 15 mm wide in the running band, zero outside of it."""
    random = np.random.default_rng(seed)
    found = np.zeros_like(s)
    for _ in range(4):
        half = random.uniform(3e-3, 15e-3)
        x = np.clip((s - random.uniform(-0.04, 0.025)) / half, -1.0, 1.0)
        found += random.uniform(0.0, depth / 2) * (1.0 - x**2) ** 3
    return found


def polygon_area(new: Profile, old: Profile) -> float:
    points = np.concatenate([new.point(new.samples(2e-6)), old.point(old.samples(2e-6))[::-1]]) @ [1.0, 1j]
    return float(-0.5 * np.sum((points.conj() * np.roll(points, -1)).imag))


@pytest.mark.parametrize("name", [*PROFILES, "measured"])
@pytest.mark.parametrize("depth", [2e-5, 1e-3])
def test_area_between_the_curves_is_that_removed(name: str, depth: float, tmp_path: Path) -> None:
    new = PROFILES[name] if name in PROFILES else measured(tmp_path)
    s = cell_bounds(new)
    for seed in range(2):
        areas = np.diff(s) * smooth(0.5 * (s[1:] + s[:-1]), seed, depth)
        worn = new.worn(s, areas)
        assert polygon_area(new, worn) == pytest.approx(areas.sum(), rel=1e-6)
        assert removed_section(new, worn).area == pytest.approx(areas.sum(), rel=1e-5)
        at = worn.samples(1e-4)
        assert np.hypot(*worn.tangent(at).T) == pytest.approx(1.0, abs=1e-9)
        tangents = [worn.tangent(worn.breaks[1:-1] + step) @ [1.0, 1j] for step in (-1e-12, 1e-12)]
        own = [new.tangent(new.breaks[1:-1] + step) @ [1.0, 1j] for step in (-1e-12, 1e-12)]
        kinks, of_new = (np.sort(np.abs(np.angle(after / before))) for before, after in (tangents, own))
        assert kinks[-1] < 1.1 * of_new[-1] + 1e-9, "a corner appears"
        assert worn.point(0.0)[0] == pytest.approx(0.0, abs=1e-15)
        assert worn.point(0.0)[1] <= 0.0


def test_cells_keep_their_areas() -> None:
    """Sections between normals at the bounds of cells, where both directions agree, as polygons."""
    new = PROFILES["S1002"]
    s = cell_bounds(new)
    depth = 1e-3 * np.exp(-((0.5 * (s[1:] + s[:-1]) + 0.036) ** 2) / 5e-3**2)  # over the joint of flange and root
    areas = depth * np.diff(s)
    worn = new.worn(s, areas)
    for i in np.flatnonzero(depth > 1e-4)[::3]:
        ends = np.empty(2)
        for k, bound in enumerate(s[i : i + 2]):  # where the normal at the bound meets the worn curve
            low, high = (worn.closest(new.point([bound])).s[0] + step for step in (-5e-4, 5e-4))
            for _ in range(60):
                middle = 0.5 * (low + high)
                along = float((worn.point(middle) - new.point(bound)) @ new.tangent(bound))
                low, high = (middle, high) if along < 0.0 else (low, middle)
            ends[k] = middle
        outline = [new.point(np.linspace(*s[i : i + 2], 400)), worn.point(np.linspace(*ends[::-1], 400))]
        points = np.concatenate(outline) @ [1.0, 1j]
        area = -0.5 * np.sum((points.conj() * np.roll(points, -1)).imag)
        assert area == pytest.approx(areas[i], rel=2e-6)


def test_what_does_not_wear_stays() -> None:
    new = PROFILES["S1002"]
    s = cell_bounds(new)
    assert new.worn(s, np.zeros(len(s) - 1)).digest() == new.digest()
    areas = np.where(np.abs(0.5 * (s[1:] + s[:-1])) < 5e-3, 1e-8, 0.0)  # a step of 20 um
    worn = new.worn(s, areas)
    kept = new.breaks[1:] < -8e-3
    np.testing.assert_array_equal(worn.coefficients[:, : kept.sum()], new.coefficients[:, kept])
    np.testing.assert_array_equal(worn.coefficients[:, -5:], new.coefficients[:, -5:])
    above = new.closest(worn.point(worn.samples(5e-5))).distance
    assert above.max() < 1e-15, "material is added beside a step"
    assert removed_section(new, worn).area == pytest.approx(areas.sum(), rel=1e-6)


def test_cells_of_part_of_the_profile_and_wide_ones() -> None:
    new = PROFILES["60E1"]
    s = np.linspace(-0.045, 0.03, 151)
    areas = np.diff(s) * 5e-4 * np.exp(-(((0.5 * (s[1:] + s[:-1]) + 0.03) / 3e-3) ** 2))
    worn = new.worn(s, areas)
    assert polygon_area(new, worn) == pytest.approx(areas.sum(), rel=1e-6)
    wide = np.linspace(-0.05, 0.05, 26)
    areas = np.where(np.abs(wide[1:] - 2e-3) < 0.03, 1e-6, 0.0)
    assert polygon_area(new, new.worn(wide, areas)) == pytest.approx(areas.sum(), rel=1e-6)


def test_places_on_the_new_profile() -> None:
    new = PROFILES["S1002"]
    s = cell_bounds(new)
    middle = 0.5 * (s[1:] + s[:-1])
    worn = new.worn(s, np.diff(s) * smooth(middle, 3, 2e-3))
    at = np.linspace(worn.s_range[0] + 1e-3, worn.s_range[1] - 1e-3, 300)
    back = new_arc_length(new, worn, at)
    assert (np.diff(back) > 0.0).all()
    end = worn.s_range[1]
    np.testing.assert_allclose(np.diff(new_arc_length(new, worn, [end, end + 1e-3])), 1e-3)
    foot, normal = new.point(back), new.normal(back)
    across = np.einsum("ij,ij->i", worn.point(at) - foot, new.tangent(back))
    assert np.abs(across).max() < 1e-9
    assert np.einsum("ij,ij->i", worn.point(at) - foot, normal).max() < 1e-12


def test_a_worn_rail_is_inclined_as_a_new_one() -> None:
    s = cell_bounds(rail := PROFILES["60E1"])
    worn = rail.worn(s, np.where(np.abs(s[1:]) < 0.03, 2e-5 * np.diff(s), 0.0), name="rail 7")
    pair = wr.Wheelset(rail=worn, friction=0.0, model="standard")
    assert pair.profiles[1].placement.angle == pytest.approx(0.025, abs=1e-5)
    assert pair.solve(wheel_load=5e4).results["left"].status == "converged"


def test_the_wheel_of_a_loop() -> None:
    data = json.loads((Path(__file__).parents[1] / "vehicle/worn_profile.json").read_text())
    new, depths = PROFILES["S1002"], 1e-6 * np.array(data["depth_um"])
    s = np.linspace(*new.s_range, len(depths) + 1)
    worn = new.worn(s, depths * np.diff(s))
    assert polygon_area(new, worn) == pytest.approx((depths * np.diff(s)).sum(), rel=1e-6)


@pytest.mark.parametrize(
    ("s", "areas", "message"),
    [
        (np.linspace(-0.01, 0.01, 21), np.ones(5), "shape"),
        (np.linspace(-0.01, 0.01, 21), -np.ones(20), "not negative"),
        (np.linspace(-0.01, 0.01, 21) ** 3, np.ones(20), "equal cells"),
        (np.linspace(-0.2, 0.01, 21), np.ones(20), r"s must lie in -0\.0933"),
        (np.linspace(0.06, 0.067, 15), np.full(14, 1e-7), "do not fit"),
        (np.linspace(-0.07, -0.05, 41), np.full(40, 1e-5), r"is deeper than the radius of curvature, 12 mm"),
    ],
)
def test_wear_that_does_not_fit(s: np.ndarray, areas: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        PROFILES["S1002"].worn(s, areas)
