"""Undeformed wheel and rail from the points of their profiles: gaps, overlaps, heights of first contact.

The wheel is a surface of revolution, the rail a prism. In the projection along the track the wheel's outline is its
silhouette: on the circle of every profile point the place whose normal has no longitudinal component. Distances are
those of its points to the polygon of the rail. NumPy and SciPy only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import maximum_filter1d
from scipy.spatial import cKDTree

from benchmarks.population.profiles import Shape, arc
from wheelrail.support.arrays import Array, Mask, Nodes

FINE = 1e-4  # m, spacing of the points: 0.1 µm off an arc of 13 mm
FACE = 10e-3  # m above the tread, where the thickness of a flange is measured
CORNER = 0.2  # rad between chords: a spline through a corner of 45 degrees, 0.2 mm apart, overshoots it by 8 um
STEEPEST = 0.7  # sine of the largest angle about the axle at which a silhouette is looked for


@dataclass(frozen=True)
class Position:
    """Position of the wheelset: y, z above the nominal height, m; roll, yaw, rad."""

    y: float
    z: float
    roll: float
    yaw: float

    def mirrored(self) -> Position:
        return Position(-self.y, self.z, -self.roll, -self.yaw)


@dataclass(frozen=True)
class Section:
    """Overlap of the outlines.

    Parameters:
        y: (n,) m, on the wheel's profile from the rolling circle.
        place: (n, 3) m, in the frame of the rail.
        depth: (n,) m, penetration of the points into the rail; negative is the distance.
        height: (n,) m, above the rail vertically; inf beside it.
    """

    y: Array
    place: Array
    depth: Array
    height: Array

    @cached_property
    def arc(self) -> Array:
        """Lengths (n,) m along the outline."""
        return arc(self.place[:, 1:])


@dataclass(frozen=True)
class RigidSide:
    """Wheel and rail of one side, as a left-hand pair.

    Parameters:
        wheel, rail: shapes.
        inclination: of the rail, rad.
        radius: of the wheel, m.
        nominal: radius of the wheelset m, of whose centre the height is counted.
        wheel_y: m, from the wheelset's centre to the rolling circle.
        gauge, gauge_height: m.
    """

    wheel: Shape
    rail: Shape
    inclination: float
    radius: float
    nominal: float
    wheel_y: float
    gauge: float
    gauge_height: float

    @cached_property
    def wheel_points(self) -> Array:
        """Points (n, 2) m with z = 0 on the rolling circle, before its wear is calculated."""
        points = _dense(self.wheel.points)
        if "abraded" in dict(self.wheel.parameters):
            return np.asarray(points)
        return np.asarray(points - (0.0, float(np.interp(0.0, points[:, 0], points[:, 1]))))

    @cached_property
    def corners(self) -> Mask:
        """Whether the outline of the wheel turns sharply near its points (n,)."""
        chords = np.diff(self.wheel_points, axis=0)
        turns = np.abs(np.diff(np.unwrap(np.arctan2(chords[:, 1], chords[:, 0])))) > 0.5 * CORNER
        return np.asarray(maximum_filter1d(np.pad(turns, 1), 5))

    @cached_property
    def rounding(self) -> float:
        """Largest distance m of one spline through all points of the wheel from the outline with its sharp corners: a
        file does not say how its points are joined.
        """
        places, points = zip(*_between_corners(self.wheel.points), strict=True)
        whole = CubicSpline(arc(self.wheel.points), self.wheel.points)
        return float(np.hypot(*(whole(np.concatenate(places)) - np.concatenate(points)).T).max())

    @cached_property
    def rail_points(self) -> Array:
        """Points (n, 2) m of the inclined rail from its top."""
        points, c, s = _dense(self.rail.points), np.cos(self.inclination), np.sin(self.inclination)
        turned = points @ np.array([[c, s], [-s, c]])
        return np.asarray(turned - _highest(turned))

    @cached_property
    def flange_y(self) -> float:
        """Lateral position m of the flange's face, 10 mm above the tread, from the wheelset's centre."""
        y, z = self.wheel_points.T
        tip = int(np.argmax(z))
        face = tip + int(np.argmax(z[tip:] < FACE))
        return float(self.wheel_y + np.interp(FACE, z[[face, face - 1]], y[[face, face - 1]]))

    @cached_property
    def rail_y(self) -> float:
        """Lateral position m of the rail's top from the middle of the track."""
        y, z = self.rail_points.T
        top = int(np.argmax(z))
        below = np.flatnonzero(z[:top] <= -self.gauge_height)
        first = below[-1] if len(below) else -1
        inner = [*y[first + 1 : top]]
        if first >= 0:
            inner.append(np.interp(-self.gauge_height, z[first : first + 2], y[first : first + 2]))
        return float(0.5 * self.gauge - min(inner))

    def outline(self, at: Position) -> Array:
        """Points (n, 3) m of the wheel's silhouette in the frame of the rail."""
        c, s, cy, sy = np.cos(at.roll), np.sin(at.roll), np.cos(at.yaw), np.sin(at.yaw)
        rotation = np.array([[cy, -sy * c, sy * s], [sy, cy * c, -cy * s], [0.0, s, c]])
        centre = np.array([0.0, at.y - self.rail_y, self.nominal + at.z]) + rotation @ [0.0, self.wheel_y, 0.0]
        return self.silhouette(centre, rotation)

    def silhouette(self, centre: Array, rotation: Array) -> Array:
        """Points (n, 3) m of the silhouette of a wheel with a centre (3,) m and axes (3, 3) in the frame of the rail.

        n = -tz e_y + ty e_r at the angle a, e_r = (sin a, 0, -cos a), is normal to x where
        R00 sin a - R02 cos a = R01 tz / ty.
        """
        y, z = self.wheel_points.T
        ty, tz = np.gradient(self.wheel_points, axis=0).T
        size, phase = np.hypot(rotation[0, 0], rotation[0, 2]), np.arctan2(rotation[0, 2], rotation[0, 0])
        sine = rotation[0, 1] * tz / np.where(np.abs(ty) > 1e-12, ty, 1e-12) / size
        angle = phase + np.arcsin(np.clip(sine, -STEEPEST, STEEPEST))
        r = self.radius + z
        return np.asarray(centre + np.column_stack([r * np.sin(angle), y, -r * np.cos(angle)]) @ rotation.T)

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.rail_points)

    def nearest(self, places: Array) -> Nodes:
        """Numbers (n,) of the rail's points nearest to places (n, 2) m."""
        return np.asarray(self._tree.query(places)[1])

    def depth(self, places: Array) -> Array:
        """Penetrations (n,) m of points (n, 2) into the rail; negative is the distance."""
        rail, nearest = self.rail_points, self.nearest(places)
        best, inside = np.full(len(places), np.inf), np.zeros(len(places), dtype=bool)
        for first in (nearest - 1, nearest):
            at = np.clip(first, 0, len(rail) - 2)
            a, d = rail[at], rail[at + 1] - rail[at]
            t = ((places - a) * d).sum(axis=1) / (d * d).sum(axis=1)
            off = places - a - np.clip(t, 0.0, 1.0)[:, None] * d
            distance = np.hypot(*off.T)
            below = d[:, 0] * off[:, 1] - d[:, 1] * off[:, 0] < 0.0
            beyond = ((at == 0) & (t < 0.0)) | ((at == len(rail) - 2) & (t > 1.0))
            closer = distance < best
            best, inside = np.where(closer, distance, best), np.where(closer, below & ~beyond, inside)
        return np.where(inside, best, -best)

    @cached_property
    def _roof(self) -> Array:
        """Highest points (n, 2) m of the rail over ascending y."""
        y, z = self.rail_points.T
        top = int(np.argmax(z))
        # towards both ends the rail is seen from above: y must not step back
        left = np.minimum.accumulate(y[top::-1])[::-1]
        right = np.maximum.accumulate(y[top:])
        return np.column_stack([np.concatenate([left, right[1:]]), z])

    def section(self, at: Position) -> Section:
        """Overlap at a position."""
        return self.overlap(self.outline(at))

    def overlap(self, place: Array) -> Section:
        """Overlap of a silhouette (n, 3) m."""
        roof = self._roof
        over = np.interp(place[:, 1], roof[:, 0], roof[:, 1], left=-np.inf, right=-np.inf)
        return Section(self.wheel_points[:, 0], place, self.depth(place[:, 1:]), place[:, 2] - over)

    def first_contact(self, at: Position) -> float:
        """Height z m of the wheelset at which the wheel, lowered from above, touches; -inf beside the rail."""
        return at.z - float(self.section(at).height.min())


