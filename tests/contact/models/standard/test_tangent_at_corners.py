"""Tangents of the standard contact against differences of its forces where profiles have corners, grooves and ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from grooved_rails import grooved
from test_tangent import nudged

import wheelrail as wr
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array

STEPS = np.repeat([2e-8, 4e-8, 1e-5, 2e-5], 3)
MOVING = WheelsetState(speed=20.0, pitch_rate=20.05 / 0.46, y_rate=0.01)


def cut(folder: Path, degrees: float, end: float = -30e-3) -> Profile:
    """60E1 with a straight face, down to an end m, in place of its gauge corner: a corner where the face begins."""
    head, t = named_profile("60E1"), np.radians(degrees)
    points = head.point(head.samples(2e-4))
    points = points[points[:, 0] >= -26e-3]
    away = np.arange(4e-4, (points[0, 1] - end) / np.sin(t), 4e-4)[::-1, None]
    file = folder / f"cut_{degrees:g}_{1e3 * end:g}.txt"
    np.savetxt(file, 1e3 * np.concatenate([points[0] - away * (np.cos(t), np.sin(t)), points]), fmt="%.6f")
    return wr.profile(file, "rail", noise=0.0, mirror=False).inclined(0.025)


RAILS: dict[str, Callable[[Path], Profile]] = {
    "head": lambda _: named_profile("60E1").inclined(0.025),
    "groove": lambda folder: grooved(folder, 33e-3, 42e-3),
    "sharp": lambda folder: cut(folder, 80.0),
    "end": lambda folder: cut(folder, 60.0, -15e-3),
}


def pressed(model: StandardContact, mounting: Mounting, state: WheelsetState, depth: float) -> tuple[Pose, RigidMotion]:
    """Pose and motion at a height where the wheel overlaps the rail by some depth m."""
    assert isinstance(model.surfaces, RigidWheelRail)
    high, low = 0.05, -0.05
    while high - low > 1e-10:
        z = 0.5 * (high + low)
        apart = model.surfaces.approach(mounting.left_pair(replace(state, z=z))[0]) < 0.0
        high, low = (z, low) if apart else (high, z)
    return mounting.left_pair(replace(state, z=high - depth))


def load(model: StandardContact, pose: Pose, motion: RigidMotion) -> Array:
    result = model(pose, motion)
    assert result.ok, result.status
    return np.concatenate([result.force, result.moment])


def errors(model: StandardContact, pose: Pose, motion: RigidMotion) -> Array:
    """Error (12,) of the columns over the largest number with the same units in each row, at least 2 % of that in all;
    NaN where differences of two lengths disagree: forces bend in between, as cells begin to slide.
    """
    tangent = model(pose, motion).tangent()
    quotients = np.empty((2, 6, 12))
    for j, step in enumerate(STEPS):
        for k, length in enumerate((step, 0.25 * step)):
            change = length * np.eye(12)[j]
            there, back = (load(model, *nudged(pose, motion, way * change)) for way in (1.0, -1.0))
            quotients[k, :, j] = (there - back) / (2.0 * length)
    size = np.abs(quotients[1]).reshape(2, 3, 4, 3)
    own = np.maximum(size.max(axis=3), 0.02 * size.max(axis=(1, 3))[:, None] + 1e-9)
    off = np.abs([tangent - quotients[1], quotients[0] - quotients[1]]).reshape(2, 2, 3, 4, 3) / own[..., None]
    error, spread = off.reshape(2, 6, 12).max(axis=1)
    return np.where(spread < 1e-3, error, np.nan)


# lateral position mm, yaw rad, overlap m: the wheel's chamfer on the head and on a check rail, a corner of the rail in
# the root of the flange and on its face, near an end of the rail
PLACES = {
    "head": [(-69.6, 0.0, 1e-5), (-69.5, 1e-3, 3e-5), (-71.0, 0.0, 1e-4), (5.9, -4e-3, 6e-5)],
    "groove": [(-71.0, 0.0, 1e-4), (-69.6, 0.0, 1e-5)],
    "sharp": [(9.3, 1e-3, 1e-5), (6.5, -4e-3, 1e-4), (8.1, 1e-3, 1e-4), (1.8, 1e-3, 1e-5), (7.8, 1e-3, 6e-5)],
    "end": [(7.1, -4e-3, 3e-5), (6.0, -4e-3, 1e-5), (1.2, -4e-3, 6e-5), (2.8, 0.0, 6e-5), (4.5, 2e-2, 3e-5)],
}


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("rail", PLACES)
def test_tangents_are_derivatives_at_corners(tmp_path: Path, rail: str, friction: float) -> None:
    """Before, off by up to 18 times the row at the wheel's chamfer, 32 times at corners of the rail."""
    profile = RAILS[rail](tmp_path)
    model = StandardContact(RigidWheelRail(named_profile("S1002"), profile, 0.46), ContactLaws(friction=friction))
    mounting = Mounting(0.75, profile.gauge_offset(1.435, 0.014), 0.46)
    found = []
    for y, yaw, depth in PLACES[rail]:
        found.append(errors(model, *pressed(model, mounting, replace(MOVING, y=1e-3 * y, yaw=yaw), depth)))
    assert np.isfinite(found).mean() > 0.9
    np.testing.assert_array_less(np.nanmax(found, axis=1), 1e-3)
