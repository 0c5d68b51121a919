"""Alignments of segments: continuity, values, errors, and the centre line in space."""

from __future__ import annotations

from itertools import pairwise
from math import atan

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import fresnel
from track_frame import frame_at, heading

from wheelrail.vehicle.track.alignment import AlignmentError, Segment, track_functions
from wheelrail.vehicle.track.piecewise import PiecewiseFunction, Shape
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track, centre_line

R = 1 / 800
S_CURVE = [
    Segment("tangent", 30.0),
    Segment("transition", 60.0, shape="bloss"),
    Segment("arc", 50.0, R, 0.08),
    Segment("transition", 80.0, shape="clothoid", gradient=0.01, vertical_radius=3000.0),
    Segment("arc", 60.0, -1 / 1000, 0.06),
    Segment("transition", 40.0),
    Segment("tangent", 20.0, gradient=-0.005, vertical_radius=2000.0),
]


@pytest.mark.parametrize("shape", ["quintic", "clothoid", "bloss"])
def test_piecewise_functions_integrate_exactly(shape: Shape) -> None:
    course = PiecewiseFunction((10.0, 60.0, 90.0, 120.0), (0.3, 1.0, 1.0, -0.5), shape=shape, corner=4.0)
    for s in (-5.0, 5.0, 11.0, 33.0, 58.0, 75.0, 100.0, 118.5, 150.0):
        parts = sorted({0.0, s, *(b for b in course.breaks if min(0.0, s) < b < max(0.0, s))}, reverse=s < 0.0)
        exact = sum(quad(lambda x: course(x)[0], a, b, epsabs=1e-13)[0] for a, b in pairwise(parts))
        assert course.integral(s) == pytest.approx(exact, abs=1e-12)


def test_bloss_transition() -> None:
    course = PiecewiseFunction((0.0, 80.0), (0.0, 2e-3), shape="bloss")
    u = np.linspace(0.01, 0.99, 9)
    np.testing.assert_allclose([course(80 * x)[0] for x in u], 2e-3 * (3 * u**2 - 2 * u**3), rtol=1e-14)
    np.testing.assert_allclose([course(80 * x)[1] for x in u], 2e-3 * (6 * u - 6 * u**2) / 80, rtol=1e-12)
    np.testing.assert_allclose([course(80 * x)[2] for x in u], 2e-3 * (6 - 12 * u) / 80**2, rtol=1e-12)
    assert course(1e-9)[2] == pytest.approx(6 * 2e-3 / 80**2, rel=1e-6)
    assert course(-1e-9)[2] == 0.0


def test_segments_give_curvature_superelevation_and_gradient() -> None:
    curvature, superelevation, gradient, _ = track_functions(S_CURVE)
    for s, k, h in (
        (-1.0, 0.0, 0.0),
        (30.0, 0.0, 0.0),
        (60.0, 0.5 * R, 0.04),
        (90.0, R, 0.08),
        (139.0, R, 0.08),
        (180.0, 0.5 * (R - 1e-3), 0.5 * (0.08 - 0.06)),
        (220.0, -1e-3, -0.06),
        (279.9, -1e-3, -0.06),
        (320.0, 0.0, 0.0),
        (1e4, 0.0, 0.0),
    ):
        assert curvature(s)[0] == pytest.approx(k, abs=1e-15)
        assert superelevation(s)[0] == pytest.approx(h, abs=1e-15)
    for s, a in ((0.0, 0.0), (124.9, 0.0), (140.0, 0.005), (155.1, 0.01), (300.0, 0.01), (335.1, -0.005)):
        assert gradient(s)[0] == pytest.approx(a, abs=1e-15)
    # a circle: the gradient changes by 1/radius, a little faster for its rounded ends
    assert gradient(140.0)[1] == pytest.approx(1 / 3000 / (1 - 3.0 / 30.0))
    assert gradient(320.0)[1] < 0.0