def _dense(points: Array) -> Array:
    """Points FINE apart on cubic splines through given ones (n, 2) m, from corner to corner."""
    return np.concatenate([*(part for _, part in _between_corners(points)), points[-1:]])


def _between_corners(points: Array) -> list[tuple[Array, Array]]:
    """Lengths (k,) m along the chords of given points (n, 2) m, and points (k, 2) m there, from corner to corner."""
    s, chords = arc(points), np.diff(points, axis=0)
    turns = np.diff(np.unwrap(np.arctan2(chords[:, 1], chords[:, 0])))
    ends = [0, *(np.flatnonzero(np.abs(turns) > CORNER) + 1), len(s) - 1]
    parts = []
    for first, last in pairwise(ends):
        own, place = slice(first, last + 1), s[first : last + 1] - s[first]
        at = np.linspace(0.0, place[-1], int(np.ceil(place[-1] / FINE)) + 1)[:-1]
        parts.append((s[first] + at, CubicSpline(place, points[own])(at)))
    return parts


def _highest(points: Array) -> Array:
    """Highest point (2,) m, by the parabola through three points (n, 2) m; the middle of a flat top."""
    level = np.append(points[:, 1] > points[:, 1].max() - 1e-7, False)
    first = int(np.argmax(level))  # of equal humps the one on the gauge side
    last = first + int(np.argmin(level[first:])) - 1
    if points[last, 0] - points[first, 0] > 5e-3:
        return np.array([0.5 * (points[first, 0] + points[last, 0]), points[:, 1].max()])
    top = int(np.clip(first + np.argmax(points[first : last + 1, 1]), 1, len(points) - 2))
    y, z = points[top - 1 : top + 2].T
    a, b, _ = np.polyfit(y - y[1], z - z[1], 2)
    if not a < 0.0:
        return np.asarray(points[np.argmax(points[:, 1])])
    off = float(np.clip(-0.5 * b / a, y[0] - y[1], y[2] - y[1]))
    return np.array([y[1] + off, z[1] + (a * off + b) * off])
