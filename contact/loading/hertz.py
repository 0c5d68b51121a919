"""Pose and approach of a Hertz pair under a load."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from wheelrail.bindings._contact import RTOL
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.loading.load_search import LoadSolution, Results, find_depth_for_load

if TYPE_CHECKING:
    from wheelrail.contact.models.wheelset import ContactModel


def hertz_pose(approach: float) -> Pose:
    """Pose of the upper body at an approach m from first contact."""
    return Pose(np.array([0.0, 0.0, -approach]), np.eye(3))


def hertz_under_load(
    model: ContactModel, motion: RigidMotion, load: float, *, expected: float, rtol: float = RTOL
) -> LoadSolution:
    """Approach (the depth) at which a Hertz pair carries a load.

    Parameters:
        model: contact model of the pair.
        motion: of both bodies.
        load: N.
        expected: m, initial guess of the approach.
        rtol: of the load.

    Raises LoadError.
    """

    def contact_at(depth: float, guess: Results | None) -> Results:
        return (model(hertz_pose(depth), motion, guess[0] if guess else None),)

    return find_depth_for_load(contact_at, load, expected=expected, start=expected, rtol=rtol)
