"""Penetration on sampled lines of a yawed wheel, against the largest one on dense places along each line."""

from __future__ import annotations

import numpy as np
import pytest

from wheelrail.bindings._contact import lines_to_scan, scan
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

PAIR = RigidWheelRail(named_profile("S1002"), named_profile("60E1").inclined(0.025), 0.46)
MOUNTING = Mounting(0.75, 0.7605, 0.46)
NEAR, STEP = -1e-3, 5e-4  # m, depths that are compared; spacing of the places


@pytest.mark.parametrize("yaw", [4e-3, 6e-3])
def test_steep_flanges_of_yawed_wheels(yaw: float) -> None:
    """Depths erred by up to 3 mm where closest points and angles in turns did not end, and regions were cut there."""
    pose, _ = MOUNTING.left_pair(WheelsetState(y=8.5e-3, yaw=yaw))
    first, stop = lines_to_scan(PAIR.lines, PAIR.radius, *pose.arrays)
    found = scan(PAIR.rail.shape, PAIR.lines, PAIR.radius, *pose.arrays, (first, stop))
    s = PAIR.lines.s[first:stop]

    def depths(x: Array) -> Array:
        """Depths of places (n, m) m along the lines, minus infinity beside the rail."""
        points, _ = PAIR.at(pose, np.repeat(s, x.shape[1]), x.ravel())
        closest = PAIR.rail.closest(points[:, 1:])
        return np.where(closest.inside, -closest.distance, -np.inf).reshape(x.shape)

    x = np.broadcast_to(np.arange(-0.15, 0.15, STEP), (len(s), 600))
    x = x[0, depths(x).argmax(axis=1)][:, None] + np.linspace(-STEP, STEP, 201)
    expected = depths(x).max(axis=1)
    near = (expected > NEAR) & (found.sample[first:stop] >= 0)
    assert near.sum() > 100
    np.testing.assert_allclose(found.depth[first:stop][near], expected[near], atol=1e-6)
