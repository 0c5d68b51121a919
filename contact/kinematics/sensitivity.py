"""How contact points, their overlap and their rigid slip follow the wheel's frame and its motion, to first order.

Twelve changes, in this order: translation (3) [m] of the wheel's frame and rotation (3) [rad] about its origin, with
which the motion's reference point moves, too; velocity (3) [m/s] and rotation rate (3) [rad/s] of the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.meshes.curves.curve import Curve
from wheelrail.support.arrays import Array

SHIFT = np.vstack([np.eye(3), np.zeros((3, 3))])  # translation in each of the six rigid changes


def skew(rotation: Array) -> Array:
    """Matrix of the cross product with a vector (3,) from the left."""
    x, y, z = rotation
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


TURN = np.concatenate([np.zeros((3, 3, 3)), [skew(e) for e in np.eye(3)]])  # matrix of the rotation in each


def turned(vectors: Array) -> Array:
    """Change (6, n, 3) of vectors (n, 3) that turn with a body."""
    return np.asarray(vectors @ TURN.transpose(0, 2, 1))


def carried(arms: Array) -> Array:
    """Change (6, n, 3) of points of a body from their distances (n, 3) m to the point it is turned about."""
    return np.asarray(turned(arms) + SHIFT[:, None])


@dataclass(frozen=True)
class WheelPointSensitivity:
    """Points of a wheel above the section of a rail: they move with the wheel, the foot slides along the rail."""

    rail: Curve
    rides: bool = True

    @classmethod
    def of(cls, rail: Curve) -> WheelPointSensitivity:
        """By a bare copy of the rail's curve, without what it remembers."""
        return cls(Curve(rail.breaks, rail.coefficients))

    def overlap(self, places: SurfacePoints, origin: Array) -> Array:
        """Change (6, n) of the overlap (x - r) n_wheel: the foot's tangential part falls out of the point's way."""
        s, wheel = places.rail_place[:, 0], places.axes[:, 2, 1:]
        normal = self.rail.normal(s)
        tangent = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
        height = ((places.point[:, 1:] - self.rail.point(s)) * normal).sum(axis=1)  # negative inside
        along = (tangent * wheel).sum(axis=1) / (1 + self.rail.curvature(s) * height)
        way = carried(places.point - origin)[:, :, 1:]
        normals = turned(places.axes[:, 2])[:, :, 1:]
        return np.asarray((way * (wheel - along[:, None] * tangent) + normals * (height[:, None] * normal)).sum(axis=2))


@dataclass(frozen=True)
class QuadricSensitivity:
    """Points at rest under the paraboloid of an upper body with radii [m], which the pose moves and does not turn."""

    radii: tuple[float, float]
    rides: bool = False

    def overlap(self, places: SurfacePoints, origin: Array) -> Array:
        """Change (6, n) of the overlap -Z - (x - X)^2 / 2 R_x - (y - Y)^2 / 2 R_y - .."""
        change = np.zeros((6, len(places.point)))
        change[:2] = ((places.point - origin)[:, :2] / self.radii).T
        change[2] = -1.0
        return change


def rigid_slip(places: SurfacePoints, origin: Array, motion: RigidMotion, overlap: Array) -> tuple[Array, Array]:
    """Change (12, 2 n) of what `wheelrail.contact.kinematics.creepage.shift` gives, and (12,) of the rolling speed of
    `creepage`.

    overlap (6, n) is its change: the speed is a mean weighted by it.
    """
    assert places.follows is not None
    wheel, rail, axes = motion.wheel, motion.rail, places.axes[:, :2]
    rides = float(places.follows.rides)
    way = rides * carried(places.point - origin)
    reference = carried((wheel.reference - origin)[None])
    upper = np.concatenate([(way - reference) @ skew(wheel.rotation).T, carried(places.point - wheel.reference)])
    lower = np.concatenate([way @ skew(rail.rotation).T, np.zeros_like(way)])
    above, below = (body.velocity + (places.point - body.reference) @ skew(body.rotation).T for body in (wheel, rail))
    shift = np.einsum("nkc,jnc->jkn", axes, upper - lower)
    flow = np.einsum("nc,jnc->jn", axes[:, 0], 0.5 * (upper + lower))
    if rides:
        turn = np.stack([turned(axes[:, k]) for k in (0, 1)], axis=1)
        shift[:6] += np.einsum("jknc,nc->jkn", turn, above - below)
        flow[:6] += np.einsum("jnc,nc->jn", turn[:, 0], 0.5 * (above + below))
    weight = places.overlap * places.area
    forward = (0.5 * (above + below) * axes[:, 0]).sum(axis=1)
    total = weight.sum()
    speed = -flow @ weight / total
    speed[:6] -= overlap @ (places.area * (forward - weight @ forward / total)) / total
    return shift.reshape(12, -1), speed
