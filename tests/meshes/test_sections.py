"""Closed outlines of rail and wheel sections."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import trapezoid

from wheelrail.meshes.bodies.outlines import rail_outline, rim_outline, wheel_outline
from wheelrail.meshes.bodies.wheel_web import WheelShape, rounded
from wheelrail.meshes.profiles.library import load_profile
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Profile

INCLINED = np.arctan(1 / 40)


def properties(polygon: np.ndarray) -> dict[str, float]:
    """Area, centroid, second moments about it, by Green's theorem."""
    x, y = polygon.T
    u, v = np.roll(x, -1), np.roll(y, -1)
    c = u * y - x * v  # clockwise is positive
    area = c.sum() / 2
    cx, cy = ((x + u) * c).sum() / (6 * area), ((y + v) * c).sum() / (6 * area)
    ix = ((y * y + y * v + v * v) * c).sum() / 12 - area * cy**2
    iy = ((x * x + x * u + u * u) * c).sum() / 12 - area * cx**2
    return {"area": area, "cx": cx, "cy": cy, "ix": ix, "iy": iy}


def simple(polygon: np.ndarray) -> bool:
    """Whether no two edges cross, by comparing every pair."""
    p = polygon[:, 0] + 1j * polygon[:, 1]
    d = np.roll(p, -1) - p

    i, j = np.triu_indices(len(p), 2)
    i, j = (k[(i > 0) | (j < len(p) - 1)] for k in (i, j))
    turn = (d[i].conj() * d[j]).imag
    skew = np.abs(turn) > 1e-9 * np.abs(d[i] * d[j])
    between = (p[j] - p[i])[skew]
    t, u = ((between.conj() * d[k][skew]).imag / turn[skew] for k in (j, i))
    return not ((t > 0) & (t < 1) & (u > 0) & (u < 1)).any()


def test_section_properties_of_60e1() -> None:
    # EN 13674-1: 76.70 cm2, 3038.3 and 512.3 cm4, centroid 80.92 mm above the underside
    found = properties(rail_outline(named_profile("60E1"), chord_error=1e-7).polygon(5e-5))
    assert found["area"] * 1e4 == pytest.approx(76.70, abs=0.005)
    assert found["ix"] * 1e8 == pytest.approx(3038.3, abs=0.05)
    assert found["iy"] * 1e8 == pytest.approx(512.3, abs=0.05)
    assert found["cy"] * 1e3 + 172 == pytest.approx(80.92, abs=0.005)
    assert abs(found["cx"]) < 1e-12


def test_chord_error_falls_with_its_square_of_segments() -> None:
    areas = [
        properties(rail_outline(named_profile("60E1"), chord_error=e).polygon(5e-5))["area"] for e in (8e-5, 2e-5, 5e-6)
    ]
    exact = properties(rail_outline(named_profile("60E1"), chord_error=2e-8).polygon(5e-5))["area"]
    slope = np.polyfit(np.log([8e-5, 2e-5, 5e-6]), np.log(np.abs(np.array(areas) - exact)), 1)[0]
    assert slope == pytest.approx(1.0, abs=0.25)


@pytest.mark.parametrize("profile", [named_profile("60E1").inclined(INCLINED), named_profile("UIC60-benchmark")])
def test_inclined_rail_is_the_rotated_upright_one(profile: Profile) -> None:
    outline, upright = rail_outline(profile), rail_outline(named_profile("60E1"))
    polygon = outline.polygon(1e-3)
    assert simple(polygon)
    edges = np.hypot(*(np.roll(polygon, -1, axis=0) - polygon).T)
    assert edges.min() > 1e-4
    np.testing.assert_allclose(outline.boundary[1:-1], profile.placement(upright.boundary[1:-1]), atol=1e-12)
    foot = outline.boundary[outline.clamped[0] : outline.clamped[1] + 1]
    np.testing.assert_allclose(np.hypot(*np.diff(foot, axis=0)[0]), 0.146)
    np.testing.assert_allclose((foot[0] - foot[1])[1] / (foot[0] - foot[1])[0], np.tan(INCLINED))
    held = outline.is_clamped(np.array([foot.mean(axis=0), foot[0], outline.boundary[0], [0.0, 0.0]]))
    assert list(held) == [True, True, False, False]
    np.testing.assert_allclose(outline.surface(outline.surface_range[1]), outline.boundary[0], atol=1e-15)


