"""Undeformed penetration of the surfaces of two bodies, strip by strip along the rolling direction."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from wheelrail.bindings._contact import stretched
from wheelrail.contact.geometry.quadric_pair import vertical_approach
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array


class StripSurfaces(Protocol):
    """Surfaces of a pair of bodies for strips: s m across and x m along the rolling circle of the upper body."""

    def along(self, s: Array) -> Array:
        """Length on the surface at s over length on the rolling circle."""

    def nearest(self, pose: Pose) -> tuple[float, float, float]:
        """Position s m, largest penetration m of the whole surfaces, and x m; separated ones have minus their gap."""


@dataclass(frozen=True)
class ProfileStrips:
    """A wheel of nominal radius m, its profile revolved about y, on a rail, its profile extruded."""

    wheel: Profile
    rail: Profile
    radius: float

    def along(self, s: Array) -> Array:
        return stretched(self.wheel.shape, self.radius, s)

    @cached_property
    def rigid(self) -> RigidWheelRail:
        """Rigid surfaces of the same profiles."""
        return RigidWheelRail(self.wheel, self.rail, self.radius)

    def nearest(self, pose: Pose) -> tuple[float, float, float]:
        return self.rigid.nearest(pose)


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

    def along(self, s: Array) -> Array:
        return np.ones_like(s)

    def nearest(self, pose: Pose) -> tuple[float, float, float]:
        return 0.0, vertical_approach(self.upper, self.lower, pose), 0.0
