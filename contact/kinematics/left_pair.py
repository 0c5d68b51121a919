"""Compiled: pose and motion of the left-hand pairs of wheelsets, and their derivatives by the wheelsets' states."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

COORDINATES = 9  # of `WheelsetState`, the first of its values
OWN = 15  # values that one pair depends on

Dimensions = tuple[float, float, float]  # m: wheel_y, rail_y and radius of a `Mounting`


class WheelPairs(NamedTuple):
    """Poses and motions of w wheels, each as that of a left-hand pair in the frame of its rail.

    Parameters:
        origin, rotation: (w, 3) m and (w, 3, 3) of the wheels' frames.
        motion: (w, 6, 3), velocities, angular velocities and reference points of wheel and rail, in the order of
            `RigidVelocities`.
        centre: (w, 3) m, reference points of moments.
    """

    origin: Array
    rotation: Array
    motion: Array
    centre: Array

    @classmethod
    def of(cls, pose: Pose, motion: RigidMotion) -> WheelPairs:
        """One pair, with moments about the rail's origin."""
        velocities = np.array([RigidVelocities.of(motion)])
        return cls(pose.origin[None], np.ascontiguousarray(pose.rotation)[None], velocities, np.zeros((1, 3)))

    def pose(self, i: int) -> Pose:
        """Pose of wheel i."""
        return Pose(self.origin[i], self.rotation[i])

    def rigid_motion(self, i: int) -> RigidMotion:
        """Motion of pair i."""
        return RigidMotion(Twist(*self.motion[i, :3]), Twist(*self.motion[i, 3:]))


@compiled
def velocities_of(motion: Array) -> RigidVelocities:
    """Rows (6, 3) of a pair as `RigidVelocities`."""
    return RigidVelocities(motion[0], motion[1], motion[2], motion[3], motion[4], motion[5])


@borrowing
def left_state(values: Array, mirror: bool, own: Array) -> None:
    """Fill what the left-hand pair depends on: 13 values and the displacement y, z m of its rail.

    Parameters:
        values: (17,) of a `WheelsetState`.
        mirror: whether the pair is the mirror image in y = 0 of the right-hand one.
        own: (15,), filled.
    """
    for k in range(OWN):
        own[k] = values[k]
    if mirror:
        for k in (0, 2, 3, 4, 6, 7, 10, 12):
            own[k] = -values[k]
        own[13], own[14] = -values[15], values[16]


@borrowing
def store_left_pair(
    own: Array, dimensions: Dimensions, origin: Array, rotation: Array, motion: Array, centre: Array
) -> None:
    """Fill pose and motion of the left-hand pair, in the left rail's frame (parallel to the track frame), eq. (5).

    Parameters:
        own: (15,) of `left_state`.
        dimensions: of the wheelset and the track.
        origin, rotation, motion, centre: rows of `WheelPairs`, filled; the centre is that of the wheelset.
    """
    wheel_y, rail_y, radius = dimensions
    y, z, roll, yaw = own[0], radius + own[1], own[2], own[3]
    rail_y, rail_z = rail_y + own[13], own[14]
    c, s, cy, sy = np.cos(roll), np.sin(roll), np.cos(yaw), np.sin(yaw)
    rotation[0, 0], rotation[0, 1], rotation[0, 2] = cy, -sy * c, sy * s
    rotation[1, 0], rotation[1, 1], rotation[1, 2] = sy, cy * c, -cy * s
    rotation[2, 0], rotation[2, 1], rotation[2, 2] = 0.0, s, c
    ax, ay, az = rotation[0, 1], rotation[1, 1], rotation[2, 1]
    motion[0, 0], motion[0, 1], motion[0, 2] = 0.0, own[4], own[5]
    motion[1, 0], motion[1, 1], motion[1, 2] = (
        own[6] * cy + own[8] * ax,
        own[6] * sy + own[8] * ay,
        own[7] + own[8] * az,
    )
    centre[0], centre[1], centre[2] = 0.0, y - rail_y, z - rail_z
    motion[2, 0], motion[2, 1], motion[2, 2] = centre[0], centre[1], centre[2]
    # The rail is at rest in inertial space: in the moving frame it moves backwards and rotates against the frame.
    motion[3, 0], motion[3, 1], motion[3, 2] = -own[9], 0.0, 0.0
    motion[4, 0], motion[4, 1], motion[4, 2] = -own[10], -own[11], -own[12]
    motion[5, 0], motion[5, 1], motion[5, 2] = 0.0, -rail_y, -rail_z
    origin[0], origin[1], origin[2] = wheel_y * ax, y + wheel_y * ay - rail_y, z + wheel_y * az - rail_z


