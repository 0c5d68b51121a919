"""Rigid profiles of wheel and rail in a track, and their outlines at first contact."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from wheelrail.contact.geometry.first_contact import FirstContact, RigidWheelset, first_contacts_over
from wheelrail.contact.kinematics.frames import Side
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

OUTLINE = 2e-4  # m, spacing of the points of a plotted profile


def rigid_wheelset(
    wheel: str | Path | Profile = "S1002", rail: str | Path | Profile = "UIC60", **more: Any
) -> RigidWheelset:
    """Profiles of a wheelset on its track; arguments as for `wheelrail.Wheelset`. Raises SceneError."""
    from wheelrail.api.wheelset import Wheelset

    return Wheelset(wheel, rail, friction=0.0, model="standard", **more).rigid


def contact_values(wheelset: RigidWheelset, touch: FirstContact, side: Side) -> dict[str, float]:
    """Rolling radius, contact angle and positions of a contact point of one side."""
    pair, hand = wheelset.on(side).pair, -1.0 if side == "right" else 1.0
    (wheel_y, wheel_z), rail_y = pair.wheel.point(touch.wheel_s), pair.rail.point(touch.rail_s)[0]
    return {
        "rolling_radius": pair.radius + float(wheel_z),
        "contact_angle": hand * float(np.arctan2(-touch.normal[1], touch.normal[2])),
        "wheel_s": touch.wheel_s,
        "wheel_y": float(wheel_y),
        "rail_s": touch.rail_s,
        "rail_y": float(rail_y),
        "contact_x": float(touch.point[0]),
    }


def outlines_in_contact(wheelset: RigidWheelset, y: float, yaw: float) -> tuple[Array, Array, Array, float]:
    """Outlines of the left wheel (its lowest line) and rail at first contact with both rails.

    Parameters:
        wheelset: profiles and mounting.
        y: lateral position of the wheelset, m.
        yaw: of the wheelset, rad.

    Returns wheel and rail (n, 2), m, contact point (2,), m, in the frame of the rail, and contact angle, rad.
    """
    (((state, touches)),) = first_contacts_over(wheelset, np.array([y]), yaw)
    pair = wheelset.pair
    pose, _ = wheelset.mounting.left_pair(state)
    wheel, rail = (profile.point(profile.samples(OUTLINE)) for profile in (pair.wheel, pair.rail))
    lowest = np.column_stack([np.zeros(len(wheel)), wheel[:, 0], -(pair.radius + wheel[:, 1])])
    wheel_outline = (lowest @ pose.rotation.T + pose.origin)[:, 1:]
    return (
        wheel_outline,
        rail,
        touches["left"].point[1:],
        contact_values(wheelset, touches["left"], "left")["contact_angle"],
    )
