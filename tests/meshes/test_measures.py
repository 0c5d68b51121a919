"""Measures of wheels and rails against polygons, offset polygons and known wear."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import trapezoid

from wheelrail.meshes.profiles.library import load_profile
from wheelrail.meshes.profiles.measures import RailMeasures, WheelMeasures
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.meshes.profiles.worn import cell_bounds

WHEEL, RAIL = named_profile("S1002"), named_profile("60E1")


def of_points(points: np.ndarray) -> tuple[float, float, float]:
    """Sh, Sd, qR m of a polyline (n, 2) m from the flange's back, by linear interpolation."""
    y, z = points.T
    level, tip = np.interp(0.0, y[np.argmax(z) :], z[np.argmax(z) :]), int(np.argmax(z))

    def face(height: float) -> float:
        i = tip + int(np.argmax(z[tip:] < height))
        return float(np.interp(height, [z[i], z[i - 1]], [y[i], y[i - 1]]))

    return z[tip] - level, face(level + 10e-3) + 70e-3, face(level + 10e-3) - face(z[tip] - 2e-3)


def without(new: Profile, depth: Callable[[np.ndarray], np.ndarray]) -> Profile:
    """The new profile without a layer of a depth m over the arc length: of areas d - k d^2 / 2 per length."""
    bounds = cell_bounds(new)
    s = np.linspace(bounds[:-1], bounds[1:], 101, axis=1)
    turn = np.unwrap(np.angle(new.tangent(s) @ [1.0, 1j]))
    return new.worn(bounds, trapezoid(depth(s), s) + trapezoid(0.5 * depth(s) ** 2, turn))


def layer(s: np.ndarray, depth: float = 1e-3, end: float = 0.055) -> np.ndarray:
    """A uniform depth m that ends before the corner of the chamfer."""
    return np.asarray(depth * np.where(s < end - 0.01, 1.0, np.clip((end - s) / 0.01, 0.0, 1.0) ** 3))


def wheel_of(profile: Profile, new: Profile | None = None) -> WheelMeasures:
    found = profile.measures(new)
    assert isinstance(found, WheelMeasures)
    return found


def rail_of(profile: Profile, new: Profile) -> RailMeasures:
    found = profile.measures(new)
    assert isinstance(found, RailMeasures)
    return found


def test_a_new_wheel_and_one_without_a_layer() -> None:
    new = wheel_of(WHEEL, WHEEL)
    assert (new.Sh, new.Sd) == pytest.approx((28e-3, 32.5e-3), abs=1e-9)
    assert (new.qR, new.hollow, new.removed_section) == pytest.approx((10.794e-3, 0.0, 0.0), abs=1e-6)
    assert not new.remarks
    assert not new.beyond()
    depth = 1e-3
    worn = wheel_of(without(WHEEL, layer), WHEEL)
    s = WHEEL.samples(1e-5, stop=0.03)
    expected = of_points(WHEEL.point(s) - depth * WHEEL.normal(s))
    assert (worn.Sh, worn.Sd, worn.qR) == pytest.approx(expected, abs=2e-6)
    s = WHEEL.samples(1e-5)
    section = trapezoid(layer(s) - 0.5 * WHEEL.curvature(s) * layer(s) ** 2, s)
    height = trapezoid(layer(s) * (WHEEL.point(s)[:, 1] - 0.5e-3), s) / section
    assert worn.removed_section == pytest.approx(section, rel=1e-5)
    assert worn.removed_mass == pytest.approx(7850 * 2 * np.pi * section * (0.46 + height), rel=1e-3)
    assert worn.rolling_radius == pytest.approx(0.459, abs=1e-5)


