"""The moving track frame: how it turns, and what a body feels that is described in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import RailShift
from wheelrail.support.arrays import Array

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Frame:
    """Motion of the track frame (x tangent, y left, z normal to the rails), components in its own axes.

    speed m/s, acceleration m/s2 along x; rate rad/s and rate_dot rad/s2 of the frame; down: unit vector of gravity;
    rails: where irregularities put them, as in `wheelrail.contact.kinematics.wheelset_state.WheelsetState`.
    """

    speed: float
    acceleration: float
    rate: Vector
    rate_dot: Vector
    down: Vector
    rails: RailShift | None = None

    def steady(self) -> Frame:
        """The frame of a smooth curve without end: no change of speed, no roll rate, no angular acceleration."""
        _, wy, wz = self.rate
        return Frame(self.speed, 0.0, (0.0, wy, wz), (0.0, 0.0, 0.0), self.down)

    def acceleration_of(self, y: Array, z: Array, y_rate: Array, z_rate: Array) -> tuple[Array, Array]:
        """Absolute acceleration in y and z of points (0, y, z), without their own y and z accelerations, m/s2."""
        (wx, wy, wz), (dx, _, _) = self.rate, self.rate_dot
        lateral = self.speed * wz - dx * z - (wx * wx + wz * wz) * y + wy * wz * z - 2 * wx * z_rate
        vertical = -self.speed * wy + dx * y - (wx * wx + wy * wy) * z + wy * wz * y + 2 * wx * y_rate
        return lateral, vertical

    def turned(self, roll: Array) -> tuple[Array, Array]:
        """Parts of the frame's rate along the lateral and vertical axes of bodies that rolled, rad/s."""
        _, wy, wz = self.rate
        c, s = np.cos(roll), np.sin(roll)
        return wy * c + wz * s, wz * c - wy * s
