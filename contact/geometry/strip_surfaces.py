"""Undeformed penetration of the surfaces of two bodies, strip by strip along the rolling direction."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from wheelrail.contact.geometry.quadric_pair import UPSIDE_DOWN, curvature
from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.geometry.wheel_surface import wheel_place
from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.kinematics.sensitivity import QuadricSensitivity, WheelPointSensitivity
from wheelrail.meshes.curves.closest_point import Shape, foot, local, nearer_sample, nearest_sample, piece
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


@dataclass(frozen=True)
class PenetrationProfile:
    """Largest penetration along every line of the upper body.

    Parameters:
        s: (ns,) m, arc length of the lines.
        penetration: (ns,) m, largest penetration; negative is a distance.
        x: (ns,) m, its position along the rolling circle.
        curvature: (ns,) 1/m, relative curvature there: penetration - curvature x^2 / 2.
    """

    s: Array
    penetration: Array
    x: Array
    curvature: Array


class StripSurfaces(Protocol):
    """Surfaces of a pair of bodies for strips: s m across and x m along the rolling circle of the upper body."""

    def penetration_profile(self, pose: Pose, s: Array) -> PenetrationProfile: ...

    def penetration(self, pose: Pose, s: Array, x: Array) -> Array:
        """Undeformed penetration m at s and x of one shape."""

    def places(self, pose: Pose, layout: StripLayout) -> SurfacePoints:
        """The cells' middles, strip by strip from the trailing end."""

    def along(self, s: Array) -> Array:
        """Length on the surface at s over length on the rolling circle."""


NEXT = 1e-3  # m: points closer than that have neighbouring closest points


class ProjectedPoints(NamedTuple):
    """Points of a wheel's surface projected on a rail.

    Parameters:
        penetration: (n,) m, undeformed penetration; -inf beyond the rail's ends.
        foot: (n, 2) m, arc length and lateral position of the closest points on the rail.
        level: (n, 3) longitudinal axes in the rail's surface, perpendicular to the axle.
        point: (n, 3) m.
        axes: (n, 3, 3), rows longitudinal, lateral and outward.
    """

    penetration: Array
    foot: Array
    level: Array
    point: Array
    axes: Array


@compiled
def projected(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, s: Array, x: Array
) -> tuple[Array, Array, Array, Array, Array]:
    """`ProjectedPoints` of points s, x (n,) m of a wheel revolved about y, with a radius m, on an extruded rail."""
    n = len(s)
    overlap, feet, level, points, axes = (
        np.empty(n),
        np.empty((n, 2)),
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty((n, 3, 3)),
    )
    last, sample = complex(np.inf, 0.0), 0
    for i in range(n):
        wheel_place(wheel, radius, origin, rotation, s[i], x[i], points, axes, i)
        q = complex(points[i, 1], points[i, 2])
        sample = nearer_sample(rail, q, sample) if abs(q - last) < NEXT else nearest_sample(rail, q)
        last = q
        feet[i, 0], _, inside = foot(rail, q, rail.samples[sample])
        on_rail, t, _ = local(rail, feet[i, 0], piece(rail, feet[i, 0]))
        feet[i, 1] = on_rail.real
        away = (q.real - on_rail.real) * axes[i, 2, 1] + (q.imag - on_rail.imag) * axes[i, 2, 2]
        overlap[i] = away if inside else -np.inf
        # axle times the rail's normal (0, -t_z, t_y)
        forward = rotation[1, 1] * t.real + rotation[2, 1] * t.imag
        size = np.sqrt(forward * forward + rotation[0, 1] * rotation[0, 1])
        level[i, 0] = forward / size
        level[i, 1], level[i, 2] = -rotation[0, 1] * t.real / size, -rotation[0, 1] * t.imag / size
    return overlap, feet, level, points, axes


@compiled
def stretched(wheel: Shape, radius: float, s: Array) -> Array:
    """Length on the surface at s (n,) over length on the rolling circle."""
    factor = np.empty(len(s))
    for i in range(len(s)):
        z, _, _ = local(wheel, s[i], piece(wheel, s[i]))
        factor[i] = 1.0 + z.imag / radius
    return factor


