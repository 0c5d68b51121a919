"""Rigid profiles of wheel and rail in a track, and their outlines at first contact."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.wheelset_state import Mounting
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.support.arrays import Array

OUTLINE = 2e-4  # m, spacing of the points of a plotted profile


@dataclass(frozen=True)
class MountedPair:
    """Rigid left-hand pair of profiles, the rail inclined, and its mounting."""

    rigid: RigidWheelRail
    mounting: Mounting


def mounted_pair(
    wheel: str | Path | Profile = "S1002", rail: str | Path | Profile = "UIC60", **more: Any
) -> MountedPair:
    """Profiles of a wheelset on its track, alike on both sides; arguments as for `wheelrail.Wheelset`.

    Raises SceneError for left and right.
    """
    for side in more.keys() & {"left", "right"}:
        raise SceneError(f"{side}: must be left out: contact geometry is for two sides that are alike")
    from wheelrail.api.wheelset import Wheelset

    wheelset = Wheelset(wheel, rail, friction=0.0, model="standard", **more)
    return MountedPair(RigidWheelRail(*wheelset.profiles, wheelset.arguments["radius"]), wheelset.mounting)


def contact_values(pair: MountedPair, touch: Any, hand: float) -> dict[str, float]:
    """Rolling radius, contact angle and positions of a contact point; hand is -1 for a mirrored right-hand pair."""
    (wheel_y, wheel_z), rail_y = pair.rigid.wheel.point(touch.wheel_s), pair.rigid.rail.point(touch.rail_s)[0]
    return {
        "rolling_radius": pair.rigid.radius + float(wheel_z),
        "contact_angle": hand * float(np.arctan2(-touch.normal[1], touch.normal[2])),
        "wheel_s": touch.wheel_s,
        "wheel_y": float(wheel_y),
        "rail_s": touch.rail_s,
        "rail_y": float(rail_y),
        "contact_x": float(touch.point[0]),
    }


def outlines_in_contact(pair: MountedPair, y: float, yaw: float) -> tuple[Array, Array, Array, float]:
    """Outlines of the left wheel (its lowest line) and rail at first contact with both rails.

    Parameters:
        pair: profiles and mounting.
        y: lateral position of the wheelset, m.
        yaw: of the wheelset, rad.

    Returns wheel and rail (n, 2), m, contact point (2,), m, in the frame of the rail, and contact angle, rad.
    """
    from wheelrail.contact.geometry.first_contact import first_contacts_over

    (((state, touches)),) = first_contacts_over(pair.rigid, pair.mounting, np.array([y]), yaw)
    pose, _ = pair.mounting.left_pair(state)
    wheel, rail = (profile.point(profile.samples(OUTLINE)) for profile in (pair.rigid.wheel, pair.rigid.rail))
    lowest = np.column_stack([np.zeros(len(wheel)), wheel[:, 0], -(pair.rigid.radius + wheel[:, 1])])
    wheel_outline = (lowest @ pose.rotation.T + pose.origin)[:, 1:]
    return wheel_outline, rail, touches["left"].point[1:], contact_values(pair, touches["left"], 1.0)["contact_angle"]