def test_a_worn_flange_and_a_hollow_tread() -> None:
    hollow = wheel_of(without(WHEEL, lambda s: 3e-3 * np.exp(-((s / 12e-3) ** 4))), WHEEL)
    y = np.linspace(-0.02, 0.055, 200001)
    z = WHEEL.point(WHEEL.s_at_y(y))[:, 1] - 3e-3 * np.exp(-((y / 12e-3) ** 4))  # depths are nearly vertical
    assert hollow.hollow == pytest.approx((z - np.minimum.accumulate(z)).max(), abs=2e-5)
    assert hollow.Sh == pytest.approx(31e-3, abs=2e-6)
    assert [words.split()[0] for words in hollow.beyond()] == ["Sd", "hollow"]  # 10 mm above a lower tread
    thin = wheel_of(without(WHEEL, lambda s: 10e-3 * np.exp(-(((s + 0.044) / 15e-3) ** 4))), WHEEL)
    assert any(words.startswith("Sd = 2") and "from memory" in words for words in thin.beyond())


def test_wheels_without_a_flange_or_its_tip(tmp_path: Path) -> None:
    y = np.linspace(-30.0, 30.0, 601)
    np.savetxt(tmp_path / "disc.txt", np.column_stack([y, np.sqrt(300.0**2 - y**2) - 300.0]))
    disc = wheel_of(load_profile(tmp_path / "disc.txt", "wheel", rolling_circle=0.0))
    assert np.isnan([disc.Sh, disc.Sd, disc.qR]).all()
    assert disc.hollow == 0.0
    assert "no flange" in disc.remarks[0]
    points = 1e3 * WHEEL.point(WHEEL.samples(2e-4, start=float(WHEEL.s_at_y(-0.052))))
    np.savetxt(tmp_path / "cut.txt", points)
    cut = wheel_of(load_profile(tmp_path / "cut.txt", "wheel", rolling_circle=0.0, mirror=False), WHEEL)
    assert np.isnan([cut.Sh, cut.qR]).all()
    assert cut.Sd == pytest.approx(32.5e-3, abs=1e-6)
    assert "before the flange's tip" in cut.remarks[0]
    assert "relative" in cut.remarks[1]


@pytest.mark.parametrize("angle", [0.0, 0.025])
def test_wear_of_a_rail(angle: float) -> None:
    new = RAIL.inclined(angle)
    assert values(rail_of(new, new)) == pytest.approx((0.0, 0.0), abs=1e-12)
    s = new.samples(1e-5, start=-0.06, stop=0.0)
    depth = 1e-3
    sides = [np.interp(-14e-3, line[:, 1], line[:, 0]) for line in (new.point(s), new.point(s) - depth * new.normal(s))]
    uniform = rail_of(without(new, lambda s: np.full_like(s, depth)), new)
    assert values(uniform) == pytest.approx((depth, sides[1] - sides[0]), abs=1e-6)
    assert uniform.removed_mass == pytest.approx(7850 * uniform.removed_section)
    gauge = float(new.closest([[-36e-3, -14e-3]]).s[0])
    worn = without(new, lambda s: 4e-3 * np.exp(-(((s - gauge) / 10e-3) ** 4)))
    assert values(rail_of(worn, new)) == pytest.approx((0.0, 4e-3), rel=0.02, abs=1e-12)


def test_side_wear_of_a_grooved_rail_is_that_of_the_head(tmp_path: Path) -> None:
    head = 1e3 * RAIL.point(RAIL.samples(2e-4, start=-0.06))
    lip = [(-100.0, -30.0), (-99.0, -10.0), (-92.0, -9.0), (-86.0, -40.0), (-50.0, -40.0)]
    corners = np.array([*lip, tuple(head[0])])
    steps = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    at = np.arange(0.0, steps[-1], 0.2)
    groove = np.column_stack([np.interp(at, steps, corners[:, i]) for i in (0, 1)])
    np.savetxt(tmp_path / "groove.txt", np.concatenate([groove, head[1:]]))
    rail = load_profile(tmp_path / "groove.txt", "rail", noise=0.0)
    assert values(rail_of(rail, RAIL)) == pytest.approx((0.0, 0.0), abs=1e-5)


def values(rail: RailMeasures) -> tuple[float, float]:
    return rail.W1, rail.W3


def test_bad_input() -> None:
    with pytest.raises(ValueError, match="new is missing"):
        RAIL.measures()
    with pytest.raises(ValueError, match="new must be a wheel, 60E1 is a rail"):
        WHEEL.measures(RAIL)
