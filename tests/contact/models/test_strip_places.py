"""Slopes of the force on strips, averaged over places of their lattice."""

from __future__ import annotations

import numpy as np
import pytest
from linear_creep import LinearCreep

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.contact.loading.flexible_wheelset import Flexibility
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.strip_places import at_places
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.meshes.profiles.named import named_profile

COORDINATES = WheelsetState.coordinates
CENTRED = WheelsetState(y=0.0, z=-2.3e-4, roll=0.0, pitch_rate=30.0 / 0.46, speed=30.0)


def contact(strips: int) -> WheelsetContact:
    """S1002 on 60E1 as half-spaces: centred, two humps 10.6 mm apart."""
    profiles = (named_profile("S1002"), named_profile("60E1").inclined(0.025))
    how = Discretisation(1e-3, bodies="half-space", strips=strips, cells=10)
    model = wheel_rail_pair(profiles, 0.46, (Material(), Material()), ContactLaws(friction=0.3), how)
    return WheelsetContact(model, Mounting(0.75, profiles[1].gauge_offset(1.435, 0.014), 0.46))


def steering(strips: int, places: int) -> np.ndarray:
    """Yaw moment of both wheels by the lateral displacement, N, at places of the strips."""
    slopes = []
    for one in at_places(contact(strips), places):
        wheels = [one.tangent(CENTRED, side, one(CENTRED, side)) for side in SIDES]
        slopes.append(sum(wheels)[5, COORDINATES.index("y")])
    return np.array(slopes)


def test_the_mean_slope_of_wide_strips_is_that_of_narrow_ones() -> None:
    wide, narrow = steering(8, 8), steering(28, 3)
    assert wide.std() > 0.03 * abs(wide.mean())
    assert narrow.std() < 0.3 * wide.std()
    assert wide.mean() == pytest.approx(narrow.mean(), rel=0.02)


def test_places_of_both_sides() -> None:
    both = contact(6)
    _, moved = at_places(WheelsetContact(both.model, both.mounting, right=both), 2)
    assert isinstance(moved, WheelsetContact)
    for side in SIDES:
        model = moved.of(side).model
        assert isinstance(model, LatticeContact)
        assert model.offset == 0.5


def test_places_under_moving_hubs_and_rails() -> None:
    moving = FlexibleContact(contact(6), Flexibility())
    _, moved = at_places(moving, 2)
    assert isinstance(moved, FlexibleContact)
    assert isinstance(moved.model, LatticeContact)
    assert moved.model.offset == 0.5
    assert moved.flexibility is moving.flexibility


def test_a_contact_without_strips_has_one_place() -> None:
    other = LinearCreep()
    assert at_places(other, 4) == [other]
