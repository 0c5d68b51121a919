"""State of a wheelset in the track frame, and the pose and motion of its left-hand pair."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin
from typing import ClassVar, TypeVar

import numpy as np

from wheelrail.bindings._contact import left_pairs
from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Side
from wheelrail.contact.kinematics.left_pair import motion_of, pose_of
from wheelrail.support.arrays import Array

RailShift = tuple[tuple[float, float], tuple[float, float]]
NO_SHIFT: RailShift = ((0.0, 0.0), (0.0, 0.0))
T = TypeVar("T", bound="WheelsetState")


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
        wheelset: its name in the vehicle, by which contacts may differ.
        friction: factor on the coefficient of friction, as of a wet section of the track.
        twist_rate: rad/s, half the spin of the left wheel less that of the right one; `pitch_rate` is their mean.

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
    wheelset: str = ""
    friction: float = 1.0
    twist_rate: float = 0.0

    def turning_as(self: T, side: Side) -> T:
        """The state of a rigid wheelset with the spin of the wheel of one side."""
        if self.twist_rate == 0.0:
            return self
        twist = self.twist_rate if side == "left" else -self.twist_rate
        return changed(self, pitch_rate=self.pitch_rate + twist, twist_rate=0.0)

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
            twist_rate=-self.twist_rate,
            rail_shift=shift and ((-shift[1][0], shift[1][1]), (-shift[0][0], shift[0][1])),
        )

    @property
    def values(self) -> tuple[float, ...]:
        """The coordinates, the speed, the frame's angular velocity, and the displacements of both rails, (17,)."""
        (left_y, left_z), (right_y, right_z) = self.rail_shift or NO_SHIFT
        return (
            *(self.y, self.z, self.roll, self.yaw),
            *(self.y_rate, self.z_rate, self.roll_rate, self.yaw_rate, self.pitch_rate),
            *(self.speed, *self.frame_rate),
            *(left_y, left_z, right_y, right_z),
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

    @property
    def dimensions(self) -> tuple[float, float, float]:
        """Arguments of functions of the core, m."""
        return float(self.wheel_y), float(self.rail_y), float(self.radius)

    def left_pair(self, state: WheelsetState) -> tuple[Pose, RigidMotion]:
        """Pose and velocities of the left pair, in the left rail's frame (parallel to the track frame), eq. (5)."""
        pairs = left_pairs(np.array([state.values]), self.dimensions, False)
        return pose_of(pairs, 0), motion_of(pairs, 0)


EVEN = ("z", "z_rate", "pitch_rate")  # unchanged in the mirror y = 0
STATE_MIRRORED = np.array([1.0 if name in EVEN else -1.0 for name in WheelsetState.coordinates])
