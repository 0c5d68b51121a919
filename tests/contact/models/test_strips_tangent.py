"""The tangent on strips of a Hertz pair and of both wheels, against differences of the forces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_strips import LOAD, exact, flowing, pair, wheelset
from test_tangent import STATES, nudged

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.support.arrays import Array

FINE = LatticeResolution(10, 9)
STIFFNESS = 1.5 * LOAD / exact().approach  # of Hertz's contact
CREEP = flowing(4e-4, 2e-4, 0.1)  # 85 % of the patch sticks


def settled(model: LatticeContact) -> LatticeContact:
    return replace(model, tolerance=1e-8)


def slope(contact: LatticeContact, column: int, step: float) -> Array:
    pose = hertz_pose(exact().approach)
    change = step * np.eye(12)[column]
    there, back = (contact(*nudged(pose, CREEP, sign * change), None) for sign in (1, -1))
    return np.asarray((there.force - back.force) / (2 * step))


def test_hertz() -> None:
    contact = settled(pair(0.3, resolution=FINE))
    result = contact(hertz_pose(exact().approach), CREEP, None)
    tangent = result.tangent()
    assert -tangent[2, 2] == pytest.approx(STIFFNESS, rel=0.02)
    # forces by the approach: the leading ends move, and traction with them
    deeper = slope(contact, 2, 1e-6)
    np.testing.assert_allclose(tangent[:3, 2], deeper, atol=0.01 * STIFFNESS)
    for column, step in ((6, 2e-5), (7, 2e-5), (11, 2e-3)):
        expected = slope(contact, column, step)
        np.testing.assert_allclose(tangent[:3, column], expected, atol=0.015 * np.abs(expected).max())


@pytest.mark.parametrize("side", SIDES)
def test_wheelset(side: Side) -> None:
    model = wheelset(0.3)
    assert isinstance(model.model, LatticeContact)
    contact = WheelsetContact(settled(replace(model.model, resolution=FINE)), model.mounting)
    state = WheelsetState(
        y=2e-3, z=-2.5e-4, roll=2e-5, yaw=1e-3, y_rate=5e-3, speed=20.0, pitch_rate=20 / 0.46 * 1.0005
    )
    tangent = contact.tangent(state, side, contact(state, side))
    steps = (2e-6, 2e-7, 1e-6, 1e-6, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3)
    for j, (name, step) in enumerate(zip(STATES, steps, strict=True)):
        ends = [contact(replace(state, **{name: getattr(state, name) + sign * step}), side) for sign in (1, -1)]
        there, back = (np.concatenate([end.force, end.moment]) for end in ends)
        expected = (there - back) / (2 * step)
        for rows in (slice(0, 3), slice(3, 6)):
            scale = np.abs(expected[rows]).max()
            np.testing.assert_allclose(tangent[rows, j], expected[rows], atol=0.04 * scale)