@dataclass(frozen=True)
class ProfileStrips:
    """A wheel of nominal radius m, its profile revolved about y, on a rail, its profile extruded."""

    wheel: Profile
    rail: Profile
    radius: float

    @cached_property
    def _follows(self) -> WheelPointSensitivity:
        return WheelPointSensitivity.of(self.rail)

    def _seen(self, pose: Pose, s: Array, x: Array) -> ProjectedPoints:
        """Points of the wheel, projected on the rail."""
        coordinates = np.broadcast_arrays(s, x)
        return ProjectedPoints(
            *projected(
                self.wheel.shape,
                self.rail.shape,
                self.radius,
                pose.origin,
                np.ascontiguousarray(pose.rotation),
                *(np.ascontiguousarray(part.ravel(), dtype=float) for part in coordinates),
            )
        )

    def penetration_profile(self, pose: Pose, s: Array) -> PenetrationProfile:
        """Penetration is largest where the wheel's circle is parallel to the rail: where its tangent has no component
        along the rail's normal.
        """
        x = np.zeros_like(s)
        for _ in range(2 if pose.rotation[1, 0] != 0 else 0):
            across = (
                np.column_stack([np.zeros_like(s), self.rail.normal(self._seen(pose, s, x).foot[:, 0])]) @ pose.rotation
            )
            x = -self.radius * np.arctan(across[:, 0] / across[:, 2])
        depth = self._seen(pose, s, x).penetration
        r, nr = self.wheel.point(s)[:, 1] + self.radius, self.wheel.normal(s)[:, 1]
        return PenetrationProfile(s, depth, x, np.maximum(r * nr, 0.05 * r) / self.radius**2)

    def penetration(self, pose: Pose, s: Array, x: Array) -> Array:
        return self._seen(pose, s, x).penetration.reshape(x.shape)

    def along(self, s: Array) -> Array:
        return stretched(self.wheel.shape, self.radius, s)

    def places(self, pose: Pose, layout: StripLayout) -> SurfacePoints:
        edges = layout.edges
        x = 0.5 * (edges[:, 1:] + edges[:, :-1])
        s = np.repeat(layout.middle, x.shape[1])
        at = self._seen(pose, s, x.ravel())
        length = np.diff(edges) * self.along(layout.middle)[:, None]
        return SurfacePoints(
            point=at.point,
            axes=at.axes,
            area=(length * layout.width[:, None]).ravel(),
            penetration=at.penetration,
            wheel_rotation=pose.rotation,
            step=length.ravel(),
            wheel_place=np.column_stack([s, np.repeat(self.wheel.point(layout.middle)[:, 0], x.shape[1])]),
            rail_place=at.foot,
            level=at.level,
            sensitivity=self._follows,
        )


@dataclass(frozen=True)
class QuadricStrips:
    """Two bodies on large blocks, see `wheelrail.contact.geometry.quadric_pair`.

    Parameters:
        upper, lower: principal radii in x and y, m.
        half_width: m, of the part of the surface that carries contact points.
        semi_axis: m, across, of the expected patch.
    """

    upper: tuple[float, float]
    lower: tuple[float, float]
    half_width: float
    semi_axis: float

    def penetration_profile(self, pose: Pose, s: Array) -> PenetrationProfile:
        (ax, _), (bx, _) = curvature(self.upper), curvature(self.lower)
        x = np.full_like(s, pose.origin[0] * ax / (ax + bx))
        return PenetrationProfile(s, self.penetration(pose, s, x), x, np.full_like(s, 2 * (ax + bx)))

    def penetration(self, pose: Pose, s: Array, x: Array) -> Array:
        (ax, ay), (bx, by) = curvature(self.upper), curvature(self.lower)
        X, Y, Z = pose.origin
        return np.asarray(-Z - ax * (x - X) ** 2 - ay * (s - Y) ** 2 - bx * x * x - by * s * s)

    def along(self, s: Array) -> Array:
        return np.ones_like(s)

    def places(self, pose: Pose, layout: StripLayout) -> SurfacePoints:
        edges = layout.edges
        x = (0.5 * (edges[:, 1:] + edges[:, :-1])).ravel()
        s = np.repeat(layout.middle, edges.shape[1] - 1)
        length = np.diff(edges)
        across = np.column_stack([s, s])
        return SurfacePoints(
            point=np.column_stack([x, s, np.zeros_like(x)]),
            axes=np.broadcast_to(np.diag([1.0, 1.0, -1.0]), (len(x), 3, 3)),
            area=(length * layout.width[:, None]).ravel(),
            penetration=self.penetration(pose, s, x),
            wheel_rotation=UPSIDE_DOWN,
            step=length.ravel(),
            wheel_place=across,
            rail_place=across,
            sensitivity=QuadricSensitivity(self.upper),
        )
