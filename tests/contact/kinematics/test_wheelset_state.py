"""Kinematics of a wheelset: velocities are the time derivatives of positions, also with yaw."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wheelrail.bindings._contact import by_states
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

MOUNTING = Mounting(wheel_y=0.75, rail_y=0.76, radius=0.46)
STATE = WheelsetState(
    y=0.004,
    z=-2e-4,
    roll=0.02,
    yaw=0.1,
    y_rate=0.03,
    z_rate=-0.02,
    roll_rate=0.2,
    yaw_rate=-0.3,
    pitch_rate=40.0,
    speed=18.0,
    frame_rate=(0.01, 0.02, 0.03),
    rail_shift=((1e-4, -2e-4), (3e-4, 1e-4)),
)


def material_point(time: float, body: Array) -> Array:
    """Place (3,) m of a material point of the wheelset in the left rail's frame, at constant rates from STATE."""
    at = replace(
        STATE,
        **{name: getattr(STATE, name) + time * getattr(STATE, f"{name}_rate") for name in ("y", "z", "roll", "yaw")},
    )
    c, s = np.cos(STATE.pitch_rate * time), np.sin(STATE.pitch_rate * time)
    spun = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]) @ body
    pose, _ = MOUNTING.left_pair(at)
    return np.asarray(pose.origin + at.rotation @ spun)


def test_velocity_of_a_material_point() -> None:
    """Against differences over 2 us of places computed from the three angles."""
    _, motion = MOUNTING.left_pair(STATE)
    for body in np.array([[0.0, 0.0, -0.46], [0.01, 0.03, -0.45], [0.2, -0.7, 0.3]]):
        step = 1e-6
        expected = (material_point(step, body) - material_point(-step, body)) / (2 * step)
        velocity = motion.wheel.at(material_point(0.0, body)[None])[0]
        np.testing.assert_allclose(velocity, expected, rtol=0, atol=1e-8)


def test_derivatives_of_pose_and_motion() -> None:
    """Every column against central differences of `Mounting.left_pair`."""
    states, rows = np.array([STATE.values] * 2), np.eye(12).reshape(2, 6, 12)
    slope = by_states(rows, np.zeros((2, 6)), states, MOUNTING.wheel_y, False).reshape(12, 9)
    pose, motion = MOUNTING.left_pair(STATE)
    for column, name in zip(slope.T, STATE.coordinates, strict=True):
        h = 1e-6
        (after, late), (before, early) = (
            MOUNTING.left_pair(replace(STATE, **{name: getattr(STATE, name) + sign * h})) for sign in (1, -1)
        )
        np.testing.assert_allclose(column[:3], (after.origin - before.origin) / (2 * h), atol=1e-9)
        turned = (after.rotation - before.rotation) / (2 * h) @ pose.rotation.T
        np.testing.assert_allclose(np.cross(column[3:6], np.eye(3)), -turned, atol=1e-9)
        np.testing.assert_allclose(column[6:9], (late.wheel.velocity - early.wheel.velocity) / (2 * h), atol=1e-8)
        np.testing.assert_allclose(column[9:], (late.wheel.rotation - early.wheel.rotation) / (2 * h), atol=1e-7)
        moved = column[:3] + np.cross(column[3:6], motion.wheel.reference - pose.origin)
        np.testing.assert_allclose(moved, (late.wheel.reference - early.wheel.reference) / (2 * h), atol=1e-9)


@pytest.mark.parametrize("side", SIDES)
def test_yaw_rate_and_curvature_of_the_track_are_the_same(side: Side) -> None:
    """A wheelset that yaws on a straight track slips like one at rest in a frame that turns the other way."""

    def slip(state: WheelsetState) -> Array:
        points: list[Array] = []

        def model(pose, motion, guess=None) -> ContactResult:  # type: ignore[no-untyped-def]
            place = np.array([[0.01, 0.002, -0.001], [-0.02, 0.0, 0.001]])
            points.append(motion.wheel.at(place) - motion.rail.at(place))
            return ContactResult.separated()

        WheelsetContact(model, MOUNTING)(state, side)
        return points[0]

    still = WheelsetState(speed=20.0, pitch_rate=20.0 / 0.46)
    np.testing.assert_allclose(
        slip(replace(still, yaw_rate=0.05)), slip(replace(still, frame_rate=(0.0, 0.0, 0.05))), rtol=0, atol=1e-12
    )