@compiled
def left_pairs(states: Array, dimensions: Dimensions, mirror: bool) -> WheelPairs:
    """Pairs of one side of w wheelsets as left-hand ones, with moments about the wheelsets' centres.

    Parameters:
        states: (w, 17), values of `WheelsetState`.
        dimensions: of wheelset and track.
        mirror: whether the side is the right one.
    """
    w, own = len(states), np.empty(OWN)
    pairs = WheelPairs(np.empty((w, 3)), np.empty((w, 3, 3)), np.empty((w, 6, 3)), np.empty((w, 3)))
    for i in range(w):
        left_state(states[i], mirror, own)
        store_left_pair(own, dimensions, pairs.origin[i], pairs.rotation[i], pairs.motion[i], pairs.centre[i])
    return pairs


@borrowing
def pair_slope(own: Array, wheel_y: float, slope: Array) -> None:
    """Fill derivatives (12, 9) of `store_left_pair` by the wheelset's coordinates, rows as in `ContactResult.tangent`.

    Parameters:
        own: (15,) of `left_state`.
        wheel_y: m, from the wheelset's centre to the wheel.
        slope: filled.

    The wheelset rotates about its centre, which remains the reference point of the wheel's motion.
    """
    c, s, cy, sy = np.cos(own[2]), np.sin(own[2]), np.cos(own[3]), np.sin(own[3])
    roll_rate, pitch_rate = own[6], own[8]
    slope[:] = 0.0
    slope[1, 0], slope[2, 1], slope[7, 4], slope[8, 5] = 1.0, 1.0, 1.0, 1.0
    slope[9, 8], slope[10, 8], slope[11, 8] = -sy * c, cy * c, s
    slope[3, 2], slope[4, 2], slope[9, 6], slope[10, 6] = cy, sy, cy, sy  # axis of the roll
    slope[5, 3], slope[11, 7] = 1.0, 1.0
    by_roll, by_yaw = (sy * s, -cy * s, cy * cy * c + sy * sy * c), (-cy * c, -sy * c, 0.0)  # of the axle
    for k in range(3):
        slope[k, 2], slope[k, 3] = wheel_y * by_roll[k], wheel_y * by_yaw[k]
        slope[9 + k, 2], slope[9 + k, 3] = pitch_rate * by_roll[k], pitch_rate * by_yaw[k]
    slope[9, 3] -= roll_rate * sy
    slope[10, 3] += roll_rate * cy


@borrowing
def store_by_state(
    tangent: Array, wrench: Array, own: Array, wheel_y: float, mirror: bool, slope: Array, result: Array
) -> None:
    """Fill derivatives (6, 9) of force and moment by the wheelset's coordinates from those by the wheel's pose.

    Parameters:
        tangent: (6, 12), about the wheelset's centre, of the left-hand pair.
        wrench: (6,) N and N m of the wheel itself.
        own: (15,) of `left_state`.
        wheel_y: m, from the wheelset's centre to the wheel.
        mirror: whether the wheel is the right one: the mirror image of its pair.
        slope: (12, 9), filled.
        result: filled. The centre, about which the moment is, moves with y and z.
    """
    pair_slope(own, wheel_y, slope)
    for r in range(6):
        # of a mirror image change Fy, Mx and Mz, and derivatives by y, roll, yaw and their rates
        odd = mirror and (r == 1 or r == 3 or r == 5)
        for k in range(COORDINATES):
            total = 0.0
            for q in range(12):
                total += tangent[r, q] * slope[q, k]
            even = k == 1 or k == 5 or k == 8
            result[r, k] = -total if odd != (mirror and not even) else total
    x, y, z = wrench[0], wrench[1], wrench[2]
    result[3, 0] -= z  # F x e_y
    result[5, 0] += x
    result[3, 1] += y  # .. and F x e_z
    result[4, 1] -= x


@compiled
def by_states(tangents: Array, wrenches: Array, states: Array, wheel_y: float, mirror: bool) -> Array:
    """Derivatives (w, 6, 9) of forces and moments by coordinates of the wheelsets; parameters of `store_by_state`."""
    result, own, slope = np.empty((len(states), 6, COORDINATES)), np.empty(OWN), np.empty((12, COORDINATES))
    for i in range(len(states)):
        left_state(states[i], mirror, own)
        store_by_state(tangents[i], wrenches[i], own, wheel_y, mirror, slope, result[i])
    return result
