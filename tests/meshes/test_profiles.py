"""Profiles: analytic sections, arc length, closest points, inclination, and reading files."""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from wheelrail.meshes.curves import arc_length
from wheelrail.meshes.curves.spline import through
from wheelrail.meshes.profiles.formats import ProfileError
from wheelrail.meshes.profiles.library import load_profile
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Placement, Profile, from_sections
from wheelrail.meshes.profiles.reader import read_profile

NAMES = ("S1002", "60E1", "UIC60-benchmark")
INCLINED = np.arctan(1 / 40)

# A few samples, mm, of the two profiles of the Manchester contact benchmark (distributed with CONTACT), z as in our
# frames. Those nearest to the steps in the standard's numbers are among them.
WHEEL_SAMPLES = [
    (-69.225256, 15.101756),
    (-64.189420, 23.818593),
    (-60.0, None),
    (59.302730, -2.5891917),
    (60, -2.6356764),
]
RAIL_SAMPLES = [
    (-43.704898, -38.510726),
    (-43.145147, -16.092722),
    (-43.008077, -13.810643),
    (-40.187826, -7.3390271),
    (-33.430349, -2.9996514),
    (-33.201506, -2.9401024),
    (-18.025426, -0.54238254),
    (-0.18441236, -0.000060323487),
    (3.0512871, -0.015464711),
    (18.559752, -1.6998989),
    (18.788262, -1.7500008),
    (28.724849, -12.357586),
    (30.595912, -36.653225),
]


def along(profile: Profile, n: int, margin: float = 1e-3) -> np.ndarray:
    low, high = profile.s_range
    return np.linspace(low + margin, high - margin, n)


@pytest.mark.parametrize("name", NAMES)
def test_s_is_arc_length_and_normals_leave_the_body(name: str) -> None:
    p = named_profile(name)
    s = along(p, 400)
    t, n = p.tangent(s), p.normal(s)
    np.testing.assert_allclose(np.hypot(*t.T), 1.0, atol=1e-10)
    np.testing.assert_allclose(n, np.stack([-t[:, 1], t[:, 0]], axis=1))
    h = 1e-6
    np.testing.assert_allclose((p.point(s + h) - p.point(s - h)) / (2 * h), t, atol=1e-5)
    assert p.normal(0.0)[1] > 0.99
    np.testing.assert_allclose(p.point(0.0), 0.0, atol=1e-10)


def test_sections_have_their_radii() -> None:
    rail, wheel = named_profile("60E1"), named_profile("S1002")
    np.testing.assert_allclose(
        rail.curvature(rail.s_at_y([0.0, 5e-3, 20e-3, 32e-3])), 1 / np.array([0.3, 0.3, 0.08, 0.013])
    )
    s = wheel.s_at_y([-66e-3, -58e-3, -45e-3, -39e-3, -37e-3, 45e-3])
    expected = [1 / 20.5e-3, 1 / 12e-3, 1 / 20e-3, 0.0, -1 / 13e-3, 0.0]
    np.testing.assert_allclose(wheel.curvature(s), expected, atol=1e-6)


def test_wheel_agrees_with_the_polynomials_of_the_standard() -> None:
    # section B in mm and dF/ds of EN 13715 at three places, evaluated apart; A is the line 1:15
    b = [0.0, -3.358537058e-2, 1.565681624e-3, -2.810427944e-5, 5.844240864e-8, -1.562379023e-8, 5.309217349e-15]
    b += [-5.957839843e-12, 2.646656573e-13]
    y = np.array([-20.0, 3.0, 30.0, 40.0])
    z = [sum(c * v**k for k, c in enumerate(b)) for v in y[:3]] + [1.364323640 - 0.066666667 * 40]
    wheel = named_profile("S1002")
    s = wheel.s_at_y(1e-3 * y)
    np.testing.assert_allclose(wheel.point(s) * 1e3, np.stack([y, z], axis=1), atol=1e-12)
    np.testing.assert_allclose(wheel.point(wheel.s_at_y(-55e-3)), [-55e-3, 28e-3], atol=1e-12)
    np.testing.assert_allclose(wheel.point(wheel.s_range)[:, 0], [-0.070, 0.065], atol=1e-12)


