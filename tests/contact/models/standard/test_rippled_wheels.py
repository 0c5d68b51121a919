"""Wheels with more humps than profiles have when new, as wear leaves them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_tangent_at_corners import errors, load

from wheelrail.bindings._contact import wheel_regions
from wheelrail.contact.geometry.rigid_surfaces import RigidWheelRail
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.meshes.curves.arc_length import line
from wheelrail.meshes.curves.spline import through
from wheelrail.meshes.profiles.profile import Profile, from_sections
from wheelrail.support.arrays import Array

RADIUS, CROWN, WAVE, HEIGHT = 0.46, 20.0, 2e-3, 0.4e-6  # m
CYLINDER = from_sections([line(-0.05 + 0j, 0.05 + 0j)], name="cylinder", kind="wheel")
ROLLING = WheelsetState(speed=20.0, pitch_rate=20.05 / RADIUS, y_rate=0.01)


def rail(height: float) -> Profile:
    """A wide crown with ripples of a height m."""
    y = np.linspace(-0.06, 0.06, 2401)
    z = height * np.cos(2 * np.pi * y / WAVE)
    z += CROWN * (np.sqrt(1.0 - (y / CROWN) ** 2) - 1.0)
    sections = through(np.column_stack([y, z - z[1200]]))
    return from_sections(sections, name=f"crown with ripples of {1e6 * height:g} µm", kind="rail")


def contact(height: float) -> tuple[StandardContact, Mounting]:
    pair = RigidWheelRail(CYLINDER, rail(height), RADIUS)
    return StandardContact(pair, ContactLaws(friction=0.3)), Mounting(0.75, 0.75, RADIUS)


def humps(height: float, depth: float) -> Array:
    """Places across and penetration (k, 2) m of all humps of a lowered wheel, on samples."""
    y = np.linspace(-0.05, 0.05, 200001)
    own = depth - CROWN * (1.0 - np.sqrt(1.0 - (y / CROWN) ** 2)) + height * (np.cos(2 * np.pi * y / WAVE) - 1.0)
    at = np.flatnonzero((own[1:-1] > np.maximum(own[:-2], own[2:])) & (own[1:-1] > 0.0)) + 1
    return np.column_stack([y[at], own[at]])


def test_all_humps_are_found() -> None:
    """Without a limit of their number: of more than eight, the others ended as an overlap without contact."""
    (model, mounting), depth = contact(HEIGHT), 10e-6
    pose, motion = mounting.left_pair(replace(ROLLING, z=-depth))
    pair, expected = model.surfaces, humps(HEIGHT, depth)
    assert isinstance(pair, RigidWheelRail)
    assert len(expected) > 15
    found = wheel_regions(pair.wheel.shape, pair.rail.shape, RADIUS, *pose.arrays, pair.lines, pair.merge_distance)
    np.testing.assert_allclose(found.top[:, 0], expected[:, 0], atol=1e-5)
    np.testing.assert_allclose(found.top[:, 1], expected[:, 1], atol=1e-9)
    assert model(pose, motion).ok


@pytest.mark.parametrize("height", [0.06e-6, HEIGHT / 2])
def test_humps_between_two_lines_are_found(height: float) -> None:
    """Wherever the lines lie: a hump was missed with a minimum before the next line, and forces jumped by 2 %."""
    (model, mounting), expected, known = contact(height), humps(height, depth := 10e-6), set[int]()
    pair = model.surfaces
    assert isinstance(pair, RigidWheelRail)
    for y in np.linspace(0.0, 4e-4, 41):
        pose = mounting.left_pair(replace(ROLLING, y=y, z=-depth))[0]
        shapes = pair.wheel.shape, pair.rail.shape, RADIUS
        known.add(len(wheel_regions(*shapes, *pose.arrays, pair.lines, pair.merge_distance).top))
    assert known == {len(expected)}


def test_ripples_hardly_change_the_force() -> None:
    """Ripples of 4 % of the approach, against none."""
    forces = []
    for height in (0.0, HEIGHT):
        model, mounting = contact(height)
        forces.append(load(model, *mounting.left_pair(replace(ROLLING, z=-10e-6)))[:3])
    np.testing.assert_allclose(forces[1], forces[0], atol=0.1 * np.abs(forces[0]).max())


def test_tangents_with_many_humps() -> None:
    """Against differences of the forces."""
    model, mounting = contact(HEIGHT)
    found = [
        errors(model, *mounting.left_pair(replace(ROLLING, y=y, z=-depth, roll=roll)))
        for y, roll, depth in ((1e-4, 1e-5, 10e-6), (3e-4, -2e-5, 16e-6))
    ]
    assert np.isfinite(found).mean() > 0.9
    np.testing.assert_array_less(np.nanmax(found, axis=1), 1e-3)


def test_forces_do_not_jump_where_two_humps_part() -> None:
    """A minimum below zero between two lines above it is a gap, too: weights jumped, and forces by 0.6 %."""
    (model, mounting), lowest = contact(HEIGHT), []
    pair = model.surfaces
    assert isinstance(pair, RigidWheelRail)
    for depth in np.linspace(9e-6, 10e-6, 41):
        pose = mounting.left_pair(replace(ROLLING, z=-depth))[0]
        shapes = pair.wheel.shape, pair.rail.shape, RADIUS
        lowest.append(wheel_regions(*shapes, *pose.arrays, pair.lines, pair.merge_distance).low[:, 1].min())
    assert min(lowest) == 0.0
