"""Surfaces of two rigid bodies that overlap: a wheel on a rail, or two quadrics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from contact.contact_zones import LINES, Zones, profile_zones, quadric_zones
from contact.pose import Array, Pose
from contact.strip_surfaces import ProfileStrips
from meshes.bodies import wheel_touches
from meshes.profiles import Profile

MERGE = 4e-3  # m: half the width of a patch on a rail head; two ellipses of that size so near would be one patch


class RigidPair(Protocol):
    """Two rigid surfaces that overlap."""

    def zones(self, pose: Pose) -> tuple[Zones | None, float]:
        """Zones of contact (None without overlap) and the largest overlap m. Raises ValueError for one beyond reach."""

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array, Array]:
        """Points (n, 3) m, axes (n, 3, 3) and arc length m of the feet on the lower body, of places of the upper one."""

    def across(self, s: Array, foot: Array) -> tuple[Array, Array]:
        """Lateral positions [m] on the profiles of both bodies."""


@dataclass(frozen=True)
class RigidWheelRail:
    """A wheel of nominal radius m, its profile revolved, on a rail, its profile extruded; see `contact_zones` for merge."""

    wheel: Profile
    rail: Profile
    radius: float
    merge_distance: float = MERGE

    @cached_property
    def lines(self) -> Array:
        start, stop = wheel_touches(self.wheel)
        return np.linspace(start, stop, int(np.ceil((stop - start) / LINES)) + 1)

    @cached_property
    def surfaces(self) -> ProfileStrips:
        return ProfileStrips(self.wheel, self.rail, self.radius)

    def zones(self, pose: Pose) -> tuple[Zones | None, float]:
        return profile_zones(self.wheel, self.rail, self.radius, pose, self.lines, self.merge_distance)

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array, Array]:
        seen = self.surfaces.seen(pose, np.clip(s, *self.wheel.s_range), x)
        return seen.point, seen.axes, seen.foot

    def across(self, s: Array, foot: Array) -> tuple[Array, Array]:
        return self.wheel.point(np.clip(s, *self.wheel.s_range))[:, 0], self.rail.point(foot)[:, 0]


@dataclass(frozen=True)
class RigidQuadrics:
    """Two bodies with principal radii [m] in x and y, see `contact.quadrics`."""

    upper: tuple[float, float]
    lower: tuple[float, float]

    def zones(self, pose: Pose) -> tuple[Zones | None, float]:
        return quadric_zones(self.upper, self.lower, pose)

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array, Array]:
        axes = np.zeros((len(s), 3, 3))
        axes[:] = np.diag([1.0, 1.0, -1.0])
        return np.column_stack([x, s, np.zeros_like(s)]), axes, s

    def across(self, s: Array, foot: Array) -> tuple[Array, Array]:
        return s, foot
