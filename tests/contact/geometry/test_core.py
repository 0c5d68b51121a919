"""Surfaces of a pair in the core: derivatives by the pose, and arrays that do not fit."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from wheelrail.bindings import _contact as core
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips, QuadricStrips, StripSurfaces
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.models.lattice.system.surface import motion_data, surface_data
from wheelrail.meshes.profiles.named import named_profile
from wheelrail.support.arrays import Array

WHEEL, RAIL, RADIUS = named_profile("S1002"), named_profile("60E1").inclined(0.025), 0.46
AT_REST = Twist(np.zeros(3), np.zeros(3), np.zeros(3))
PROFILES = ProfileStrips(WHEEL, RAIL, RADIUS)
QUADRICS = QuadricStrips((0.4, 0.5), (1.2, 0.3), 5e-3, (1e-3, 1e-3))


def pose(surfaces: StripSurfaces) -> Pose:
    if surfaces is QUADRICS:
        return Pose(np.array([2e-4, 1e-4, -1e-4]), np.eye(3))
    return Mounting(0.75, 0.7605, RADIUS).left_pair(WheelsetState(y=3e-3, z=-1e-4, roll=2e-3, yaw=0.01))[0]


def moved(place: Pose, motion: int, step: float) -> Pose:
    """The pose after a translation m along, or a rotation rad about, an axis of space through its origin."""
    way = step * np.eye(6)[motion]
    x, y, z = way[3:]
    spin = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return Pose(place.origin + way[:3], (np.eye(3) + spin + 0.5 * spin @ spin) @ place.rotation)


@pytest.mark.parametrize("surfaces", [PROFILES, QUADRICS])
def test_derivatives_by_the_pose(surfaces: StripSurfaces) -> None:
    """Places of the largest penetration of lines and closest points there, and the penetration along x."""
    data, place, h = surface_data(surfaces), pose(surfaces), 1e-7
    lines = np.linspace(-5e-3, 5e-3, 11)
    s, x = (grid.ravel() for grid in np.meshgrid(lines, np.linspace(-4e-3, 4e-3, 5), indexing="ij"))
    found, at, _ = core.crests(data, *place.arrays, lines)
    motion = motion_data(place, RigidMotion(AT_REST, AT_REST), 0.0)
    crest, foot = core.touching_changes(data, motion, lines, at, found.foot)
    for k in range(6 if surfaces is PROFILES else 3):
        ahead, behind = (moved(place, k, way * h) for way in (1, -1))

        def difference(of, ahead: Pose = ahead, behind: Pose = behind) -> Array:  # type: ignore[no-untyped-def]
            return np.asarray((of(ahead) - of(behind)) / (2 * h))

        crests = difference(lambda p: core.crests(data, *p.arrays, lines)[1])
        np.testing.assert_allclose(crest[:, k], crests, atol=1e-5 * (1 + np.abs(crests).max()))
        if surfaces is PROFILES:
            feet = difference(lambda p: core.crests(data, *p.arrays, lines)[0].foot)
            np.testing.assert_allclose(foot[:, k], feet, atol=1e-5 * (1 + np.abs(feet).max()))
    slope = core.penetration(data, *place.arrays, s, x).slope
    after, before = (core.penetration(data, *place.arrays, s, x + way * h).depth for way in (1, -1))
    np.testing.assert_allclose(slope, (after - before) / (2 * h), atol=1e-7)


def test_arrays_that_do_not_fit_are_refused() -> None:
    shape, lines = RAIL.shape, RigidWheelRail(WHEEL, RAIL, RADIUS).lines
    place, n = pose(PROFILES).arrays, len(lines.s)
    parts = [getattr(shape, name) for name in shape._fields]
    for i in range(5):
        with pytest.raises(ValueError, match=r"Shape: .* do not fit"):
            core.Shape(*parts[:i], parts[i][:-1], *parts[i + 1 :])
    with pytest.raises(TypeError, match=r"Shape\.breaks"):
        core.Shape(parts[0].astype(np.float32), *parts[1:])
    with pytest.raises(ValueError, match="guess"):
        core.closest(shape, np.zeros(3, dtype=complex), np.zeros(2))
    with pytest.raises(ValueError, match="those of the rail"):
        core.scan(WHEEL.shape, lines, RADIUS, *place, (0, n))
    for part in ((0, n + 1), (-1, n), (4, 4)):
        with pytest.raises(ValueError, match="part"):
            core.scan(shape, lines, RADIUS, *place, part)
    found = core.scan(shape, lines, RADIUS, *place, (0, n))
    wrong = core.Scan(found.depth, found.slope, found.x, found.sample + len(shape.samples))
    with pytest.raises(ValueError, match="samples"):
        core.local_maxima(WHEEL.shape, shape, RADIUS, *place, lines.s, wrong)
    with pytest.raises(ValueError, match="pose"):
        core.lines_to_scan(lines, RADIUS, place[0][:2], *place[1:])
    with pytest.raises(ValueError, match="as long as s"):
        core.penetration(surface_data(PROFILES), *place, np.zeros(3), np.zeros(2))


def test_lines_are_pickled() -> None:
    pair = RigidWheelRail(WHEEL, RAIL, RADIUS)
    again = pickle.loads(pickle.dumps(pair.lines))
    np.testing.assert_array_equal(again.outline, pair.lines.outline)
    assert again.flange.side == pair.lines.flange.side
    assert isinstance(again.rail_tangent, np.ndarray)
