"""Checks of a profile file's points: signs, units, order, duplicates, self-intersection."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wheelrail.meshes.profiles.formats import ProfileError, RawProfile
from wheelrail.meshes.profiles.profile import Kind
from wheelrail.support.arrays import Array

MIN_POINTS, MAX_POINTS = 10, 20_000
SIZES = {"width": (20e-3, 400e-3), "height": (1e-3, 400e-3)}  # m
CLOSE = 2e-5  # m; distances of points below that are dominated by rounding
MINIPROF_TIP = 30e-3  # m; with a flange tip closer than this to y = 0, y is measured from the flange's back


def oriented(raw: RawProfile, kind: Kind, flange_back: float) -> RawProfile:
    """Points with signs from the shape where the format does not define them.

    Raises ProfileError where the signs contradict the shape. flange_back m: as for `read_profile`.
    """
    if not MIN_POINTS <= len(raw.points) <= MAX_POINTS:
        raise ProfileError(raw.path, None, f"{len(raw.points)} points", f"{MIN_POINTS} to {MAX_POINTS}")
    z_sign, y_sign = _signs(raw.points, kind)
    line = int(raw.lines[0])
    if raw.oriented:
        if z_sign < 0:
            raise ProfileError(raw.path, line, "z points the wrong way", _SENSE[kind])
        if y_sign < 0:
            raise ProfileError(raw.path, line, "the flange lies at positive y", _SENSE[kind])
        return raw
    raw = raw.with_signs(y_sign, z_sign)
    if kind == "wheel":
        y, z = raw.points.T
        if abs(y[np.argmax(z)]) < MINIPROF_TIP:
            return replace(raw, points=raw.points + np.array([flange_back, 0.0]))
    return raw


_SENSE = {
    "wheel": "y to the field side (flange at negative y) and z away from the axle, after the file's own mirroring",
    "rail": "y to the field side and z up, after the file's own mirroring",
}


def _signs(points: Array, kind: Kind) -> tuple[int, int]:
    """Signs of z and y for which the top of a rail, or the flange of a wheel, is on the correct side."""
    y, z = points.T
    weight = np.abs(np.diff(y))
    middle = 0.5 * (z[1:] + z[:-1])
    level = np.sum(weight * middle) / max(weight.sum(), 1e-300)
    if kind == "rail":
        return (1 if z.max() - level <= level - z.min() else -1), 1
    tread = weight > np.abs(np.diff(z)) / 3.0  # not the faces of the rim
    heights = np.where(tread, middle - level, 0.0)
    tip = int(np.argmax(np.abs(heights)))
    return (1 if heights[tip] >= 0.0 else -1), (1 if y[tip] <= 0.5 * (y.min() + y.max()) else -1)


def checked(raw: RawProfile, kind: Kind) -> Array:
    """Points (n, 2) m in order and at least CLOSE apart.

    Raises ProfileError for a wrong size, duplicates, wrong order or self-intersection.
    """
    points, lines = raw.points, raw.lines
    for (name, (low, high)), size in zip(SIZES.items(), np.ptp(points, axis=0).tolist(), strict=True):
        if not low <= size <= high:
            guesses = {"metres": 1e3, "inches": 25.4, "millimetres": 1e-3}
            units = [unit for unit, factor in guesses.items() if low <= size * factor <= high]
            hint = f", the numbers look like {units[0]}" if units else ""
            allowed = f"{1e3 * low:g} .. {1e3 * high:g} mm"
            raise ProfileError(raw.path, int(lines[0]), f"{name} {1e3 * size:.4g} mm of a {kind}{hint}", allowed)
    if points[-1, 0] < points[0, 0]:
        points, lines = points[::-1], lines[::-1]

    def fail(i: int, problem: str, allowed: str) -> ProfileError:
        y, z = 1e3 * points[i]
        return ProfileError(raw.path, int(lines[i]), f"point ({y:.6g}, {z:.6g}) mm {problem}", allowed)

    step = np.diff(points, axis=0)
    same = np.flatnonzero((step == 0.0).all(axis=1))
    if len(same):
        raise fail(int(same[0]) + 1, f"repeats line {lines[same[0]]}", "each point once")
    distance = np.hypot(*step.T)
    back = np.flatnonzero((step[:, 0] < 0.0) & (np.abs(step[:, 1]) < 2.0 * np.abs(step[:, 0])) & (distance > CLOSE))
    if len(back):
        raise fail(int(back[0]) + 1, f"steps back from line {lines[back[0]]}", "y in order, but on steep faces")
    kept = _thinned(points)
    points, lines = points[kept], lines[kept]
    if len(points) < MIN_POINTS:
        raise ProfileError(raw.path, None, f"{len(points)} points more than {1e3 * CLOSE} mm apart", f"{MIN_POINTS}")
    crossing = _crossing(points)
    if crossing is not None:
        raise fail(crossing[0], f"starts a line that crosses the one from line {lines[crossing[1]]}", "a simple curve")
    return points


def _thinned(points: Array) -> list[int]:
    """Indices of points at least CLOSE apart, both ends included."""
    kept = [0]
    for i in range(1, len(points)):
        if np.hypot(*(points[i] - points[kept[-1]])) >= CLOSE:
            kept.append(i)
    if kept[-1] != len(points) - 1:
        kept[-1 if len(kept) > 1 else len(kept) :] = [len(points) - 1]
    return kept


def _crossing(points: Array) -> tuple[int, int] | None:
    """First pair of segments that cross; n (n - 1) / 2 tests, row by row."""
    p = points[:, 0] + 1j * points[:, 1]
    a, d = p[:-1], np.diff(p)
    for i in range(len(d) - 2):
        b, e = a[i + 2 :], d[i + 2 :]
        turn = (d[i].conjugate() * e).imag
        turn[np.abs(turn) < 1e-9 * np.abs(d[i]) * np.abs(e)] = np.inf  # parallel: no crossing
        u, v = ((b - a[i]).conj() * e).imag / turn, ((b - a[i]).conj() * d[i]).imag / turn
        crossing = np.flatnonzero((u > 0.0) & (u < 1.0) & (v > 0.0) & (v < 1.0))
        if len(crossing):
            return i, i + 2 + int(crossing[0])
    return None