def test_the_short_form_is_the_same_segments() -> None:
    short = Track.curve(curvature=1 / 1200, cant=0.06, tangent=50, transition=100, length=200, exit_transition=80)
    long = Track.of(
        [
            Segment("tangent", 50),
            Segment("transition", 100),
            Segment("arc", 200, 1 / 1200, 0.06),
            Segment("transition", 80),
        ]
    )
    assert short == long
    assert short.curvature == PiecewiseFunction(
        (50, 150, 350, 430), (0.0, 1 / 1200, 1 / 1200, 0.0), shape=("quintic",) * 3
    )


def test_right_hand_track_is_the_mirror_image_bitwise() -> None:
    from dataclasses import replace

    other = [replace(s, curvature=None if s.curvature is None else -s.curvature) for s in S_CURVE]
    left, right = Track.of(S_CURVE), Track.of(other)
    for s in np.linspace(0.0, 340.0, 69):
        a, b = (frame_at(track, float(s), 40.0, 0.5) for track in (left, right))
        np.testing.assert_array_equal(b.rate, a.rate * [-1, 1, -1])
        np.testing.assert_array_equal(b.rate_dot, a.rate_dot * [-1, 1, -1])
        np.testing.assert_array_equal(b.down, a.down * [1, -1, 1])


T, A = Segment("tangent", 10.0), Segment("arc", 10.0, 1e-3, 0.05)


@pytest.mark.parametrize(
    ("segments", "index", "key", "says"),
    [
        ([], 0, "kind", "one segment"),
        ([T, Segment("bend", 3.0)], 1, "kind", "tangent, transition, arc"),  # type: ignore[arg-type]
        ([T, Segment("transition", 3.0, shape="cubic")], 1, "shape", "bloss"),  # type: ignore[arg-type]
        ([Segment("tangent", 0.0)], 0, "length", "greater than 0"),
        ([T, Segment("transition", 4.0, shape="clothoid"), A], 1, "length", "corners of 3 m"),
        ([T, A], 1, "curvature", "transition in between"),
        ([A, Segment("arc", 5.0, 1e-3, 0.06)], 1, "cant", "transition in between"),
        ([T, Segment("arc", 5.0)], 1, "curvature", "must be given"),
        ([Segment("tangent", 5.0, cant=0.1)], 0, "cant", "left out"),
        ([T, Segment("transition", 5.0), Segment("transition", 5.0), A], 1, "curvature", "another one"),
        ([T, Segment("transition", 5.0, 2e-3, 0.05), A], 1, "curvature", "next segment"),
        ([T, Segment("transition", 5.0, 1e-3, 0.02), A], 1, "cant", "next segment"),
        ([T, Segment("tangent", 5.0, gradient=0.01)], 1, "vertical_radius", "must be given"),
        ([T, Segment("tangent", 5.0, gradient=0.01, vertical_radius=3000.0)], 1, "vertical_radius", "from -5 to 25 m"),
        ([T, Segment("tangent", 5.0, gradient=0.01, vertical_radius=-1.0)], 1, "vertical_radius", "greater than 0"),
    ],
)
def test_invalid_segments(segments: list[Segment], index: int, key: str, says: str) -> None:
    with pytest.raises(AlignmentError, match=f"segment {index}") as caught:
        track_functions(segments)
    assert (caught.value.index, caught.value.key) == (index, key)
    assert says in caught.value.allowed


def test_compound_curves_and_ends_without_a_tangent() -> None:
    curvature, superelevation, *_ = track_functions(
        [Segment("transition", 20.0, 1e-3, 0.05), Segment("transition", 30.0), Segment("arc", 9.0, 2e-3, 0.1)]
    )
    assert (curvature.values, superelevation.values) == ((0.0, 1e-3, 2e-3), (0.0, 0.05, 0.1))
    assert track_functions([A, Segment("transition", 20.0)]).curvature.values == (1e-3, 0.0)
    assert track_functions([A]).superelevation(3.0) == (0.05, 0.0, 0.0)


def test_the_centre_line_of_a_circle_on_a_slope_is_a_helix() -> None:
    alpha = atan(0.03)
    stations, points = centre_line(Track.of([Segment("arc", 600.0, 1 / 500, gradient=alpha)]), 600.0)
    turn = stations * np.cos(alpha) / 500
    exact = np.stack([500 * np.sin(turn), 500 * (1 - np.cos(turn)), stations * np.sin(alpha)], axis=1)
    np.testing.assert_allclose(points, exact, atol=1e-9)