def test_heads_of_the_rails() -> None:
    # half widths and depths of EN 13674-1, and the joint of the benchmark's variant
    rail = named_profile("60E1")
    np.testing.assert_allclose(rail.point(rail.s_at_y(36e-3))[1], -14.300003e-3, atol=1e-9)
    np.testing.assert_allclose(rail.point(rail.s_at_y(26.026726e-3))[1], -2.302578e-3, atol=1e-9)
    np.testing.assert_allclose(
        rail.point(rail.s_range), [[-37.04876e-3, -35.27527e-3], [37.04876e-3, -35.27527e-3]], atol=1e-8
    )
    mirror = rail.point(-along(rail, 50)) * (-1.0, 1.0)
    np.testing.assert_allclose(rail.point(along(rail, 50)), mirror, atol=1e-13)


def test_samples_of_the_benchmark() -> None:
    rail, wheel = named_profile("UIC60-benchmark"), named_profile("S1002")
    assert np.abs(rail.closest(1e-3 * np.array(RAIL_SAMPLES)).distance).max() < 1e-8
    samples = 1e-3 * np.array([p for p in WHEEL_SAMPLES if p[1] is not None])
    assert np.abs(wheel.closest(samples).distance).max() < 1e-8


@pytest.mark.parametrize("name", NAMES)
def test_curve_has_no_gap(name: str) -> None:
    p = named_profile(name)
    inner = p.breaks[1:-1]
    before, after = p.local(inner, np.arange(len(inner))), p.local(inner, np.arange(1, len(inner) + 1))
    assert np.abs(after[0] - before[0]).max() < 1e-15
    kinks = np.abs(after[1] - before[1])
    kinks = kinks[kinks > 1e-5]
    assert len(kinks) == (1 if name == "S1002" else 0)  # the chamfer alone


def nearest(p: Profile, q: np.ndarray) -> tuple[float, float]:
    """Dense samples and corners, then a bounded scalar minimisation around each of the best few."""
    s = np.union1d(np.linspace(*p.s_range, 4001), p.breaks)
    away = np.hypot(*(p.point(s) - q).T)
    best = (float(away.min()), float(s[np.argmin(away)]))
    for i in np.argsort(away)[:12]:
        bounds = (s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)])
        found = minimize_scalar(
            lambda x: np.hypot(*(p.point(np.clip(x, *p.s_range)) - q)),
            bounds=bounds,
            method="bounded",
            options={"xatol": 1e-13},
        )
        best = min(best, (float(found.fun), float(found.x)))
    return best


