"""Surfaces of two rigid bodies that overlap: a wheel on a rail, or two quadrics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions, profile_zones, quadric_zones
from wheelrail.contact.geometry.rigid_search import Lines
from wheelrail.contact.geometry.wheel_surface import wheel_places
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.bodies.solids import wheel_touches
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

SPACING = 4e-4  # m, between the lines where humps are looked for
MERGE = 4e-3  # m: half the width of a patch on a rail head; two ellipses of that size so near would be one patch


class RigidPair(Protocol):
    """Two rigid surfaces that overlap."""

    def zones(self, pose: Pose) -> tuple[PenetrationRegions | None, float]:
        """Zones of contact (None without overlap) and the largest overlap m. Raises ValueError for one beyond reach."""

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array]:
        """Points (n, 3) m and axes (n, 3, 3), as in `wheelrail.contact.kinematics.contact_points.SurfacePoints`, of
        places on the upper body.
        """

    def profiles(self, s: Array, point: Array) -> tuple[Array, Array]:
        """Arc length and lateral position (n, 2) m on the profiles of both bodies, of such points."""


@dataclass(frozen=True)
class RigidWheelRail:
    """A wheel of nominal radius m, its profile revolved, on a rail, its profile extruded.

    merge_distance m: humps of the overlap closer than that are one contact, see
    `wheelrail.contact.geometry.interpenetration`.
    """

    wheel: Profile
    rail: Profile
    radius: float
    merge_distance: float = MERGE

    @cached_property
    def lines(self) -> Lines:
        start, stop = wheel_touches(self.wheel)
        s = np.linspace(start, stop, int(np.ceil((stop - start) / SPACING)) + 1, dtype=np.float64)
        return Lines.of(self.wheel, self.rail, s)

    def zones(self, pose: Pose) -> tuple[PenetrationRegions | None, float]:
        return profile_zones(self.wheel, self.rail, self.radius, pose, self.lines, self.merge_distance)

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array]:
        return wheel_places(self.wheel.shape, self.radius, pose.origin, np.ascontiguousarray(pose.rotation), s, x)

    def profiles(self, s: Array, point: Array) -> tuple[Array, Array]:
        s, foot = np.clip(s, *self.wheel.s_range), self.rail.closest(point[:, 1:]).s
        on_wheel, on_rail = self.wheel.point(s)[:, 0], self.rail.point(foot)[:, 0]
        return np.column_stack([s, on_wheel]), np.column_stack([foot, on_rail])


@dataclass(frozen=True)
class RigidQuadrics:
    """Two bodies with principal radii [m] in x and y, see `wheelrail.contact.geometry.quadric_pair`."""

    upper: tuple[float, float]
    lower: tuple[float, float]

    def zones(self, pose: Pose) -> tuple[PenetrationRegions | None, float]:
        return quadric_zones(self.upper, self.lower, pose)

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array]:
        axes = np.zeros((len(s), 3, 3))
        axes[:] = np.diag([1.0, 1.0, -1.0])
        return np.column_stack([x, s, np.zeros_like(s)]), axes

    def profiles(self, s: Array, point: Array) -> tuple[Array, Array]:
        both = np.column_stack([s, s])
        return both, both
