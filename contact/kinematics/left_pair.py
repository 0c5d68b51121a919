"""Poses and rigid motions as structures of the core, and back."""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import RigidVelocities, WheelPairs
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist

Dimensions = tuple[float, float, float]  # m: wheel_y, rail_y and radius of a `Mounting`


def velocities_of(motion: RigidMotion) -> RigidVelocities:
    """Velocities of a motion."""
    wheel, rail = motion.wheel, motion.rail
    parts = wheel.velocity, wheel.rotation, wheel.reference, rail.velocity, rail.rotation, rail.reference
    return RigidVelocities(*(np.ascontiguousarray(part, dtype=float) for part in parts))


def one_pair(pose: Pose, motion: RigidMotion) -> WheelPairs:
    """One pair, with moments about the rail's origin."""
    wheel, rail = motion.wheel, motion.rail
    rows = wheel.velocity, wheel.rotation, wheel.reference, rail.velocity, rail.rotation, rail.reference
    origin, rotation, plan = pose.arrays
    return WheelPairs(
        origin[None], rotation[None], np.array([rows], dtype=float), np.zeros((1, 3)), np.array([plan], dtype=float)
    )


def pose_of(pairs: WheelPairs, i: int) -> Pose:
    """Pose of wheel i."""
    return Pose(pairs.origin[i], pairs.rotation[i], float(pairs.plan[i]))


def motion_of(pairs: WheelPairs, i: int) -> RigidMotion:
    """Motion of pair i."""
    rows = pairs.motion[i]
    return RigidMotion(Twist(*rows[:3]), Twist(*rows[3:]))
