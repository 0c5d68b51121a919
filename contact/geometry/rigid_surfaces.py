"""Surfaces of two interpenetrating rigid bodies: a wheel on a rail, or two quadrics."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from wheelrail.bindings._contact import (
    UNSOLVED,
    Lines,
    PenetrationRegions,
    Scan,
    lines_to_scan,
    nearest_place,
    overlap_text,
    profile_places,
    scan,
    wheel_points,
)
from wheelrail.contact.geometry.interpenetration import (
    overlap,
    profile_regions,
    quadric_regions,
)
from wheelrail.contact.geometry.line_scan import sampled_lines
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.bodies.solids import contact_range
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

SPACING = 4e-4  # m, between the lines on which the penetration is sampled
MERGE = 4e-3  # m: half the width of a patch on a rail head; two such ellipses at this distance are one patch


class RigidPair(Protocol):
    """Two interpenetrating rigid surfaces."""

    def regions(self, pose: Pose) -> tuple[PenetrationRegions | None, float]:
        """Interpenetration regions (None without contact) and the largest penetration m.

        Raises ValueError for a penetration beyond the sampled lines.
        """

    @property
    def extent(self) -> tuple[float, float]:
        """Longest semi-axes m, along and across, of a patch that lies on both bodies."""

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array]:
        """Points (n, 3) m and axes (n, 3, 3) on the upper body's surface.

        Parameters:
            pose: of the upper body.
            s, x: (n,) m, arc length on its profile, and longitudinal.

        Axes as in `wheelrail.contact.kinematics.contact_points.SurfacePoints`.
        """

    def profiles(self, s: Array, point: Array) -> tuple[Array, Array]:
        """Arc length and lateral position (n, 2) m of points on the profiles of both bodies.

        Parameters:
            s: (n,) m, arc length on the upper body.
            point: (n, 3) m.
        """


@dataclass(frozen=True)
class RigidWheelRail:
    """A wheel, its profile revolved, on a rail, its profile extruded.

    Parameters:
        wheel, rail: profiles.
        radius: nominal rolling radius, m.
        merge_distance: m, maxima of the penetration closer than that are one contact, see
            `wheelrail.contact.geometry.interpenetration`.
    """

    wheel: Profile
    rail: Profile
    radius: float
    merge_distance: float = MERGE

    @cached_property
    def lines(self) -> Lines:
        return sampled_lines(self.wheel, self.rail, contact_range(self.wheel), SPACING)

    def regions(self, pose: Pose) -> tuple[PenetrationRegions | None, float]:
        return profile_regions(self.wheel, self.rail, self.radius, pose, self.lines, self.merge_distance)

    def overlap(self, pose: Pose) -> str:
        """Text on the overlap of a wheel that cannot be solved; see `overlap`."""
        return overlap(self.wheel, self.rail, self.radius, pose, self.lines)

    def scanned(self, pose: Pose) -> tuple[tuple[int, int], Scan]:
        """First of the lines that may overlap the rail, and one past the last, and their scan."""
        part = lines_to_scan(self.lines, self.radius, *pose.arrays)
        return part, scan(self.rail.shape, self.lines, self.radius, *pose.arrays, part)

    def approach(self, pose: Pose) -> float:
        """Largest penetration m; separated surfaces have minus their gap, the smallest distance of their points."""
        return self.nearest(pose)[1]

    def nearest(self, pose: Pose) -> tuple[float, float, float]:
        """As `nearest_place`."""
        part, samples = self.scanned(pose)
        return nearest_place(self.wheel.shape, self.rail.shape, self.radius, *pose.arrays, self.lines, part, samples)

    def unsolved(self, pose: Pose, first: float, last: float) -> str:
        """Depth and place of the deepest overlap on lines of the wheel that a model leaves out; empty without.

        Parameters:
            pose: of the wheel.
            first, last: m, arc lengths between which the model solves contacts.
        """
        lines = self.lines
        part = lines_to_scan(lines, self.radius, *pose.arrays)
        left_out = (lines.s[part[0] : part[1]] < first) | (lines.s[part[0] : part[1]] > last)
        if not left_out.any():
            return ""
        depth = scan(self.rail.shape, lines, self.radius, *pose.arrays, part).depth[part[0] : part[1]]
        deepest = int(np.where(left_out, depth, -1.0).argmax())
        if not (left_out[deepest] and depth[deepest] > 0.0):
            return ""
        place = self.wheel.point(lines.s[part[0] + deepest])
        return overlap_text(depth[deepest], place, UNSOLVED)

    @property
    def extent(self) -> tuple[float, float]:
        first, last = self.rail.s_range
        return self.radius, 0.5 * (last - first)

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array]:
        return wheel_points(self.wheel.shape, self.radius, *pose.arrays, s, x)

    def profiles(self, s: Array, point: Array) -> tuple[Array, Array]:
        return profile_places(self.wheel.shape, self.rail.shape, s, point)


@dataclass(frozen=True)
class RigidQuadrics:
    """Two rigid quadrics, see `wheelrail.contact.geometry.quadric_pair`.

    Parameters:
        upper, lower: principal radii in x and y, m.
    """

    upper: tuple[float, float]
    lower: tuple[float, float]

    def regions(self, pose: Pose) -> tuple[PenetrationRegions | None, float]:
        return quadric_regions(self.upper, self.lower, pose)

    @property
    def extent(self) -> tuple[float, float]:
        along, across = np.abs([self.upper, self.lower]).min(axis=0)
        return float(along), float(across)

    def at(self, pose: Pose, s: Array, x: Array) -> tuple[Array, Array]:
        axes = np.zeros((len(s), 3, 3))
        axes[:] = np.diag([1.0, 1.0, -1.0])
        return np.column_stack([x, s, np.zeros_like(s)]), axes

    def profiles(self, s: Array, point: Array) -> tuple[Array, Array]:
        position = np.column_stack([s, s])
        return position, position
