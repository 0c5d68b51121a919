"""Checks of a profile's points: size, order, undercut, duplicates, points out of line, self-intersection."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wheelrail.meshes.curves.curve import crossing
from wheelrail.meshes.profiles.formats import MAX_POINTS, MIN_POINTS, ProfileError, RawProfile
from wheelrail.meshes.profiles.measurement import estimated_noise
from wheelrail.meshes.profiles.profile import Kind
from wheelrail.support.arrays import Array

SIZES = {"width": (10e-3, 400e-3), "height": (0.0, 400e-3)}  # m
LOWEST = 1e-4  # m; a profile of less height is in other units across than up, if it is not flat
CLOSE = 2e-5  # m; distances of points below that are dominated by rounding
UNDERCUT_DEPTH, UNDERCUT_WIDTH = 10e-3, 1e-3  # m; an undercut is deeper below the top of a rail, and wider
HEAD_DEPTH = 60e-3  # m; points of a rail with its foot below that are no part of the head
SCATTER = 8.0  # times the noise, distances that are scatter and no shape, up to MOST_SCATTER
MOST_SCATTER = 1e-3  # m
FAR = 8.0  # times the range of the middle half of the points, distances of values that are no part of a profile
ALONE = 20.0, 5e-3  # times the usual spacing, and m: distance of a first or last point that is no part of the profile
SHARP = np.radians(30.0)  # turn of the line at a point out of line
MOST_MENDED = 3, 0.01  # points, and part of the points, that may be out of line


def cleaned(raw: RawProfile) -> RawProfile:
    """Points without missing values, repetitions, and numbers of preceding or following text.

    Raises ProfileError for too few or too many points, and for values that are no coordinates.
    """
    missing = np.isnan(raw.points).any(axis=1)
    if missing.any():
        raw = raw.chosen(~missing, f"{missing.sum()} missing values from line {raw.lines[missing][0]} are left out")
    if not MIN_POINTS <= len(raw.points) <= MAX_POINTS:
        line = int(raw.lines[-1]) if len(raw.lines) else None
        raise ProfileError(raw.path, line, f"{len(raw.points)} points", f"{MIN_POINTS} to {MAX_POINTS}")
    same = np.concatenate([[False], (np.diff(raw.points, axis=0) == 0.0).all(axis=1)])
    if same.any():
        raw = raw.chosen(~same, f"{same.sum()} repeated points from line {raw.lines[same][0]} are left out")
    if len(raw.points) < MIN_POINTS:
        raise ProfileError(raw.path, int(raw.lines[0]), f"{len(raw.points)} different points", f"{MIN_POINTS}")
    for end in (0, 0, 0, -1, -1, -1):
        step = np.hypot(*np.diff(raw.points, axis=0).T)
        if step[end] > max(ALONE[0] * np.median(step), ALONE[1]):
            inner = np.arange(len(raw.points)) != (len(raw.points) - 1 if end else 0)
            y, z = 1e3 * raw.points[end]
            remark = f"line {raw.lines[end]}, ({y:.4g}, {z:.4g}) mm, lies {1e3 * step[end]:.3g} mm away and is left out"
            raw = raw.chosen(inner, remark)
    low, high = np.quantile(raw.points, (0.25, 0.75), axis=0)
    distance = np.abs(raw.points - 0.5 * (low + high))
    far = distance > FAR * (high - low).max()
    if far.any():
        i, axis = (int(k) for k in np.argwhere(far)[0])
        problem = f"{'yz'[axis]} = {1e3 * raw.points[i, axis]:.6g} mm is no coordinate of this profile"
        count = int(far.any(axis=1).sum())
        others = f", as on {count} lines in all" if count > 1 else ""
        raise ProfileError(raw.path, int(raw.lines[i]), problem + others, "points only, or nan for missing values")
    return raw


def checked(raw: RawProfile, kind: Kind) -> RawProfile:
    """Points in order, at least CLOSE apart, without outliers and without reversals beyond the ends.

    Raises ProfileError for a wrong size, wrong order or self-intersection.
    """
    if kind == "rail":
        raw = _head_alone(raw)
    _check_size(raw, kind)
    if not raw.ascending:
        raw = raw.chosen(slice(None, None, -1))
    raw = _in_line(raw)
    raw = _without_turns(raw, kind)
    scatter = _scatter(raw.points)
    back = _steps_back(raw.points, scatter)
    if len(back):
        raise _at(raw, int(back[0]) + 1, f"steps back from line {raw.lines[back[0]]}", "y in order, but on steep faces")
    kept = np.array(_thinned(raw.points, CLOSE))
    raw = raw.chosen(kept)
    if len(kept) < MIN_POINTS:
        line = int(raw.lines[0])
        raise ProfileError(raw.path, line, f"{len(kept)} points more than {1e3 * CLOSE} mm apart", f"{MIN_POINTS}")
    apart = _thinned(raw.points, scatter)
    crossed = crossing(raw.points[apart])
    if crossed is not None:
        i, j = (apart[k] for k in crossed)
        raise _at(raw, i, f"starts a line that crosses the one from line {raw.lines[j]}", "a simple curve")
    return raw


def _scatter(points: Array) -> float:
    return min(max(CLOSE, SCATTER * estimated_noise(points)), MOST_SCATTER)


def _head_alone(raw: RawProfile) -> RawProfile:
    """Points of the head around the top of a rail that is given with web and foot."""
    points, lines = raw.points, raw.lines
    if np.ptp(points[:, 1]) <= HEAD_DEPTH:
        return raw
    if np.hypot(*(points[0] - points[-1])) < ALONE[1]:  # a closed section, which may start on the head
        first = -int(np.argmin(points[:, 1]))
        order = np.roll(np.arange(len(points)), first)
        raw = raw.chosen(order)
        points, lines = raw.points, raw.lines
    deep = points[:, 1] < points[:, 1].max() - HEAD_DEPTH
    top = int(np.argmax(points[:, 1]))
    start = int(np.flatnonzero(deep[:top]).max(initial=-1)) + 1
    stop = top + int(np.flatnonzero(deep[top:]).min(initial=len(points) - top))
    remark = f"{len(lines) - stop + start} points deeper than {1e3 * HEAD_DEPTH:g} mm below the top are left out"
    return raw.chosen(slice(start, stop), remark)


def _in_line(raw: RawProfile) -> RawProfile:
    """Points without single ones out of line: the line turns there and back, and without them it is smooth.

    Others than a few are no errors of single points, and stay.
    """
    found, lost = raw, list[tuple[int, Array, float]]()
    scatter = _scatter(raw.points)
    while len(lost) <= max(MOST_MENDED[0], MOST_MENDED[1] * len(raw.points)):
        z = found.points[:, 0] + 1j * found.points[:, 1]
        a, b, c, d, e = (z[i : len(z) - 4 + i] for i in range(5))
        turn = np.abs(np.angle((d - c) / (c - b)))
        without = np.abs(np.angle((d - b) / (b - a))) + np.abs(np.angle((e - d) / (d - b)))
        along = np.clip(((c - b) * (d - b).conj()).real / np.abs(d - b) ** 2, 0.0, 1.0)
        distance = np.abs(c - b - along * (d - b))
        out = (distance > scatter) & (turn > SHARP + 3.0 * without)
        if not out.any():
            break
        i = int(np.argmax(np.where(out, distance, 0.0))) + 2
        lost.append((int(found.lines[i]), found.points[i], float(distance[i - 2])))
        found = found.chosen(np.arange(len(z)) != i)
    else:
        return raw
    remarks = [
        f"line {line}, ({1e3 * y:.3f}, {1e3 * z:.3f}) mm, is {1e3 * distance:.2g} mm out of line and left out"
        for line, (y, z), distance in sorted(lost, key=lambda point: point[0])
    ]
    return found.chosen(slice(None), *remarks)


def _without_turns(raw: RawProfile, kind: Kind) -> RawProfile:
    """Points between the reversals of the faces of a rail's head or a wheel's rim."""
    y, z = raw.points.T
    top, back = int(np.argmax(z)), _steps_back(raw.points, CLOSE)
    step = np.hypot(*np.diff(raw.points, axis=0).T)
    back = back[step[back] < max(ALONE[0] * np.median(step), ALONE[1])]  # farther steps are other points in disorder
    left, right = int(np.argmin(y[: top + 1])), top + int(np.argmax(y[top:]))
    depth = UNDERCUT_DEPTH if kind == "rail" else -np.inf
    start, stop = 0, len(y)
    if z[left] < z[top] - depth and np.ptp(y[: left + 1]) > UNDERCUT_WIDTH:
        start = int(back[back < left].max(initial=-1)) + 1
    if z[right] < z[top] - depth and np.ptp(y[right:]) > UNDERCUT_WIDTH:
        stop = int(back[back >= right].min(initial=len(y) - 1)) + 1
    where = "in the undercut below the head" if kind == "rail" else "behind the faces of the rim"
    remarks = [
        f"lines {lines.min()} to {lines.max()} lie {where} and are left out"
        for lines in (raw.lines[:start], raw.lines[stop:])
        if len(lines)
    ]
    return raw.chosen(slice(start, stop), *remarks)


def _check_size(raw: RawProfile, kind: Kind) -> None:
    for (name, (low, high)), size in zip(SIZES.items(), np.ptp(raw.points, axis=0).tolist(), strict=True):
        if not low <= size <= high or (name == "height" and not raw.defined[1] and 0.0 < size < LOWEST):
            guesses = {"metres": 1e3, "inches": 25.4, "millimetres": 1e-3}
            units = [unit for unit, factor in guesses.items() if max(low, LOWEST) <= size * factor <= high]
            hint = f", the numbers look like {units[0]}" if units else ""
            allowed = f"{1e3 * low:g} .. {1e3 * high:g} mm, in a unit given as '# units: m' before the points"
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


def _thinned(points: Array, close: float) -> list[int]:
    """Indices of points at least close m apart, both ends included."""
    kept = [0]
    for i in range(1, len(points)):
        if np.hypot(*(points[i] - points[kept[-1]])) >= close:
            kept.append(i)
    if kept[-1] != len(points) - 1:
        kept[-1 if len(kept) > 1 else len(kept) :] = [len(points) - 1]
    return kept