def test_worn_rail_is_joined_to_the_standard_section(tmp_path: Path) -> None:
    new = named_profile("60E1").inclined(INCLINED)
    points = new.point(np.linspace(new.s_range[0] + 12e-3, new.s_range[1] - 14e-3, 300)) * 1e3
    worn = points + np.stack([2.0 * (points[:, 0] < -20), np.zeros(300)], axis=1) * np.clip(
        (-20 - points[:, :1]) / 15, 0, 1
    )
    path = tmp_path / "worn.csv"
    path.write_text("\n".join(f"{y:.6f},{z:.6f}" for y, z in worn))
    profile = load_profile(path, "rail", inclination=INCLINED)
    outline = rail_outline(profile)
    assert outline.surface_range == pytest.approx(profile.s_range)
    assert simple(outline.polygon(1e-3))
    lost = properties(rail_outline(new).polygon(1e-3))["area"] - properties(outline.polygon(1e-3))["area"]
    assert 5e-6 < lost < 60e-6  # m2: 2 mm over a face of about 15 mm, and the line on to the foot of the flank
    foot, standard = (o.boundary[slice(*o.clamped)] for o in (outline, rail_outline(new)))
    np.testing.assert_allclose(foot, standard, atol=2e-6)  # the field side determines the position of the section


def test_incompatible_rail_is_rejected(tmp_path: Path) -> None:
    new = named_profile("60E1")
    points = new.point(np.linspace(*new.s_range, 300)) * (1.4e3, 1e3)
    path = tmp_path / "broad.csv"
    path.write_text("\n".join(f"{y:.6f},{z:.6f}" for y, z in points))
    with pytest.raises(ValueError, match="from the standard section"):
        rail_outline(load_profile(path, "rail"))
    with pytest.raises(ValueError, match="not a rail"):
        rail_outline(named_profile("S1002"))


def test_wheel_rim() -> None:
    wheel = named_profile("S1002")
    outline = rim_outline(wheel, 0.46)
    polygon = outline.polygon(5e-4)
    assert simple(polygon)
    np.testing.assert_allclose([polygon[:, 0].min(), polygon[:, 0].max(), polygon[:, 1].min()], [-0.07, 0.065, 0.395])
    assert polygon[:, 1].max() == pytest.approx(0.488, abs=3e-6)  # tip of the flange, 28 mm
    # area: rim below the rolling circle, and the integral of the profile over its width
    y = np.linspace(-0.07, 0.065, 20001)
    expected = 0.135 * 0.065 + trapezoid(wheel.point(wheel.s_at_y(y))[:, 1], y)
    assert properties(polygon)["area"] == pytest.approx(expected, rel=1e-5)
    inner = outline.boundary[outline.clamped[0] : outline.clamped[1] + 1]
    np.testing.assert_allclose(inner, [[0.065, 0.395], [-0.07, 0.395]])


def test_wheel_without_chamfer_is_continued_to_its_faces(tmp_path: Path) -> None:
    wheel = named_profile("S1002")
    s = wheel.s_at_y(np.linspace(-0.0690, 0.0550, 400))
    path = tmp_path / "short.csv"
    path.write_text("\n".join(f"{y * 1e3:.6f},{z * 1e3:.6f}" for y, z in wheel.point(s)))
    outline = rim_outline(load_profile(path, "wheel"), 0.46)
    polygon = outline.polygon(1e-3)
    assert simple(polygon)
    np.testing.assert_allclose([polygon[:, 0].min(), polygon[:, 0].max()], [-0.07, 0.065])
    held = outline.boundary[outline.clamped[0] : outline.clamped[1] + 1]
    np.testing.assert_allclose(held, [[0.065, 0.395], [-0.07, 0.395]])


