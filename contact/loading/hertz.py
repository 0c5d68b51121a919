"""Pose and approach of a Hertz pair that carries a load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.loading.load_search import (
    RTOL,
    LoadSolution,
    Results,
    find_depth_for_load,
)

if TYPE_CHECKING:
    from wheelrail.contact.models.wheelset import ContactModel


def sphere_approach(load: float, *, radius: float, modulus: float) -> float:
    """Approach m of a sphere on a plane, Hertz: the scale on which to look for a load N.

    modulus Pa is the contact modulus E*, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2.
    """
    return float((9.0 * load**2 / (16.0 * modulus**2 * radius)) ** (1.0 / 3.0))


def hertz_pose(approach: float) -> Pose:
    """Pose of the upper body after an approach m from first touch."""
    return Pose(np.array([0.0, 0.0, -approach]), np.eye(3))


def hertz_under_load(
    model: ContactModel, motion: RigidMotion, load: float, *, expected: float, rtol: float = RTOL
) -> LoadSolution:
    """Approach (the depth) at which a Hertz pair carries the load N, starting from the expected approach m."""

    def lowered(depth: float, guess: Results | None) -> Results:
        return (model(hertz_pose(depth), motion, guess[0] if guess else None),)

    return find_depth_for_load(lowered, load, expected=expected, start=expected, rtol=rtol)
