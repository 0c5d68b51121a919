"""Where the wheel stands and how both bodies move: wheelset motion in the track frame -> one wheel-rail pair.

Frames: x forward, y left, z up. Every pair is solved as a left one; the right-hand pair is its mirror image in y.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from wheelrail.support.arrays import Array

Side = Literal["left", "right"]


SIDES: tuple[Side, Side] = ("left", "right")
MIRROR = np.array([1.0, -1.0, 1.0])  # of a vector; an axial vector takes -MIRROR


@dataclass(frozen=True)
class Pose:
    """Pose of the wheel frame in the rail frame: origin (3,) in m, rotation (3, 3) with the wheel's axes as columns."""

    origin: Array
    rotation: Array

    def mirrored(self) -> Pose:
        """The same seen in a mirror at y = 0, in which the wheel's own lateral axis still points left."""
        return Pose(MIRROR * self.origin, self.rotation * np.outer(MIRROR, MIRROR))


@dataclass(frozen=True)
class Twist:
    """Rigid velocity field v + w x (X - reference): velocity (3,) in m/s, rotation (3,) in rad/s, reference (3,) in
    m.
    """

    velocity: Array
    rotation: Array
    reference: Array

    def at(self, points: Array) -> Array:
        """Velocity [m/s] at points (n, 3) [m]."""
        return np.asarray(self.velocity + np.cross(self.rotation, points - self.reference))


@dataclass(frozen=True)
class RigidMotion:
    """Rigid velocity fields of wheel material (spin included) and rail material, in the rail frame, eq. (5)."""

    wheel: Twist
    rail: Twist
