"""Checks of a profile file's points: signs, origin, units, order, undercut, duplicates, self-intersection."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wheelrail.meshes.profiles.formats import ProfileError, RawProfile
from wheelrail.meshes.profiles.measurement import estimated_noise
from wheelrail.meshes.profiles.profile import Kind
from wheelrail.support.arrays import Array

MIN_POINTS, MAX_POINTS = 10, 20_000
SIZES = {"width": (20e-3, 400e-3), "height": (1e-3, 400e-3)}  # m
CLOSE = 2e-5  # m; distances of points below that are dominated by rounding
BACK_TIP = 30e-3  # m; with a flange tip closer than this to y = 0, y is measured from the flange's back
TIP, TIP_TOLERANCE = -55e-3, 8e-3  # m; usual position of the flange tip from the rolling circle
UNDERCUT_DEPTH, UNDERCUT_WIDTH = 10e-3, 1e-3  # m; an undercut is deeper below the top of a rail, and wider
SCATTER = 8.0  # times the noise, distances that are scatter and no shape, up to MOST_SCATTER
MOST_SCATTER = 1e-3  # m


def oriented(raw: RawProfile, kind: Kind, flange_back: float, rolling_circle: float | None = None) -> RawProfile:
    """Points with signs from the shape where the format does not define them, and a wheel's y from its rolling circle.

    Parameters:
        raw: points of the file.
        kind: "wheel" or "rail".
        flange_back: m, as for `read_profile`.
        rolling_circle: y of the rolling circle in the file, m; None: 0, or the distance from the flange's back where
            the flange tip is near y = 0.

    Raises ProfileError where the signs contradict the shape.
    """
    if not MIN_POINTS <= len(raw.points) <= MAX_POINTS:
        line = int(raw.lines[-1]) if len(raw.lines) else None
        raise ProfileError(raw.path, line, f"{len(raw.points)} points", f"{MIN_POINTS} to {MAX_POINTS}")
    z_sign, y_sign = _signs(raw.points, kind)
    line = int(raw.lines[0])
    if raw.oriented:
        if z_sign < 0:
            raise ProfileError(raw.path, line, "z points the wrong way", _SENSE[kind])
        if y_sign < 0:
            raise ProfileError(raw.path, line, "the flange lies at positive y", _SENSE[kind])
        y_sign = z_sign = 1
    points = raw.points * (y_sign, z_sign)
    if kind == "rail":
        return replace(raw, points=points)
    shift, remarks = _to_rolling_circle(
        points, flange_back, None if rolling_circle is None else y_sign * rolling_circle
    )
    return replace(raw, points=points + np.array([shift, 0.0]), remarks=(*raw.remarks, *remarks))


def _to_rolling_circle(points: Array, flange_back: float, rolling_circle: float | None) -> tuple[float, list[str]]:
    """Shift m of y to the rolling circle, and remarks."""
    if rolling_circle is not None:
        return -rolling_circle, []
    y, z = points.T
    tip = float(y[np.argmax(z)])
    if abs(tip) < BACK_TIP:
        return flange_back, [
            f"flange tip at y = {1e3 * tip:.1f} mm: y is taken from the flange back, {-1e3 * flange_back:g} mm from "
            "the rolling circle (rolling_circle gives another y of it)"
        ]
    if abs(tip - TIP) > TIP_TOLERANCE:
        return 0.0, [
            f"flange tip at y = {1e3 * tip:.1f} mm, usually {1e3 * TIP:g} mm: y is taken from the rolling circle "
            "(rolling_circle gives another y of it)"
        ]
    return 0.0, []


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


def checked(raw: RawProfile, kind: Kind) -> RawProfile:
    """Points in order and at least CLOSE apart, those of a rail without the undercut below its head.

    Raises ProfileError for a wrong size, duplicates, wrong order or self-intersection.
    """
    _check_size(raw, kind)
    if raw.points[-1, 0] < raw.points[0, 0]:
        raw = replace(raw, points=raw.points[::-1], lines=raw.lines[::-1])
    step = np.diff(raw.points, axis=0)
    same = np.flatnonzero((step == 0.0).all(axis=1))
    if len(same):
        raise _at(raw, int(same[0]) + 1, f"repeats line {raw.lines[same[0]]}", "each point once")
    if kind == "rail":
        raw = _without_undercut(raw)
    scatter = min(max(CLOSE, SCATTER * estimated_noise(raw.points)), MOST_SCATTER)
    back = _steps_back(raw.points, scatter)
    if len(back):
        raise _at(raw, int(back[0]) + 1, f"steps back from line {raw.lines[back[0]]}", "y in order, but on steep faces")
    kept = _thinned(raw.points, CLOSE)
    raw = replace(raw, points=raw.points[kept], lines=raw.lines[kept])
    if len(kept) < MIN_POINTS:
        line = int(raw.lines[0])
        raise ProfileError(raw.path, line, f"{len(kept)} points more than {1e3 * CLOSE} mm apart", f"{MIN_POINTS}")
    apart = _thinned(raw.points, scatter)
    crossing = _crossing(raw.points[apart])
    if crossing is not None:
        i, j = (apart[k] for k in crossing)
        raise _at(raw, i, f"starts a line that crosses the one from line {raw.lines[j]}", "a simple curve")
    return raw


def _check_size(raw: RawProfile, kind: Kind) -> None:
    for (name, (low, high)), size in zip(SIZES.items(), np.ptp(raw.points, axis=0).tolist(), strict=True):
        if not low <= size <= high:
            guesses = {"metres": 1e3, "inches": 25.4, "millimetres": 1e-3}
            units = [unit for unit, factor in guesses.items() if low <= size * factor <= high]
            hint = f", the numbers look like {units[0]}" if units else ""
            allowed = f"{1e3 * low:g} .. {1e3 * high:g} mm"
            raise ProfileError(raw.path, int(raw.lines[0]), f"{name} {1e3 * size:.4g} mm of a {kind}{hint}", allowed)


def _at(raw: RawProfile, i: int, problem: str, allowed: str) -> ProfileError:
    """Error at a point."""
    y, z = 1e3 * raw.points[i]
    return ProfileError(raw.path, int(raw.lines[i]), f"point ({y:.6g}, {z:.6g}) mm {problem}", allowed)


def _steps_back(points: Array, scatter: float) -> NDArray[np.intp]:
    """Indices of points after which y decreases by more than the scatter m, but on steep faces."""
    step = np.diff(points, axis=0)
    shallow = (step[:, 0] < 0.0) & (np.abs(step[:, 1]) < 2.0 * np.abs(step[:, 0]))
    return np.flatnonzero(shallow & (np.hypot(*step.T) > scatter))


def _without_undercut(raw: RawProfile) -> RawProfile:
    """Points between the places, at the widest part of the head or below, where its faces turn back towards the web."""
    y, z = raw.points.T
    top, back = int(np.argmax(z)), _steps_back(raw.points, CLOSE)
    left, right = int(np.argmin(y[: top + 1])), top + int(np.argmax(y[top:]))
    start, stop = 0, len(y)
    if z[left] < z[top] - UNDERCUT_DEPTH and np.ptp(y[: left + 1]) > UNDERCUT_WIDTH:
        start = int(back[back < left].max(initial=-1)) + 1
    if z[right] < z[top] - UNDERCUT_DEPTH and np.ptp(y[right:]) > UNDERCUT_WIDTH:
        stop = int(back[back >= right].min(initial=len(y) - 1)) + 1
    remarks = [
        f"lines {lines.min()} to {lines.max()} lie in the undercut below the head and are left out"
        for lines in (raw.lines[:start], raw.lines[stop:])
        if len(lines)
    ]
    within = slice(start, stop)
    return replace(raw, points=raw.points[within], lines=raw.lines[within], remarks=(*raw.remarks, *remarks))


def _thinned(points: Array, close: float) -> list[int]:
    """Indices of points at least close m apart, both ends included."""
    kept = [0]
    for i in range(1, len(points)):
        if np.hypot(*(points[i] - points[kept[-1]])) >= close:
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
