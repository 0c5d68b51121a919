"""State of a wheelset in the track frame, and the pose and motion of its left-hand pair."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import ClassVar

import numpy as np

from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.support.arrays import Array

RailShift = tuple[tuple[float, float], tuple[float, float]]


@dataclass(frozen=True)
class WheelsetState:
    """Position and velocity of a wheelset in the track frame, and the motion of that frame.

    Parameters:
        y, z: m; z from the nominal height, at which the centre is one rolling radius above the top of the rails.
        roll, yaw: rad.
        y_rate, z_rate: m/s.
        roll_rate, yaw_rate, pitch_rate: rad/s, time derivatives of roll and yaw, and the spin about the axle, positive
            for rolling forward. The angular velocity relative to the track frame is their sum about the line of nodes
            (cos yaw, sin yaw, 0), about z and about the axle.
        speed: V, m/s.
        frame_rate: (3,) rad/s, angular velocity of the track frame in its own axes; (0, 0, V K) on a flat left-hand
            curve.
        rail_shift: m, displacement (y, z) of the left and the right rail by irregularities; None: none.

    Irregularities displace the profile that the wheel meets, not the material, which is at rest in inertial space. As
    the vehicle moves, the displacement changes by V d, d its slope along the track. The profile approaches the wheel at
    this speed, but contact forces depend on penetration and slip only, and the slip is unaffected: d rotates the
    tangent plane, and both materials, which flow through it at V, gain the same component -V d. Neglected are products
    of d (1e-3) with creepage, and the longitudinal part d N of a normal force, which the constraint along x carries.
    """

    coordinates: ClassVar[tuple[str, ...]] = (
        *("y", "z", "roll", "yaw"),
        *("y_rate", "z_rate", "roll_rate", "yaw_rate", "pitch_rate"),
    )  # columns of tangents

    y: float = 0.0
    z: float = 0.0
    roll: float = 0.0
    yaw: float = 0.0
    y_rate: float = 0.0
    z_rate: float = 0.0
    roll_rate: float = 0.0
    yaw_rate: float = 0.0
    pitch_rate: float = 0.0
    speed: float = 0.0
    frame_rate: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rail_shift: RailShift | None = None

    def mirrored(self) -> WheelsetState:
        """The state in the mirror y = 0."""
        (wx, wy, wz), shift = self.frame_rate, self.rail_shift
        return changed(
            self,
            y=-self.y,
            roll=-self.roll,
            yaw=-self.yaw,
            y_rate=-self.y_rate,
            roll_rate=-self.roll_rate,
            yaw_rate=-self.yaw_rate,
            frame_rate=(-wx, wy, -wz),
            rail_shift=shift and ((-shift[1][0], shift[1][1]), (-shift[0][0], shift[0][1])),
        )

    @property
    def nodes(self) -> Array:
        """Axis (3,) of the roll: the x axis after yaw."""
        return np.array([cos(self.yaw), sin(self.yaw), 0.0])

    @property
    def rotation(self) -> Array:
        """Axes of the wheelset frame as columns (3, 3): yaw about z after roll about x; it does not spin."""
        c, s, cy, sy = cos(self.roll), sin(self.roll), cos(self.yaw), sin(self.yaw)
        return np.array([[cy, -sy * c, sy * s], [sy, cy * c, -cy * s], [0.0, s, c]])


@dataclass(frozen=True)
class Mounting:
    """Positions of the wheels on the axle and of the rails in the track.

    Parameters:
        wheel_y: m, from the wheelset's centre to the wheel's nominal rolling plane.
        rail_y: m, from the track's centre line to the rail's origin, the highest point of the inclined rail.
        radius: m, nominal rolling radius.
    """

    wheel_y: float
    rail_y: float
    radius: float

    def centre(self, state: WheelsetState) -> Array:
        """Wheelset centre (3,) in the track frame, m."""
        return np.array([0.0, state.y, self.radius + state.z])

    def left_pair(self, state: WheelsetState) -> tuple[Pose, RigidMotion]:
        """Pose and velocities of the left pair, in the left rail's frame (parallel to the track frame), eq. (5)."""
        # numbers in place of small arrays, which take twice as long
        shift_y, shift_z = (0.0, 0.0) if state.rail_shift is None else state.rail_shift[0]
        rail_y, rotation = self.rail_y + shift_y, state.rotation
        ax, ay, az = rotation[:, 1].tolist()
        z, out = self.radius + state.z, self.wheel_y
        roll, pitch = state.roll_rate, state.pitch_rate
        wheel = Twist(
            velocity=np.array([0.0, state.y_rate, state.z_rate]),
            rotation=np.array(
                [
                    roll * cos(state.yaw) + pitch * ax,
                    roll * sin(state.yaw) + pitch * ay,
                    state.yaw_rate + pitch * az,
                ]
            ),
            reference=np.array([0.0, state.y - rail_y, z - shift_z]),
        )
        # The rail is at rest in inertial space: in the moving frame it moves backwards and rotates against the frame.
        wx, wy, wz = state.frame_rate
        rail_motion = Twist(
            velocity=np.array([-state.speed, 0.0, 0.0]),
            rotation=np.array([-wx, -wy, -wz]),
            reference=np.array([0.0, -rail_y, -shift_z]),
        )
        origin = np.array([out * ax, state.y + out * ay - rail_y, z + out * az - shift_z])
        return Pose(origin, rotation), RigidMotion(wheel, rail_motion)