def test_incompatible_wheels_are_rejected() -> None:
    wheel = named_profile("S1002")
    with pytest.raises(ValueError, match="into a rim"):
        rim_outline(wheel, 0.46, rim_thickness=0.01)
    with pytest.raises(ValueError, match="wide"):
        rim_outline(wheel, 0.46, faces=(-0.2, 0.2))
    with pytest.raises(ValueError, match="not a wheel"):
        rim_outline(named_profile("60E1"), 0.46)


def test_wheel_with_web_and_hub() -> None:
    wheel, shape = named_profile("S1002"), WheelShape()
    outline = wheel_outline(wheel, 0.46)
    polygon = outline.polygon(5e-4)
    assert simple(polygon)
    np.testing.assert_allclose([polygon[:, 0].min(), polygon[:, 0].max(), polygon[:, 1].min()], [-0.1, 0.08, 0.0925])
    bore = outline.boundary[outline.clamped[0] : outline.clamped[1] + 1]
    np.testing.assert_allclose(bore, [[0.08, 0.0925], [-0.1, 0.0925]])
    np.testing.assert_array_equal(outline.is_clamped(np.array([[0.0, 0.0925], [0.065, 0.395]])), [True, False])
    # rim, a web of trapezium's shape, hub, and four fillets of nearly right angles: R^2 (1 - pi / 4)
    rim = properties(rim_outline(wheel, 0.46).polygon(5e-4))["area"]
    web = 0.5 * sum(shape.web) * (0.395 - 0.135)
    fillets = 2 * (0.035**2 + 0.045**2) * (1 - np.pi / 4)
    expected = rim + web + 0.18 * (0.135 - 0.0925) + fillets
    assert properties(polygon)["area"] == pytest.approx(expected, rel=3e-3)
    # the web between the fillets is as thick as it should be, half way 27.5 mm
    y = polygon[np.abs(polygon[:, 1] - 0.265) < 0.2]
    front, back = (y[y[:, 0] * side > 0] for side in (1, -1))
    middle = [np.interp(0.265, *p[np.argsort(p[:, 1])].T[::-1]) for p in (front, back)]
    assert middle[0] - middle[1] == pytest.approx(0.0275, abs=2e-4)


def test_fillets_are_tangent_on_both_sides() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.5, 1.0]])
    radius = 0.3
    found = rounded(corners, np.array([0.0, radius, 0.0]), chord_error=1e-6)
    arc = found[1:-1]
    direction = np.array([0.5, 1.0]) / np.hypot(0.5, 1.0)
    centre = np.array([arc[0, 0], radius])
    np.testing.assert_allclose(np.hypot(*(arc - centre).T), radius)
    assert arc[0, 1] == pytest.approx(0.0, abs=1e-15)
    assert np.cross(direction, arc[-1] - corners[1]) == pytest.approx(0.0, abs=1e-12)
    assert np.dot(direction, arc[-1] - centre) == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(ValueError, match="do not fit"):
        rounded(corners, np.array([0.0, 3.0, 0.0]))


def test_invalid_wheel_shapes_are_rejected() -> None:
    wheel = named_profile("S1002")
    with pytest.raises(ValueError, match="bore"):
        WheelShape(bore_radius=0.14)
    with pytest.raises(ValueError, match="web"):
        WheelShape(web_middle=(0.06, 0.0))
    with pytest.raises(ValueError, match="positive"):
        WheelShape(fillets=(0.0, 0.04))
    with pytest.raises(ValueError, match="hub"):
        wheel_outline(wheel, 0.19)
    with pytest.raises(ValueError, match="not a wheel"):
        wheel_outline(named_profile("60E1"), 0.46)


def test_a_small_wheel_has_smaller_fillets() -> None:
    """A web of 50 mm, lower than the fillets of a wagon's wheel; at 06d44fc such a wheel was refused."""
    section = WheelShape().below_the_rim(0.25, 0.065, -0.070)
    web = section[(section[:, 1] > 0.1351) & (section[:, 1] < 0.1849)]
    assert len(web) > 8
    turns = np.diff(np.unwrap(np.arctan2(*np.diff(section, axis=0).T[::-1])))
    assert np.abs(turns).max() <= 0.5 * np.pi + 1e-9
