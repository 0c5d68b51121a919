"""Undeformed penetration of the surfaces of two bodies, strip by strip along the rolling direction."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from wheelrail.contact.geometry.quadric_pair import curvature, vertical_approach
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.geometry.wheel_surface import wheel_place
from wheelrail.contact.kinematics.frames import Pose
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

    def along(self, s: Array) -> Array:
        """Length on the surface at s over length on the rolling circle."""

    def approach(self, pose: Pose) -> float:
        """Largest penetration m of the whole surfaces; separated ones have minus their gap."""


NEXT = 1e-3  # m: points closer than that have neighbouring closest points


@compiled
def projected(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, s: Array, x: Array
) -> tuple[Array, Array]:
    """Penetration (n,) m, -inf beyond the rail's ends, and arc length (n,) m of the closest points on an extruded rail,
    of points s, x (n,) m of a wheel revolved about y, with a radius m.
    """
    n = len(s)
    overlap, feet, points, axes = np.empty(n), np.empty(n), np.empty((n, 3)), np.empty((n, 3, 3))
    last, sample = complex(np.inf, 0.0), 0
    for i in range(n):
        wheel_place(wheel, radius, origin, rotation, s[i], x[i], points, axes, i)
        q = complex(points[i, 1], points[i, 2])
        sample = nearer_sample(rail, q, sample) if abs(q - last) < NEXT else nearest_sample(rail, q)
        last = q
        feet[i], _, inside = foot(rail, q, rail.samples[sample])
        on_rail, _, _ = local(rail, feet[i], piece(rail, feet[i]))
        away = (q.real - on_rail.real) * axes[i, 2, 1] + (q.imag - on_rail.imag) * axes[i, 2, 2]
        overlap[i] = away if inside else -np.inf
    return overlap, feet


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

    def _projected(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array]:
        """`projected` points."""
        place = pose.origin, np.ascontiguousarray(pose.rotation)
        points = (np.ascontiguousarray(part, dtype=float) for part in (s, x))
        return projected(self.wheel.shape, self.rail.shape, self.radius, *place, *points)

    def penetration_profile(self, pose: Pose, s: Array) -> PenetrationProfile:
        """Penetration is largest where the wheel's circle is parallel to the rail: where its tangent has no component
        along the rail's normal.
        """
        x = np.zeros_like(s)
        for _ in range(2 if pose.rotation[1, 0] != 0 else 0):
            across = (
                np.column_stack([np.zeros_like(s), self.rail.normal(self._projected(pose, s, x)[1])]) @ pose.rotation
            )
            x = -self.radius * np.arctan(across[:, 0] / across[:, 2])
        depth = self._projected(pose, s, x)[0]
        r, nr = self.wheel.point(s)[:, 1] + self.radius, self.wheel.normal(s)[:, 1]
        return PenetrationProfile(s, depth, x, np.maximum(r * nr, 0.05 * r) / self.radius**2)

    def along(self, s: Array) -> Array:
        return stretched(self.wheel.shape, self.radius, s)

    @cached_property
    def rigid(self) -> RigidWheelRail:
        """The surfaces as those of rigid bodies."""
        return RigidWheelRail(self.wheel, self.rail, self.radius)

    def approach(self, pose: Pose) -> float:
        return self.rigid.approach(pose)


@dataclass(frozen=True)
class QuadricStrips:
    """Two bodies on large blocks, see `wheelrail.contact.geometry.quadric_pair`.

    Parameters:
        upper, lower: principal radii in x and y, m.
        half_width: m, of the part of the surface that carries contact points.
        semi_axes: m, along and across, of the expected patch.
    """

    upper: tuple[float, float]
    lower: tuple[float, float]
    half_width: float
    semi_axes: tuple[float, float]

    def penetration_profile(self, pose: Pose, s: Array) -> PenetrationProfile:
        (ax, ay), (bx, by) = curvature(self.upper), curvature(self.lower)
        X, Y, Z = pose.origin
        x = np.full_like(s, X * ax / (ax + bx))
        depth = -Z - ax * (x - X) ** 2 - ay * (s - Y) ** 2 - bx * x * x - by * s * s
        return PenetrationProfile(s, depth, x, np.full_like(s, 2 * (ax + bx)))

    def along(self, s: Array) -> Array:
        return np.ones_like(s)

    def approach(self, pose: Pose) -> float:
        return vertical_approach(self.upper, self.lower, pose)
