"""Piecewise functions, track frames and frame accelerations, against differentiation of an inertial trajectory."""

from __future__ import annotations

import numpy as np
import pytest
from track_frame import frame_at, heading

from wheelrail.vehicle.track.alignment import Segment
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track

RISE = PiecewiseFunction((10.0, 60.0, 90.0, 120.0), (0.0, 1.0, 1.0, -0.5))
EASED = PiecewiseFunction((10.0, 60.0, 90.0, 120.0), (0.0, 1.0, 1.0, -0.5), shape="clothoid", corner=4.0)


@pytest.mark.parametrize("course", [RISE, EASED])
def test_piecewise_functions_and_their_derivatives(course: PiecewiseFunction) -> None:
    for s, v in zip(course.stations, course.values, strict=True):
        assert course(s)[0] == pytest.approx(v, abs=1e-14)
        assert abs(course(s)[1]) < 1e-14
        assert abs(course(s)[2]) < 1e-14
        assert abs(course(s - 1e-9)[2] - course(s + 1e-9)[2]) < 1e-8
    assert course(-5.0) == (0.0, 0.0, 0.0)
    assert course(1e3) == (-0.5, 0.0, 0.0)
    h = 1e-4
    for s in np.linspace(5.0, 125.0, 61) + 0.123:
        (a, da, _), (b, db, _), (_, d, dd) = course(s - h), course(s + h), course(s)
        assert d == pytest.approx((b - a) / (2 * h), abs=1e-9)
        assert dd == pytest.approx((db - da) / (2 * h), abs=1e-8)


def test_clothoid_is_a_straight_ramp_between_its_corners() -> None:
    slopes = {round(EASED(s)[1], 12) for s in np.linspace(14.1, 55.9, 7)}
    assert slopes == {round(1.0 / 46.0, 12)}
    assert EASED(35.0)[0] == pytest.approx(0.5, abs=1e-15)


def test_invalid_values_are_rejected() -> None:
    for wrong in (
        lambda: PiecewiseFunction((0.0, 0.0), (1.0, 2.0)),
        lambda: PiecewiseFunction((), ()),
        lambda: PiecewiseFunction((0.0, 4.0), (0.0, 1.0), shape="clothoid", corner=3.0),
        lambda: PiecewiseFunction((0.0, 4.0), (0.0, 1.0), shape="cubic"),  # type: ignore[arg-type]
        lambda: Track(superelevation=PiecewiseFunction.constant(1.6)),
        lambda: Track.curve(curvature=1e-3, transition=0.0, length=10.0),
        lambda: Track.curve(curvature=1e-3, transition=10.0, length=10.0, exit_transition=-1.0),
    ):
        with pytest.raises(ValueError):
            wrong()


def test_layout_and_signs() -> None:
    left = Track.curve(curvature=1 / 1200, cant=0.06, tangent=50, transition=100, length=200, exit_transition=80)
    right = Track.curve(curvature=-1 / 1200, cant=0.06, tangent=50, transition=100, length=200, exit_transition=80)
    for s, share in ((0.0, 0.0), (49.9, 0.0), (100.0, 0.5), (200.0, 1.0), (349.9, 1.0), (390.0, 0.5), (431.0, 0.0)):
        assert left.curvature(s)[0] == pytest.approx(share / 1200, abs=1e-15)
        assert left.superelevation(s)[0] == pytest.approx(share * 0.06, abs=1e-15)
        assert right.superelevation(s)[0] == pytest.approx(-share * 0.06, abs=1e-15)
    frame = frame_at(left, 250.0, 45.0)
    beta = np.arcsin(0.06 / 1.5)
    np.testing.assert_allclose(frame.rate, [0.0, -45 / 1200 * np.sin(beta), 45 / 1200 * np.cos(beta)], atol=1e-15)
    np.testing.assert_allclose(frame.down, [0.0, np.sin(beta), -np.cos(beta)], atol=1e-15)
    endless = Track.curve(curvature=1e-3, transition=100, length=1)
    assert endless.curvature(1e5)[0] == 1e-3


