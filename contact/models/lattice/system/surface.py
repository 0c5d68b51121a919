"""Undeformed surfaces of a pair, and a pose and a motion, as structures of the core."""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import Motion, Shape, SurfaceData, VelocityField
from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips, QuadricStrips, StripSurfaces
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist

NO_SHAPE = Shape(
    np.zeros(2),
    np.zeros(1),
    np.zeros((1, 3, 8), dtype=complex),
    np.zeros(1),
    np.zeros(1, dtype=complex),
    False,
    np.zeros(0),
)


def surface_data(surfaces: StripSurfaces) -> SurfaceData:
    """Data of profiles or quadrics."""
    if isinstance(surfaces, ProfileStrips):
        none = np.zeros(2)
        return SurfaceData(True, surfaces.wheel.shape, surfaces.rail.shape, surfaces.radius, none, none)
    assert isinstance(surfaces, QuadricStrips)
    quadrics = (np.array(curvature(radii), dtype=float) for radii in (surfaces.upper, surfaces.lower))
    return SurfaceData(False, NO_SHAPE, NO_SHAPE, 1.0, *quadrics)


def motion_data(pose: Pose, motion: RigidMotion, speed: float) -> Motion:
    """Data of a pose and a motion."""
    return Motion(*pose.arrays, _field(motion.wheel), _field(motion.rail), speed)


def _field(body: Twist) -> VelocityField:
    parts = body.velocity, body.rotation, body.reference
    return VelocityField(*(np.ascontiguousarray(part, dtype=float) for part in parts))
