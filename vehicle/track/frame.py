"""Moving track frame: its rotation, and accelerations of bodies described in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import RailShift
from wheelrail.support.arrays import Array

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Frame:
    """Motion of the track frame (x tangent, y left, z normal to the rails), components in its own axes.

    Parameters:
        speed: along x, m/s.
        acceleration: along x, m/s2.
        rate, rate_dot: (3,) angular velocity rad/s and angular acceleration rad/s2 of the frame.
        down: (3,) unit vector of gravity.
        rails: displacement of the rails by irregularities, as in
            `wheelrail.contact.kinematics.wheelset_state.WheelsetState`.
        distance: along the track, m.
    """

    speed: float
    acceleration: float
    rate: Vector
    rate_dot: Vector
    down: Vector
    rails: RailShift | None = None
    distance: float = 0.0

    def steady(self) -> Frame:
        """Frame of a smooth infinite curve: constant speed, no roll rate, no angular acceleration."""
        _, wy, wz = self.rate
        return Frame(self.speed, 0.0, (0.0, wy, wz), (0.0, 0.0, 0.0), self.down, distance=self.distance)

    def acceleration_of(self, y: Array, z: Array, y_rate: Array, z_rate: Array) -> tuple[Array, Array]:
        """Absolute acceleration in y and z, m/s2, of points (0, y, z) without relative acceleration.

        Parameters:
            y, z: (...) m in the frame.
            y_rate, z_rate: (...) m/s relative to the frame.
        """
        (wx, wy, wz), (dx, _, _) = self.rate, self.rate_dot
        lateral = self.speed * wz - dx * z - (wx * wx + wz * wz) * y + wy * wz * z - 2 * wx * z_rate
        vertical = -self.speed * wy + dx * y - (wx * wx + wy * wy) * z + wy * wz * y + 2 * wx * y_rate
        return lateral, vertical

    def rate_in_body_axes(self, roll: Array) -> tuple[Array, Array]:
        """Lateral and vertical components (...) rad/s of the frame's rate in axes rotated by a roll (...) rad."""
        _, wy, wz = self.rate
        c, s = np.cos(roll), np.sin(roll)
        return wy * c + wz * s, wz * c - wy * s
