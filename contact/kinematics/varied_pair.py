"""Pose and velocities of a pair and their twelve changes, as complex numbers: derivatives by complex steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.sensitivity import TRANSLATIONS, displacement_derivative, rotation_derivative
from wheelrail.support.arrays import Array

STEP = 1e-30  # of derivatives: exact, as nothing is subtracted


@dataclass(frozen=True, eq=False)
class VariedPair:
    """Pose and velocities of a pair, of several ones in the last dimension.

    Parameters:
        origin: (3, n) m, of the wheel's frame.
        forth, axle, up: (3, n), its axes.
        wheel, rail: velocity, rotation and reference (3, n) of both bodies.
        curvature: of the rail in plan, 1/m, positive to the left.
    """

    origin: Array
    forth: Array
    axle: Array
    up: Array
    wheel: tuple[Array, Array, Array]
    rail: tuple[Array, Array, Array]
    curvature: float

    @classmethod
    def of(cls, pose: Pose, motion: RigidMotion, changes: bool = False) -> VariedPair:
        """A single pair (n = 1), or pairs with the changes of `wheelrail.contact.kinematics.sensitivity` as small
        imaginary parts (n = 12).
        """
        wheel, rail = motion.wheel, motion.rail
        rows = pose.origin, *pose.rotation.T, wheel.velocity, wheel.rotation, wheel.reference
        own = [row[:, None] for row in rows]
        if changes:
            still = np.zeros((6, 3))
            moved = [
                np.concatenate([TRANSLATIONS, still]),
                *(np.concatenate([rotation_derivative(axis[None])[:, 0], still]) for axis in pose.rotation.T),
                np.concatenate([still, TRANSLATIONS]),
                np.concatenate([still, np.roll(TRANSLATIONS, 3, axis=0)]),
                np.concatenate([displacement_derivative((wheel.reference - pose.origin)[None])[:, 0], still]),
            ]
            own = [row + 1j * STEP * change.T for row, change in zip(own, moved, strict=True)]
        rails = (rail.velocity[:, None], rail.rotation[:, None], rail.reference[:, None])
        origin, forth, axle, up, *moves = own
        return cls(origin, forth, axle, up, (moves[0], moves[1], moves[2]), rails, pose.plan)

    def slip(self, point: Array) -> Array:
        """Velocity (3, n) m/s of the wheel's material against the rail's at points (3, n)."""
        wheel, rail = (own[0] + cross(own[1], point - own[2]) for own in (self.wheel, self.rail))
        return np.asarray(wheel - rail)


def dot(a: Array, b: Array) -> Array:
    """Products (n,) of vectors (3, n)."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def cross(a: Array, b: Array) -> Array:
    """Vector products (3, n)."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def unit(a: Array) -> Array:
    """Vectors (3, n) of length 1."""
    return np.asarray(a / np.sqrt(dot(a, a)))
