"""State of the upper body of a Hertz pair, and the pose and motion of both bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class HertzState:
    """Position and velocity of the upper body, which does not rotate but about z, relative to the lower one.

    Parameters:
        x, y, z: m, from the position of first contact; z is the negative approach.
        x_rate, y_rate: m/s, velocity of the upper body's material relative to that of the lower body.
        yaw_rate: rad/s, spin about z through the upper body's lowest point.
        speed: m/s, at which the material of the lower body flows backwards through the contact; the rolling speed is
            the mean of both materials, speed - x_rate / 2.
    """

    coordinates: ClassVar[tuple[str, ...]] = ("x", "y", "z", "x_rate", "y_rate", "yaw_rate")  # columns of tangents

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    x_rate: float = 0.0
    y_rate: float = 0.0
    yaw_rate: float = 0.0
    speed: float = 0.0

    @property
    def reference(self) -> Array:
        """Point (3,) m above which the upper body stands, in the plane of first contact."""
        return np.array([self.x, self.y, 0.0])

    def pair(self) -> tuple[Pose, RigidMotion]:
        """Pose and velocities of both bodies in the frame of the lower one."""
        upper = np.array([self.x_rate - self.speed, self.y_rate, 0.0])
        lower = Twist(np.array([-self.speed, 0.0, 0.0]), np.zeros(3), self.reference)
        motion = RigidMotion(Twist(upper, np.array([0.0, 0.0, self.yaw_rate]), self.reference), lower)
        return Pose(np.array([self.x, self.y, self.z]), np.eye(3)), motion
