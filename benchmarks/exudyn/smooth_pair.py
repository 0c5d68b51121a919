"""A smooth law of contact, for pairs of this package and for any axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class SmoothLaw:
    """Force at the lowest point of a conical wheel: linear springs upwards and across, creep forces that saturate.

    Parameters:
        radius, conicity: m at the nominal place, and its growth outwards.
        load: N, there.
        vertical, lateral: N/m.
        creep: N.
        friction: coefficient of the load.
        speed: m/s, that slips are divided by.
    """

    radius: float = 0.46
    conicity: float = 0.05
    load: float = 54546.0
    vertical: float = 2.0e8
    lateral: float = 2.0e5
    creep: float = 8.0e6
    friction: float = 0.3
    speed: float = 25.0

    def point(self, origin: Array, up: Array, across: float) -> Array:
        """Lowest point (3,) m of a wheel at its origin, with its axis upwards, outwards by m from the nominal place."""
        return np.asarray(origin - (self.radius + self.conicity * across) * up)

    def force(self, across: float, height: float, slip: Array) -> Array:
        """Force (3,) N in the axes of the rail, outwards positive; slip (2,) m/s of the wheel on the rail."""
        creepage = slip / self.speed
        bound = self.friction * self.load
        tangential = -self.creep * creepage / np.sqrt(1.0 + (self.creep / bound) ** 2 * (creepage @ creepage))
        normal = self.load - self.vertical * height
        return np.array([tangential[0], tangential[1] - self.lateral * across, normal])


@dataclass(frozen=True)
class SmoothPair:
    """The law as a contact model of left-hand pairs; nominal: m, lateral place of the wheel in the rail's frame."""

    law: SmoothLaw
    nominal: float

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        across = float(pose.origin[1] - self.nominal)
        point = self.law.point(pose.origin, pose.rotation[:, 2], across)
        velocities = [
            twist.velocity + np.cross(twist.rotation, point - twist.reference) for twist in (motion.wheel, motion.rail)
        ]
        force = self.law.force(across, float(point[2]), (velocities[0] - velocities[1])[:2])
        return ContactResult(force, np.cross(point, force), status="converged")