def test_heading_is_the_integral_of_curvature() -> None:
    for shape in ("quintic", "clothoid"):
        ramps = [Segment("transition", length, shape=shape) for length in (100, 60)]  # odd about their middle
        track = Track.of([Segment("tangent", 50), ramps[0], Segment("arc", 200, 1e-3), ramps[1]], corner=5.0)
        assert heading(track, 40.0) == 0.0
        assert heading(track, 150.0) == pytest.approx(0.05, rel=1e-13)
        assert heading(track, 1000.0) == pytest.approx(0.05 + 0.2 + 0.03, rel=1e-13)
        assert heading(track, 1000.0) - heading(track, 100.0) == pytest.approx(0.28 - _half_ramp(shape), rel=1e-12)
    assert heading(Track(curvature=PiecewiseFunction.constant(1e-3)), -20.0) == pytest.approx(-0.02)


def _half_ramp(shape: str) -> float:
    """Turn on the first half of a 100 m ramp to 1e-3 1/m."""
    if shape == "quintic":
        return 0.1 * (2.5 / 2**4 - 3 / 2**5 + 1 / 2**6)
    steep, c = 1 / 0.95, 0.05
    return 0.1 * steep * (c**2 * (1 / 4 - 1 / 10) + (0.45**2 / 2 + 0.025 * 0.45))


# An inertial trajectory in long double: orientation from heading, gradient and angle written out here, and its
# derivatives by central differences of 8th order.
LD = np.longdouble
FIRST = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3], dtype=LD) / LD(840)
OFFSETS = np.arange(-4, 5)
K1, LIFT, SLOPE, LENGTH, BASE = LD("2e-3"), LD("0.12"), LD("0.03"), LD(80), LD("1.5")
TRACK = Track(
    curvature=PiecewiseFunction((0.0, 80.0), (0.0, 2e-3)),
    superelevation=PiecewiseFunction((0.0, 80.0), (0.0, 0.12)),
    gradient=PiecewiseFunction((0.0, 80.0), (0.0, 0.03)),
)


def ramp(s: np.longdouble) -> np.longdouble:
    u = s / LENGTH
    return u**3 * (10 - 15 * u + 6 * u**2)


def orientation(s: np.longdouble) -> np.ndarray:
    nodes, weights = np.polynomial.legendre.leggauss(24)
    points = s * (LD(1) + nodes.astype(LD)) / 2
    psi = s / 2 * np.sum(weights.astype(LD) * K1 * ramp(points) * np.cos(SLOPE * ramp(points)))
    alpha, phi = SLOPE * ramp(s), -np.arcsin(LIFT * ramp(s) / BASE)
    c, s_, ca, sa, cp, sp = np.cos(psi), np.sin(psi), np.cos(alpha), np.sin(alpha), np.cos(phi), np.sin(phi)
    z, o = LD(0), LD(1)
    heading = np.array([[c, -s_, z], [s_, c, z], [z, z, o]])
    gradient = np.array([[ca, z, -sa], [z, o, z], [sa, z, ca]])
    roll = np.array([[o, z, z], [z, cp, -sp], [z, sp, cp]])
    return heading @ gradient @ roll


def difference(function, t: np.longdouble, h: np.longdouble):  # type: ignore[no-untyped-def]
    return sum(w * function(t + k * h) for w, k in zip(FIRST, OFFSETS, strict=True)) / h


H = LD("0.004")
V0, ACC = LD(40), LD("0.7")
TIMES = [LD("0.4"), LD("0.9"), LD("1.3")]


def distance(t: np.longdouble) -> np.longdouble:
    return V0 * t + ACC * t * t / 2


def spin(t: np.longdouble) -> np.ndarray:
    """Angular velocity of the frame in its own axes, from R^T dR/dt."""
    r = orientation(distance(t))
    w = r.T @ difference(lambda x: orientation(distance(x)), t, H)
    return np.array([w[2, 1], w[0, 2], w[1, 0]])


@pytest.mark.parametrize("t", TIMES)
def test_frame_rates_against_differences(t: np.longdouble) -> None:
    frame = frame_at(TRACK, float(distance(t)), float(V0 + ACC * t), float(ACC))
    np.testing.assert_allclose(frame.rate, spin(t).astype(float), atol=1e-13)
    np.testing.assert_allclose(frame.rate_dot, difference(spin, t, H).astype(float), atol=1e-12)
    np.testing.assert_allclose(frame.down, -orientation(distance(t))[2].astype(float), atol=1e-14)
