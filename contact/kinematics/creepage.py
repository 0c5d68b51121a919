"""Rolling speed and rigid creepage at the contact points, eq. (5), or the rigid displacement of a step."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.support.arrays import Array


class NotRolling(ValueError):
    """Steady slip needs bodies that roll forward."""


def creepage(points: SurfacePoints, motion: RigidMotion) -> tuple[float, Array]:
    """Rolling speed V [m/s] and rigid slip over V, (2 n,) longitudinal then lateral.

    V is the mean speed at which both materials flow backwards through the contact. Raises NotRolling unless V > 0.
    """
    wheel, rail = motion.wheel.at(points.point), motion.rail.at(points.point)
    weight = points.overlap * points.area
    flow = ((wheel + rail) / 2 * points.axes[:, 0]).sum(axis=1)
    speed = -float(weight @ flow / weight.sum())
    if not speed > 0:
        raise NotRolling(
            f"friction needs a wheel that rolls forward, but the material flows at {speed:g} m/s; mu = 0 needs none"
        )
    return speed, shift(points, motion) / speed


def shift(points: SurfacePoints, motion: RigidMotion) -> Array:
    """Tangential part of the motion of wheel against rail (2 n,), longitudinal then lateral, in the motion's unit."""
    wheel, rail = motion.wheel.at(points.point), motion.rail.at(points.point)
    return np.asarray(np.einsum("nkc,nc->kn", points.axes[:, :2], wheel - rail).ravel())
