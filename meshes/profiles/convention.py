"""Signs and origin of a profile's points: as given, as the format defines them, or as the shape shows them."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wheelrail.meshes.profiles.formats import RawProfile
from wheelrail.meshes.profiles.measures import FLANGE
from wheelrail.meshes.profiles.profile import Kind
from wheelrail.support.arrays import Array

BACK_TIP = 30e-3  # m; with a flange tip closer than this to y = 0, y is measured from the flange's back
TIP, TIP_TOLERANCE, TIP_NEAR = -55e-3, 8e-3, 16e-3  # m; usual position of the flange tip from the rolling circle
NEAR_TIP = 3e-3  # m, distance from the highest point of points that determine the flange tip
FLAT = 2e-3  # m, height of a rail head below which its shape does not show which way is up
WHOLE_RAIL = 80e-3  # m; a higher rail has its foot
FLANK = (-34e-3, -14e-3)  # m, depths of the flanks of a rail head
LEAN = 0.01  # rad, half of the smallest usual inclination


def oriented(
    raw: RawProfile, kind: Kind, mirror: bool | None = None, flip: bool | None = None, *, changes: Sequence[str] = ()
) -> RawProfile:
    """Points with y to the field side and z up or away from the axle.

    Parameters:
        raw: points as the format defines them.
        kind: "wheel" or "rail".
        mirror, flip: whether the sign of y, z changes; None: where the format does not define it and the shape shows
            it, by a wheel's flange or a rail's convex head.
        changes: what was done to the points before, in words.

    A shape that contradicts the given signs is a warning.
    """
    forwards = raw.points if raw.ascending else raw.points[::-1]
    z_shape, y_shape = (_flange if kind == "wheel" else _head)(forwards)
    signs, words = [1.0, 1.0], []
    for axis, (option, given, shape) in enumerate((("mirror", mirror, y_shape), ("flip", flip, z_shape))):
        name = "yz"[axis]
        if given is not None:
            signs[axis] = -1.0 if given else 1.0
            words.append(f"{name} {'turned' if given else 'kept'} as asked for")
        elif not raw.defined[axis] and shape:
            signs[axis] = float(shape)
            words.append(f"{name} {'turned' if shape < 0 else 'as in the file'} by the shape")
        elif not raw.defined[axis]:
            words.append(f"{name} as in the file")
        wrong, turned = shape * signs[axis] < 0, signs[axis] < 0 and given is None
        if wrong or (turned and axis == 0):
            hint = f"{option} = {str(not turned).lower()} {'keeps' if turned else 'changes'} it"
            _warn(raw, f"{_CONTRADICTION[kind, axis]}{', and is turned' if turned else ''}; {hint}")
    points = raw.points * signs
    lean = _lean(forwards * signs if signs[0] > 0.0 else forwards[::-1] * signs) if kind == "rail" else 0.0
    if abs(lean) > LEAN:
        words.append(f"head leans {abs(lean):.3f} to the {'gauge' if lean > 0 else 'field'} side")
    if lean < -LEAN and mirror is None:
        _warn(
            raw,
            f"the head leans by {-lean:.3f} to the field side, or is worn there: is the rail mirrored? "
            "mirror = true mirrors it, mirror = false keeps it",
        )
    outwards = raw.ascending == (signs[0] > 0.0)
    steps = (f"{'gauge' if outwards else 'field'} side first",)
    return replace(raw, points=points, convention=(*raw.convention, *changes, *words, *steps))


_CONTRADICTION = {
    ("wheel", 0): "the flange lies on the side of positive y",
    ("wheel", 1): "the flange points to the axle",
    ("rail", 0): "the head is mirrored",
    ("rail", 1): "the top of the rail points down",
}


def _warn(raw: RawProfile, message: str) -> None:
    warnings.warn(f"{raw.path}: {message}", stacklevel=5)


def _flange(points: Array) -> tuple[int, int]:
    """Signs of z and y for which the flange of a wheel stands out at negative y; (0, 0) where there is none.

    A flange rises by FLANGE or more over the tread at one end of y only, and falls to it within its own height.
    """
    weight = np.abs(np.diff(points[:, 0]))
    tread = weight > np.abs(np.diff(points[:, 1])) / 3.0  # not the faces of the rim
    y, z = (0.5 * (points[1:] + points[:-1]))[tread].T
    weight = weight[tread]
    if len(y) < 3:
        return 0, 0
    order = np.argsort(z)
    level = z[order][np.searchsorted(np.cumsum(weight[order]), 0.5 * weight.sum())]
    found = (0.0, 0, 0)
    for sign in (1, -1):
        height = sign * (z - level)
        tip = int(np.argmax(height))
        left = y[tip] < 0.5 * (y.min() + y.max())
        towards = y > y[tip] if left else y < y[tip]
        far = np.abs(y - y[tip]) > 0.5 * np.ptp(y)
        if height[tip] < FLANGE or (far.any() and height[far].max() > 0.4 * height[tip]) or not towards.any():
            continue
        high, low = (towards & (height > part * height[tip]) for part in (0.8, 0.2))
        reach = [np.abs(y[part] - y[tip]).max(initial=0.0) for part in (high, low)]
        if reach[1] - reach[0] < height[tip] and height[tip] > found[0]:
            found = (float(height[tip]), sign, 1 if left else -1)
    return found[1], found[2]


def _head(points: Array) -> tuple[int, int]:
    """Sign of z with the rail's top up, 0 where the shape leaves the sign open; and 0, as y is not shown.

    The top is wide, or with the foot the narrower of both ends.
    """
    y, z = points.T
    height = float(np.ptp(z))
    if height < FLAT:
        return 0, 0
    if height > WHOLE_RAIL:
        upper, lower = (np.ptp(y[part]) for part in (z > z.max() - 0.25 * height, z < z.min() + 0.25 * height))
        return (1 if upper < lower else -1), 0
    weight = np.abs(np.diff(y))
    level = np.sum(weight * 0.5 * (z[1:] + z[:-1])) / max(weight.sum(), 1e-300)
    above, below = z.max() - level, level - z.min()
    return (0 if max(above, below) < 1.2 * min(above, below) else 1 if above < below else -1), 0


def _lean(points: Array) -> float:
    """Inclination rad of a rail head to the gauge side, from both flanks; 0 where there are not both.

    A flank that is worn is less steep than that of a new rail, as if the head leaned to the other side.
    """
    y, z = points[:, 0], points[:, 1] - points[:, 1].max()
    top, angles = int(np.argmax(z)), []
    for flank in (np.arange(top, -1, -1), np.arange(top, len(z))):
        if len(flank) < 2:
            return 0.0
        deep = z[flank] < FLANK[1]
        ends = (z[flank] < FLANK[0]) | (deep & (np.abs(np.gradient(y[flank])) > np.abs(np.gradient(z[flank]))))
        part = flank[deep & ~np.maximum.accumulate(ends)]
        if len(part) < 4 or np.ptp(z[part]) < 0.4 * (FLANK[1] - FLANK[0]):
            return 0.0
        angles.append(float(np.arctan(np.polyfit(z[part], y[part], 1)[0])))
    return -0.5 * sum(angles)


def to_rolling_circle(raw: RawProfile, flange_back: float, rolling_circle: float | None) -> RawProfile:
    """Points of a wheel with y from its rolling circle.

    Parameters:
        raw: oriented points.
        flange_back: y of the flange's back from the rolling circle, m.
        rolling_circle: y of the rolling circle in the points, m; None: recognised by the flange.
    """
    shift, words = 0.0, "y from the rolling circle"
    tip = _flange_tip(raw.points)
    if rolling_circle is not None:
        shift, words = -rolling_circle, f"rolling circle at y = {1e3 * rolling_circle:g} mm as asked for"
    elif tip is not None and abs(tip) < BACK_TIP:
        shift = flange_back
        words = (
            f"flange tip at y = {1e3 * tip:.1f} mm: y is taken from the flange back, {-1e3 * flange_back:g} mm from "
            "the rolling circle (rolling_circle gives another y of it)"
        )
    elif tip is not None and abs(tip - TIP) > TIP_TOLERANCE:
        far = abs(tip - TIP) > TIP_NEAR
        shift = TIP - tip if far else 0.0
        words = (
            f"flange tip at y = {1e3 * tip:.1f} mm, usually {1e3 * TIP:g} mm: y is taken from "
            f"{'the tip' if far else 'the rolling circle'} (rolling_circle gives another y of it)"
        )
        if far:
            _warn(raw, words)
    points = raw.points + np.array([shift, 0.0])
    return replace(raw, points=points, convention=(*raw.convention, words))


def _flange_tip(points: Array) -> float | None:
    """y m of the flange's tip, None without a flange on the side of negative y."""
    if _flange(points) != (1, 1):
        return None
    highest = points[np.argmax(points[:, 1])]
    y, z = (points - highest)[np.hypot(*(points - highest).T) < NEAR_TIP].T
    curvature, slope = np.polyfit(y, z, 2)[:2] if len(y) > 2 else (-1.0, 0.0)
    return float(highest[0] - 0.5 * slope / curvature) if curvature < 0.0 else float(highest[0])