@pytest.mark.parametrize("name", NAMES)
def test_closest_point_against_dense_search(name: str) -> None:
    p = named_profile(name)
    rng = np.random.default_rng(3)
    q = np.stack([rng.uniform(-0.09, 0.09, 60), rng.uniform(-0.06, 0.05, 60)], axis=1)
    q[:20] = p.point(s := along(p, 20)) + rng.normal(0.0, 2e-4, 20)[:, None] * p.normal(s)
    found = p.closest(q)
    slow = np.array([nearest(p, x)[0] for x in q])
    np.testing.assert_allclose(np.abs(found.distance), slow, atol=2e-12)
    away = np.hypot(*(q - p.point(found.s)).T)
    np.testing.assert_allclose(away, np.abs(found.distance), atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_closest_recovers_arc_length_and_signed_distance(name: str) -> None:
    p = named_profile(name)
    rng = np.random.default_rng(4)
    s = rng.uniform(p.s_range[0] + 1e-3, p.s_range[1] - 1e-3, 3000)
    s = s[np.abs(p.point(s)[:, 0] - 60e-3) > 2e-3]  # outside the normal cone of the chamfer's corner
    d = rng.uniform(-1e-3, 1e-3, len(s))
    q = p.point(s) + d[:, None] * p.normal(s)
    found = p.closest(q)
    np.testing.assert_allclose(found.s, s, atol=2e-8)  # two feet next to the joints whose kinks are 4e-6 rad
    assert np.median(np.abs(found.s - s)) < 1e-14
    np.testing.assert_allclose(found.distance, d, atol=1e-12)
    assert found.inside.all()
    guessed = p.closest(q, guess=s + 5e-4)
    np.testing.assert_allclose(guessed.distance, d, atol=1e-12)


def test_closest_at_corner_and_ends() -> None:
    p = named_profile("S1002")
    corner = p.point(p.s_at_y(60e-3))
    outside = corner + 1e-3 * np.array([np.sin(0.4), np.cos(0.4)])  # between the normals of tread and chamfer
    found = p.closest(outside[None])
    np.testing.assert_allclose(p.point(found.s[0]), corner, atol=1e-12)
    np.testing.assert_allclose(found.distance, 1e-3, rtol=1e-9)
    assert found.inside.all()
    beyond = np.array([[0.070, 0.0], [0.066, -0.012], [-0.065, 0.001]])
    found = p.closest(beyond)
    assert list(found.inside) == [True, False, False]
    np.testing.assert_allclose(found.s[1:], [p.s_range[1], p.s_range[0]])
    np.testing.assert_allclose(np.abs(found.distance[1:]), np.hypot(*(beyond[1:] - p.point(found.s[1:])).T))
    assert p.closest(np.zeros((0, 2))).s.shape == (0,)


def test_inclined_rail_has_its_origin_at_the_highest_point() -> None:
    rail = named_profile("60E1")
    laid = rail.inclined(INCLINED)
    np.testing.assert_allclose(laid.point(0.0), 0.0, atol=1e-15)
    np.testing.assert_allclose(laid.tangent(0.0), [1.0, 0.0], atol=1e-12)
    assert laid.point(laid.samples(1e-4))[:, 1].max() <= 1e-15
    # top towards the track's centre: the crown lies on the gauge side of the origin, 300 mm sin(angle) away
    np.testing.assert_allclose(
        laid.placement([0.0, 0.0]), [-0.3 * np.sin(INCLINED), 0.3 * (np.cos(INCLINED) - 1)], atol=1e-12
    )
    s = along(rail, 30)
    found = laid.closest(laid.placement(rail.point(s)))
    np.testing.assert_allclose(found.distance, 0.0, atol=1e-14)
    again = laid.inclined(-INCLINED)
    np.testing.assert_allclose(again.point(s), rail.point(s), atol=1e-13)
    np.testing.assert_allclose([again.placement.angle, *again.placement.shift], 0.0, atol=1e-13)
    assert rail.inclined(0.0) is rail
    with pytest.raises(ValueError, match="wheel"):
        named_profile("S1002").inclined(0.025)


def test_gauge_is_measured_below_the_top() -> None:
    # 1435 mm, 14 mm below the top; the benchmark's file has its origin 5.96 um beside the highest point
    assert named_profile("60E1").inclined(INCLINED).gauge_offset(1.435, 0.014) == pytest.approx(0.760532, abs=1e-6)
    rail = named_profile("UIC60-benchmark")
    from_top = rail.gauge_offset(1.435, 0.014) + rail.point(rail.highest())[0]
    assert from_top == pytest.approx(0.760538, abs=1e-6)
    with pytest.raises(ValueError, match="gauge side"):
        rail.gauge_offset(1.435, 0.1)


def test_s_at_y_inverts_y_and_rejects_other_values() -> None:
    p = named_profile("S1002")
    y = np.linspace(-0.0699, 0.0649, 200)
    np.testing.assert_allclose(p.point(p.s_at_y(y))[:, 0], y, atol=1e-15)
    with pytest.raises(ValueError, match="y must lie"):
        p.s_at_y(0.07)
    with pytest.raises(ValueError, match="arc length"):
        p.point(1.0)


def test_digest_depends_on_shape_and_placement() -> None:
    rail = named_profile("60E1")
    same = from_sections_again()
    assert same.digest() == rail.digest()
    digests = {
        rail.digest(),
        rail.inclined(0.02).digest(),
        named_profile("S1002").digest(),
        named_profile("UIC60-benchmark").digest(),
    }
    moved = Profile(rail.breaks, rail.coefficients, rail.name, "rail", Placement(0.0, (1e-3, 0.0)))
    assert len(digests | {moved.digest()}) == 5
    with pytest.raises(FrozenInstanceError):
        rail.name = "other"  # type: ignore[misc]
    with pytest.raises(ValueError):
        rail.breaks[0] = 0.0


def from_sections_again() -> Profile:
    from wheelrail.meshes.profiles.standard_profiles import EN_60E1

    return from_sections(EN_60E1.sections(), name="again", kind="rail")


def test_spline_through_samples_converges_at_fourth_order() -> None:
    p = named_profile("60E1")
    arc = p.samples(1.0, p.s_at_y(12e-3), p.s_at_y(24e-3))  # within the arc of 80 mm
    errors, spacings = [], [2e-3, 1e-3, 0.5e-3]
    for spacing in spacings:
        points = p.point(np.arange(arc[0], arc[-1], spacing))
        fitted = arc_length.curve(through(points))
        errors.append(np.abs(p.closest(fitted.point(fitted.samples(1e-4))).distance).max())
    slope = np.polyfit(np.log(spacings), np.log(errors), 1)[0]
    assert slope > 3.5


def simpack_file(path: Path, points: np.ndarray, kind: int, **keys: float) -> Path:
    extra = "\n".join(f"{key.replace('_', '.')} = {value!r} ! note" for key, value in keys.items())
    rows = "\n".join(f"{y:.12e}\t{z:.12e}" for y, z in points)
    path.write_text(
        f"! SIMPACK\nheader.begin\n version = 1\n type = {kind}\nheader.end\nspline.begin\n units.len.f = 1000.0\n"
        f"{extra}\npoint.begin\n{rows}\npoint.end\nspline.end\n"
    )
    return path


def sampled(name: str, spacing: float = 4e-4) -> tuple[Profile, np.ndarray]:
    p = named_profile(name)
    p = p.inclined(INCLINED) if name == "60E1" else p
    stop = p.s_at_y(59.9e-3) if name == "S1002" else p.s_range[1]
    start = p.s_at_y(-69.5e-3) if name == "S1002" else p.s_range[0]
    return p, p.point(np.arange(start, stop, spacing)) * 1e3


def deviation(found: Profile, p: Profile) -> float:
    low, high = found.s_range
    return float(np.abs(p.closest(found.point(np.linspace(low, high, 2000))).distance).max())


def files(folder: Path) -> dict[str, tuple[Path, str]]:
    """The same two bodies in every format."""
    _, wheel = sampled("S1002")
    _, rail = sampled("60E1")
    head = "ProgramName=MiniProf\nXOffset=0.0000\nColumnDef=A,X,Y\n\n"

    def columns(points: np.ndarray) -> str:
        return "\n".join(f"0.0 {y:.9f} {z:.9f}" for y, z in points)

    made = {
        "r.prr": simpack_file(folder / "r.prr", rail * (1, -1), 0),
        "w.prw": simpack_file(folder / "w.prw", wheel[::-1] * (-1, 1), 1, mirror_y=1, inversion=1, shift_y=0.0),
        "r.ban": folder / "r.ban",
        "w.whl": folder / "w.whl",
        "r.csv": folder / "r.csv",
        "w.dat": folder / "w.dat",
    }
    made["r.ban"].write_text(head + columns(rail * (-1, -1)))
    made["w.whl"].write_text(head + columns(wheel + np.array([70.0, 0.2])))
    made["r.csv"].write_text("# units: m\ny;z\n" + "\n".join(f"{y / 1e3:.12f};{z / 1e3:.12f}" for y, z in rail[::-1]))
    made["w.dat"].write_text("# made for a test\n" + "\n".join(f"{y:.9f} {z:.9f} # note" for y, z in wheel))
    return {name: (path, "rail" if name[0] == "r" else "wheel") for name, path in made.items()}


def test_every_format_gives_the_same_profile(tmp_path: Path) -> None:
    for name, (path, kind) in files(tmp_path).items():
        p, _ = sampled("60E1" if kind == "rail" else "S1002")
        found = load_profile(path, kind, inclination=INCLINED if kind == "rail" else 0.0)  # type: ignore[arg-type]
        assert deviation(found, p) < 3e-6, name
        s = np.array([-0.03, -0.01, 0.0, 0.01, 0.02])
        np.testing.assert_allclose(found.point(s), p.point(s), atol=4e-7, err_msg=name)
        if kind == "rail":
            np.testing.assert_allclose(found.placement.shift, p.placement.shift, atol=2e-6, err_msg=name)


def test_noise_is_smoothed(tmp_path: Path) -> None:
    p, points = sampled("60E1")
    rng = np.random.default_rng(5)
    path = tmp_path / "noisy.txt"
    path.write_text("\n".join(f"{y:.6f} {z:.6f}" for y, z in points + rng.normal(0.0, 5e-3, points.shape)))
    s = np.linspace(-0.02, 0.01, 200)
    with pytest.warns(UserWarning, match=r"noise of about 5(\.\d)? µm"):
        rough, smooth = (load_profile(path, "rail", noise=noise).curvature(s) for noise in (0.0, 7e-6))
    exact = p.curvature(s)
    assert np.abs(smooth - exact).mean() < 0.1 * np.abs(rough - exact).mean()


def spoiled(folder: Path, name: str) -> tuple[Path, str]:
    _, wheel = sampled("S1002")
    lines = [f"{y:.6f} {z:.6f}" for y, z in wheel]
    kind = "wheel"
    if name == "word":
        lines[6] = "12.0 twelve"
    elif name == "few":
        lines = lines[:4]
    elif name == "crossing":
        lines[2:2] = ["-69.4 30.0", "-69.45 12.0"]
    elif name == "heights":
        lines = [f"{y:.6f} {z / 1e3:.9f}" for y, z in wheel]
    elif name == "units":
        lines.insert(0, "# units: furlong")
    path = folder / f"{name}.txt"
    path.write_text("\n".join(lines))
    return path, kind


@pytest.mark.parametrize(
    ("name", "line", "words"),
    [
        ("word", 7, "12.0 twelve"),
        ("few", 4, "4 points"),
        ("crossing", 1, "from line 3"),
        ("heights", 1, "look like metres"),
        ("units", 1, "furlong"),
    ],
)
def test_bad_files_are_named_with_line_and_what_is_allowed(
    tmp_path: Path, name: str, line: int | None, words: str
) -> None:
    path, kind = spoiled(tmp_path, name)
    with pytest.raises(ProfileError, match=words) as raised:
        read_profile(path, kind)  # type: ignore[arg-type]
    assert raised.value.line == line
    assert str(path) in str(raised.value)
    assert "allowed" in str(raised.value)


def test_bad_simpack_files(tmp_path: Path) -> None:
    _, rail = sampled("60E1")
    turned = simpack_file(tmp_path / "turned.prr", rail * (1, -1), 0, rotate=0.025)
    with pytest.raises(ProfileError, match=r"rotate is 0\.025"):
        read_profile(turned, "rail")
    with pytest.raises(ProfileError, match="type is 1"):
        read_profile(simpack_file(tmp_path / "type.prr", rail, 1), "rail")
    with pytest.raises(ProfileError, match="holds a rail"):
        read_profile(turned, "wheel")
    unclosed = tmp_path / "open.prr"
    unclosed.write_text("header.begin\ntype = 0\n")
    with pytest.raises(ProfileError, match="not closed"):
        read_profile(unclosed, "rail")
    smoothed = simpack_file(tmp_path / "smooth.prr", rail * (1, -1), 0, approx_smooth=1e-3)
    with pytest.warns(UserWarning, match=r"approx\.smooth"):
        read_profile(smoothed, "rail")


def test_names_of_profiles(tmp_path: Path) -> None:
    assert load_profile("S1002", "wheel") is named_profile("S1002")
    with pytest.raises(ValueError, match="60E1, UIC60-benchmark"):
        load_profile("S1002", "rail")
    with pytest.raises(ValueError, match="S1002, 60E1, UIC60-benchmark"):
        load_profile("S1003", "wheel")
    with pytest.raises(ValueError, match="S1002, 60E1, UIC60-benchmark"):
        named_profile("UIC54")
    (tmp_path / "a.xyz").write_text("")
    with pytest.raises(ProfileError, match="0 points"):
        load_profile(tmp_path / "a.xyz", "rail")


def test_unchanged_file_is_read_once(tmp_path: Path) -> None:
    first = named_profile("S1002")
    y = np.linspace(-0.069, 0.06, 200)
    points = 1e3 * first.point(first.s_at_y(y))
    file = tmp_path / "worn.csv"
    np.savetxt(file, points, delimiter=",")
    read = load_profile(file, "wheel")
    assert load_profile(file, "wheel") is read
    assert load_profile(file, "wheel", noise=1e-5) is not read
    points[:, 1] -= 0.1
    np.savetxt(file, points, delimiter=",")
    assert load_profile(file, "wheel") is not read