def test_the_centre_line_of_a_clothoid_is_fresnel_s() -> None:
    """But for the rounding of its ends, whose effect fades with their length."""
    length, k = 60.0, 1 / 300
    scale = np.sqrt(np.pi * length / k)
    errors, corners = [], np.array([0.8, 0.4, 0.2])
    for corner in corners.tolist():
        layout = [Segment("transition", length, shape="clothoid"), Segment("arc", 1.0, k)]
        stations, points = centre_line(Track.of(layout, corner=corner), length, spacing=0.5)
        y, x = fresnel(stations / scale)
        errors.append(np.abs(points[:, :2] - scale * np.stack([x, y], axis=1)).max())
    assert errors[-1] < 0.2 * length * length * k / 6 / 60
    assert np.polyfit(np.log(corners), np.log(errors), 1)[0] == pytest.approx(1.0, abs=0.05)


def frame_of(track: Track, s: float) -> np.ndarray:
    """Axes of the track frame, from heading, gradient and superelevation alone."""
    psi, alpha, phi = heading(track, s), track.gradient(s)[0], -np.arcsin(track.superelevation(s)[0] / track.base)
    c, s_, ca, sa, cp, sp = np.cos(psi), np.sin(psi), np.cos(alpha), np.sin(alpha), np.cos(phi), np.sin(phi)
    turn = np.array([[c, -s_, 0.0], [s_, c, 0.0], [0.0, 0.0, 1.0]])
    climb = np.array([[ca, 0.0, -sa], [0.0, 1.0, 0.0], [sa, 0.0, ca]])
    return np.asarray(turn @ climb @ [[1.0, 0.0, 0.0], [0.0, cp, -sp], [0.0, sp, cp]])


@pytest.mark.parametrize("at", [60.0, 138.0, 141.5, 156.0, 300.0, 318.0])
def test_frame_on_segments_at_changing_speed_against_differences(at: float) -> None:
    """Angular velocity and acceleration where curvature, cant and gradient vary, during braking."""
    track, profile = Track.of(S_CURVE), SpeedProfile.through((0.0, 12.0), (40.0, 15.0))
    t, h = profile.time_at(at), 2e-3
    weights = np.array([1, -8, 0, 8, -1]) / (12 * h)

    def spin(time: float) -> np.ndarray:
        parts = [frame_of(track, profile(time + k * h).distance) for k in (-2, -1, 0, 1, 2)]
        w = parts[2].T @ np.tensordot(weights, parts, axes=1)
        return np.array([w[2, 1], w[0, 2], w[1, 0]])

    frame = frame_at(track, *profile(t)[:3])
    assert frame.acceleration < -0.2
    np.testing.assert_allclose(frame.rate, spin(t), atol=1e-8)
    change = np.tensordot(weights, [spin(t + k * h) for k in (-2, -1, 0, 1, 2)], axes=1)
    np.testing.assert_allclose(frame.rate_dot, change, atol=3e-7)


def test_distance_is_the_integral_of_the_speed() -> None:
    profile = SpeedProfile.through((1.0, 4.0, 9.0), (30.0, 45.0, 20.0))
    for t in (0.5, 2.0, 3.9, 6.5, 12.0):
        exact = quad(lambda x: profile(x).speed, 0.0, t, points=[p for p in (1.0, 4.0, 9.0) if p < t], epsabs=1e-11)[0]
        assert profile(t).distance == pytest.approx(exact, abs=1e-9)
        assert profile.time_at(profile(t).distance) == pytest.approx(t, abs=1e-10)
        slope = (profile(t + 1e-5).speed - profile(t - 1e-5).speed) / 2e-5
        assert profile(t).acceleration == pytest.approx(slope, abs=1e-6)
    assert SpeedProfile.of(45.0)(0.3) == (45.0 * 0.3, 45.0, 0.0, 0.3)
    assert SpeedProfile.of(45.0).time_at(100.0) == 100.0 / 45.0
    for wrong in (0.0, -3.0, np.inf, np.nan):
        with pytest.raises(ValueError, match="speed"):
            SpeedProfile.of(wrong)
