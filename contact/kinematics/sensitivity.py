"""Derivatives of contact points, their penetration and their rigid slip by the wheel's pose and motion.

Twelve changes, in this order: translation (3) [m] of the wheel's frame and rotation (3) [rad] about its origin, both of
which also move the motion's reference point; velocity (3) [m/s] and rotation rate (3) [rad/s] of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.meshes.curves.curve import Curve
from wheelrail.support.arrays import Array

TRANSLATIONS = np.vstack([np.eye(3), np.zeros((3, 3))])  # translation in each of the six rigid changes


def skew(rotation: Array) -> Array:
    """Matrix (3, 3) of the cross product with a vector (3,) from the left."""
    x, y, z = rotation
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


ROTATIONS = np.concatenate(
    [np.zeros((3, 3, 3)), [skew(e) for e in np.eye(3)]]
)  # matrix of the rotation in each of the six


def rotation_derivative(vectors: Array) -> Array:
    """Derivative (6, n, 3) of vectors (n, 3) that rotate with a body."""
    return np.asarray(vectors @ ROTATIONS.transpose(0, 2, 1))


def displacement_derivative(arms: Array) -> Array:
    """Derivative (6, n, 3) of points of a body from their distances (n, 3) m to the centre of rotation."""
    return np.asarray(rotation_derivative(arms) + TRANSLATIONS[:, None])


@dataclass(frozen=True)
class WheelPointSensitivity:
    """Sensitivity of points of a wheel above a rail: they move with the wheel, their projections along the rail.

    Parameters:
        rail: curve of the rail's profile.
        moves_with_wheel: whether the points move with the wheel.
        plan: 1/m, curvature of the rail in plan.
    """

    rail: Curve
    moves_with_wheel: bool = True
    plan: float = 0.0

    @classmethod
    def of(cls, rail: Curve) -> WheelPointSensitivity:
        """Sensitivity with a copy of the rail's curve without its cached values."""
        return cls(Curve(rail.breaks, rail.coefficients))

    def penetration(self, points: SurfacePoints, origin: Array) -> Array:
        """Derivative (6, n) of the penetration (x - r) n_wheel; the projection moves in the rail's tangent only."""
        s, wheel = points.rail_place[:, 0], points.axes[:, 2, 1:]
        normal = self.rail.normal(s)
        tangent = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
        x, shear = points.point[:, :1], np.array([0.5 * self.plan, 0.0])
        height = ((points.point[:, 1:] - shear * x**2 - self.rail.point(s)) * normal).sum(axis=1)  # negative inside
        along = (tangent * wheel).sum(axis=1) / (1 + self.rail.curvature(s) * height)
        moved = displacement_derivative(points.point - origin)
        displacement = moved[:, :, 1:] - 2.0 * shear * x * moved[:, :, :1]
        normal_change = rotation_derivative(points.axes[:, 2])[:, :, 1:]
        return np.asarray(
            (displacement * (wheel - along[:, None] * tangent) + normal_change * (height[:, None] * normal)).sum(axis=2)
        )


@dataclass(frozen=True)
class QuadricSensitivity:
    """Sensitivity of fixed points below the paraboloid of an upper body, whose pose does not rotate.

    Parameters:
        radii: principal radii of the upper body in x and y, m.
        moves_with_wheel: whether the points move with the body.
    """

    radii: tuple[float, float]
    moves_with_wheel: bool = False

    def penetration(self, points: SurfacePoints, origin: Array) -> Array:
        """Derivative (6, n) of the penetration -Z - (x - X)^2 / 2 R_x - (y - Y)^2 / 2 R_y - .."""
        change = np.zeros((6, len(points.point)))
        change[:2] = ((points.point - origin)[:, :2] / self.radii).T
        change[2] = -1.0
        return change


def rigid_slip(points: SurfacePoints, origin: Array, motion: RigidMotion, penetration: Array) -> tuple[Array, Array]:
    """Derivatives (12, 2 n) of `wheelrail.contact.kinematics.creepage.shift`, and (12,) of the speed of `creepage`.

    Parameters:
        points: n contact points.
        origin: (3,) m of the wheel's frame.
        motion: of both bodies.
        penetration: (6, n), derivative of the penetration, by which the speed is weighted.
    """
    assert points.sensitivity is not None
    wheel, rail, axes = motion.wheel, motion.rail, points.axes[:, :2]
    moves = float(points.sensitivity.moves_with_wheel)
    displacement = moves * displacement_derivative(points.point - origin)
    reference = displacement_derivative((wheel.reference - origin)[None])
    wheel_change = np.concatenate(
        [(displacement - reference) @ skew(wheel.rotation).T, displacement_derivative(points.point - wheel.reference)]
    )
    rail_change = np.concatenate([displacement @ skew(rail.rotation).T, np.zeros_like(displacement)])
    wheel_velocity, rail_velocity = (
        body.velocity + (points.point - body.reference) @ skew(body.rotation).T for body in (wheel, rail)
    )
    shift = np.einsum("nkc,jnc->jkn", axes, wheel_change - rail_change)
    flow = np.einsum("nc,jnc->jn", axes[:, 0], 0.5 * (wheel_change + rail_change))
    if moves:
        axes_change = np.stack([rotation_derivative(axes[:, k]) for k in (0, 1)], axis=1)
        shift[:6] += np.einsum("jknc,nc->jkn", axes_change, wheel_velocity - rail_velocity)
        flow[:6] += np.einsum("jnc,nc->jn", axes_change[:, 0], 0.5 * (wheel_velocity + rail_velocity))
    weight = points.penetration * points.area
    forward = (0.5 * (wheel_velocity + rail_velocity) * axes[:, 0]).sum(axis=1)
    total = weight.sum()
    speed = -flow @ weight / total
    speed[:6] -= penetration @ (points.area * (forward - weight @ forward / total)) / total
    return shift.reshape(12, -1), speed
