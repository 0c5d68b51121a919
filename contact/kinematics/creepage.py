"""Rolling speed and rigid creepage at the contact points, eq. (5), or the rigid tangential displacement.

Where the surfaces touch, their relative velocity has no component along the normal, and its component along any
direction near the tangent is the slip. The rigid part alone does have one, and is projected as the elastic part is.
Grids take differences of displacements, as vectors, along the wheel's axes at each point. Strips have the displacement
of each body in the body's own axes; there the velocity of the wheel counts along its circle, that of the rail along its
surface. With the wheel's tangent for both, points at x from the lowest one would creep by -x^2 / (2 R^2), which is
8.5e-5 at 6 mm.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.support.arrays import Array


class NotRolling(ValueError):
    """Steady slip is defined for bodies that roll forward only."""


def creepage(points: SurfacePoints, motion: RigidMotion) -> tuple[float, Array]:
    """Rolling speed V [m/s] and rigid slip over V (2 n,), longitudinal then lateral.

    Parameters:
        points: n contact points; V is the mean over them, weighted by penetration and area, of the speed at which both
            materials flow backwards through the contact.
        motion: of both bodies.

    Raises NotRolling unless V > 0.
    """
    wheel, rail = motion.wheel.at(points.point), motion.rail.at(points.point)
    weight = points.penetration * points.area
    flow = ((wheel + rail) / 2 * points.axes[:, 0]).sum(axis=1)
    speed = -float(weight @ flow / weight.sum())
    if not speed > 0:
        raise NotRolling(
            f"friction needs a wheel that rolls forward, but the material flows at {speed:g} m/s; mu = 0 needs none"
        )
    return speed, shift(points, motion) / speed


def shift(points: SurfacePoints, motion: RigidMotion) -> Array:
    """Rigid tangential motion (2 n,) of wheel relative to rail, longitudinal then lateral, in the motion's unit.

    Parameters as for `creepage`.
    """
    wheel, rail = motion.wheel.at(points.point), motion.rail.at(points.point)
    return np.asarray(np.einsum("nkc,nc->kn", points.axes[:, :2], wheel - rail).ravel())
