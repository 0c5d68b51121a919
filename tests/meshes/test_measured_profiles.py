"""Measured profiles: noise, rounding and spacing of points, smoothing, and the files of instruments."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from grooved_rails import grooved

from wheelrail.meshes.curves.spline import at_points, through
from wheelrail.meshes.profiles.formats import ProfileError
from wheelrail.meshes.profiles.measurement import RoughProfile, estimated_noise, measured, require_usable
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import from_sections
from wheelrail.meshes.profiles.reader import read_profile

WHEEL, RAIL = named_profile("S1002"), named_profile("60E1")


def stations(name: str, spacing: float) -> np.ndarray:
    """Arc lengths m along the usual measured part."""
    profile = named_profile(name)
    start, stop = profile.s_range
    stop = profile.s_at_y(58e-3) if name == "S1002" else stop - 1e-3
    return np.arange(start + 1e-3, stop, spacing)


def noisy(name: str, noise: float, spacing: float = 2e-4, rounding: float = 1e-9, seed: int = 1) -> np.ndarray:
    """Points (n, 2) m with noise in both coordinates, rounded."""
    points = named_profile(name).point(stations(name, spacing))
    points += noise * np.random.default_rng(seed).standard_normal(points.shape)
    return rounding * np.round(points / rounding)


def written(file: Path, points: np.ndarray, head: str = "", tail: str = "", end: str = "") -> Path:
    """Columns in mm."""
    lines = [f"{1e3 * y:.6f} {1e3 * z:.6f}{end}" for y, z in points]
    file.write_text(head + "\n".join(lines) + "\n" + tail)
    return file


@pytest.mark.parametrize("name", ["S1002", "60E1"])
@pytest.mark.parametrize(("noise", "spacing"), [(2e-6, 2e-4), (5e-6, 2e-4), (1e-5, 5e-4), (1e-4, 5e-4)])
def test_noise_and_its_effect_are_estimated(name: str, noise: float, spacing: float) -> None:
    points = noisy(name, noise, spacing)
    measurement = measured(points, None, "file")
    assert measurement.noise == pytest.approx(noise, rel=0.15)
    assert measurement.smoothing == measurement.noise
    tangent = named_profile(name).tangent(stations(name, spacing))
    direction = at_points(through(points, measurement.smoothing))[1]
    error = np.angle(np.exp(1j * (direction - np.arctan2(tangent[:, 1], tangent[:, 0]))))
    assert 0.4 < measurement.slope_error / np.sqrt(np.mean(error**2)) < 1.5
    assert measurement.interpolated_error > 5.0 * measurement.smoothed_error
    if noise == 1e-4:
        with pytest.raises(RoughProfile, match="measure again"):
            require_usable(measurement)
    else:
        require_usable(measurement)


def test_default_smooths_noise_and_keeps_exact_points(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        worn = read_profile(written(tmp_path / "worn.txt", noisy("S1002", 5e-6)), "wheel")
    assert worn.measurement is not None
    assert worn.measurement.smoothing == pytest.approx(5e-6, rel=0.15)
    s = np.linspace(-0.02, 0.03, 400)
    slope = np.arctan2(*worn.tangent(s).T[::-1]) - np.arctan2(*WHEEL.tangent(s).T[::-1])
    assert np.sqrt(np.mean(slope**2)) < 2e-3  # 4e-2 if interpolated
    assert np.abs(WHEEL.closest(worn.point(s)).distance).max() < 6e-6

    points = noisy("S1002", 0.0, 4e-4)
    exact = read_profile(written(tmp_path / "exact.txt", points), "wheel")
    assert exact.measurement is not None
    assert exact.measurement.smoothing == 0.0
    read = 1e-3 * np.loadtxt(tmp_path / "exact.txt")
    interpolated = from_sections(through(read - read[len(read) // 2]), name="exact", kind="wheel")
    np.testing.assert_array_equal(exact.coefficients[1:], interpolated.coefficients[1:])


def test_rough_points_are_refused_or_a_warning(tmp_path: Path) -> None:
    """0.1 mm of noise or rounding cannot be used; a curve through points with 5 µm can be read but not used."""
    for name, points in (("noise", noisy("60E1", 1e-4)), ("rounded", noisy("60E1", 0.0, rounding=1e-4))):
        file = written(tmp_path / f"{name}.txt", points)
        with pytest.raises(RoughProfile, match=r"line 1: .* points every .*measure again") as raised:
            read_profile(file, "rail")
        assert str(file) in str(raised.value)
    file = written(tmp_path / "fine.txt", noisy("60E1", 5e-6))
    with pytest.warns(UserWarning, match=r"noise of about 5(\.\d)? µm; curve through all .*\d MPa with noise = 5e-06"):
        rough = read_profile(file, "rail", noise=0.0)
    with pytest.raises(RoughProfile, match="allowed: noise = 5e-06"):
        require_usable(rough.measurement)


def test_irregular_spacing_and_rounding_do_not_change_the_curvature(tmp_path: Path) -> None:
    """Heights rounded to 0.1 µm at distances of 5 to 400 µm: within half of the 3.3 per metre of the crown."""
    steps = np.random.default_rng(3).uniform(5e-6, 4e-4, 1000)
    s = RAIL.s_range[0] + 1e-3 + np.cumsum(steps)
    points = RAIL.point(s[s < RAIL.s_range[1] - 1e-3])
    file = written(tmp_path / "rounded.txt", 1e-7 * np.round(points / 1e-7))
    crown = np.linspace(-9e-3, 9e-3, 500)
    assert np.abs(read_profile(file, "rail").curvature(crown) - 1.0 / 0.3).max() < 0.5 / 0.3
    assert np.abs(read_profile(file, "rail", noise=0.0).curvature(crown) - 1.0 / 0.3).max() > 5.0 / 0.3


def test_estimate_is_robust_to_corners_and_coarse_spacing() -> None:
    points = named_profile("S1002").point(np.arange(-0.07, named_profile("S1002").s_range[1] - 1e-4, 5e-4))
    assert estimated_noise(points) < 5e-8  # with the corner of the chamfer
    assert estimated_noise(noisy("60E1", 0.0, 1e-3)) < 2e-7


def test_text_after_numbers(tmp_path: Path) -> None:
    """After the numbers of a line, and after the points, in the formats that have no section marks."""
    points = noisy("60E1", 0.0, 4e-4)
    expected = read_profile(written(tmp_path / "bare.txt", points), "rail")
    s = np.linspace(-0.03, 0.03, 50)
    for suffix, sign in ((".ban", -1.0), (".rail", 1.0), (".txt", 1.0)):
        file = tmp_path / f"measured{suffix}"
        head = "ProgramName=MiniProf\n\n" if suffix == ".ban" else "rail 17, km 3\n"
        written(file, points * (sign, sign if suffix == ".rail" else 1.0), head, "end of data\nOperator A. B.\n", " ok")
        rail = read_profile(file, "rail")
        np.testing.assert_allclose(rail.point(s), expected.point(s), atol=2e-6 if suffix == ".rail" else 1e-12)
        assert rail.measurement is not None
        assert any("text from line" in remark for remark in rail.measurement.remarks)
    broken = tmp_path / "broken.txt"
    lines = (tmp_path / "bare.txt").read_text().splitlines()
    broken.write_text("\n".join([*lines[:50], "a remark", *lines[50:]]))
    with pytest.raises(ProfileError, match="line 51: 'a remark'"):
        read_profile(broken, "rail")


def test_rail_file_with_z_downwards(tmp_path: Path) -> None:
    points = noisy("60E1", 0.0, 4e-4)
    rail = read_profile(written(tmp_path / "down.rail", points * (1.0, -1.0)), "rail")
    assert np.abs(RAIL.closest(rail.point(np.linspace(-0.03, 0.03, 50))).distance).max() < 1e-6


def test_undercut_below_the_head_is_cut_off(tmp_path: Path) -> None:
    """The lower faces of the head, inclined 1:2.75 inwards, follow its sides on both ends."""
    head = noisy("60E1", 0.0, 4e-4)
    inwards = np.arange(1, 30)[:, None] * np.array([5e-4, -5e-4 / 2.75])
    undercut = np.concatenate([(head[0] + inwards)[::-1], head, head[-1] + inwards * (-1.0, 1.0)])
    for name, points in (("forwards", undercut), ("backwards", undercut[::-1])):
        rail = read_profile(written(tmp_path / f"{name}.txt", points), "rail")
        assert np.ptp(rail.point(rail.samples(1e-4)), axis=0) == pytest.approx(np.ptp(head, axis=0), abs=2e-6)
        assert rail.measurement is not None
        remarks = [remark for remark in rail.measurement.remarks if "undercut" in remark]
        assert "lines 1 to 29 " in " ".join(remarks)
        assert len(remarks) == 2
    crown = np.concatenate([head[:150], head[140:]])
    with pytest.raises(ProfileError, match=r"line 151: .* steps back from line 150"):
        read_profile(written(tmp_path / "crown.txt", crown), "rail")


def test_origin_of_a_wheel_is_recognised_or_given(tmp_path: Path) -> None:
    points = noisy("S1002", 0.0, 4e-4)
    expected = read_profile(written(tmp_path / "circle.txt", points), "wheel")
    s = np.linspace(-0.05, 0.05, 50)
    back = read_profile(written(tmp_path / "back.txt", points + np.array([0.070, 0.0])), "wheel")
    np.testing.assert_allclose(back.point(s), expected.point(s), atol=1e-12)
    assert back.measurement is not None
    assert "flange tip at y = 15.0 mm: y is taken from the flange back" in str(back.measurement)
    elsewhere = written(tmp_path / "elsewhere.txt", points + np.array([0.012, 0.0]))
    given = read_profile(elsewhere, "wheel", rolling_circle=0.012)
    np.testing.assert_allclose(given.point(s), expected.point(s), atol=1e-12)
    assert "flange tip at y = -43.0 mm, usually -55 mm" in str(read_profile(elsewhere, "wheel").measurement)


def test_sections_of_one_file(tmp_path: Path) -> None:
    first, second = noisy("60E1", 0.0, 4e-4), noisy("60E1", 0.0, 4e-4) * (1.0, 1.1)
    file = written(tmp_path / "two.txt", first)
    file.write_text(file.read_text() + "\nkm 3.2\n" + written(tmp_path / "other.txt", second).read_text())
    line = len(first) + 3
    with pytest.raises(
        ProfileError, match=rf"line {line}: 2 sections, from lines 1, {line}; allowed: section = 1 to 2"
    ):
        read_profile(file, "rail")
    for number, name in ((1, "two"), (2, "other")):
        rail = read_profile(file, "rail", section=number)
        assert f"section {number} of 2" in str(rail.measurement)
        alone = first if name == "two" else second
        assert np.ptp(rail.point(rail.samples(1e-4))[:, 1]) == pytest.approx(np.ptp(alone[:, 1]), abs=1e-6)
    with pytest.raises(ProfileError, match="section 3 of 2; allowed: 1 to 2"):
        read_profile(file, "rail", section=3)


@pytest.mark.parametrize(("depth", "flangeway"), [(0.047, 0.036), (0.040, 0.040), (0.060, 0.080)])
def test_rails_whose_middle_is_on_a_wall_of_their_groove(depth: float, flangeway: float, tmp_path: Path) -> None:
    """Their curves begin at the middle of the points, where y need not increase."""
    rail, head = grooved(tmp_path, depth, flangeway), named_profile("60E1")
    on_head = head.point(head.samples(1e-3, start=0.0, stop=0.05))
    assert np.abs(rail.closest(on_head).distance).max() < 2e-6  # m, of a spline through points 0.2 mm apart
    np.testing.assert_allclose(rail.point(0.0), 0.0, atol=1e-9)
    y, z = rail.point(rail.samples(1e-4)).T
    assert z[np.abs(y + 0.036 + 0.5 * flangeway) < 5e-3].max() == pytest.approx(-depth, abs=1e-6)  # the floor
