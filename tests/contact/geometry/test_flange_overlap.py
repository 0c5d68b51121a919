"""Large penetration at the flange root: the undeformed surfaces of compliant bodies interpenetrate far
along the rail.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
import pytest

from wheelrail.bindings._contact import sphere_approach
from wheelrail.contact.geometry.grid_points import SurfacePair
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.condensed import CondensedContact
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.meshes.profiles.named import named_profile

RADIUS, SPEED = 0.46, 45.0
WHEEL, RAIL = named_profile("S1002"), named_profile("60E1").inclined(0.025)
MOUNTING = Mounting(0.75, RAIL.gauge_offset(1.435, 0.014), RADIUS)
LOAD = 75e3
EXPECTED = sphere_approach(LOAD, radius=0.3, modulus=0.5 * Material().E / (1 - Material().nu ** 2))


@cache
def pair(size: float, friction: float = 0.3) -> CondensedContact:
    """The paper's laws on waveguides; spectra of lines 3 mm apart take a second, points alone need none."""
    laws = ContactLaws.penalty() if friction else ContactLaws(1e15, 0.0, 0.0)
    how = Discretisation(size, bodies="waveguide")
    made = wheel_rail_pair((WHEEL, RAIL), RADIUS, (Material(), Material()), laws, how)
    assert isinstance(made, CondensedContact)
    return made


@dataclass
class Watched:
    """Model that records the largest depth of its calls."""

    model: CondensedContact
    approaches: list[float] = field(default_factory=list)

    @property
    def geometry(self) -> SurfacePair:
        return self.model.geometry

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        result = self.model(pose, motion, guess)
        self.approaches.append(result.approach)
        return result


def state(y: float, z: float = 0.0) -> WheelsetState:
    return WheelsetState(y=y, z=z, pitch_rate=SPEED / RADIUS, speed=SPEED)


@pytest.mark.parametrize("size", [1e-3, 2e-3, 3e-3])
@pytest.mark.parametrize("overlap", [0.2e-3, 0.4e-3, 0.8e-3])
def test_contact_points_cover_the_penetration_and_upstream(size: float, overlap: float) -> None:
    geometry = pair(size).geometry
    pose, _ = MOUNTING.left_pair(state(6.25e-3, 1e-4))
    _, there = geometry.contact_points(pose, 0)
    pose = replace(pose, origin=pose.origin - [0.0, 0.0, (overlap - there) * 1.05])  # down, not along the normal
    points, depth = geometry.contact_points(pose, 2)
    assert points is not None
    assert depth == pytest.approx(overlap, rel=0.15)
    x = points.point[:, 0]
    # a wheel of radius r with the penetration d extends over +-sqrt(2 r d), here at the deepest line
    deepest = int(np.argmax(points.penetration))
    vertical = -points.penetration[deepest] / points.axes[deepest, 2, 2]
    radius = RADIUS + WHEEL.point(points.wheel_place[deepest, :1])[0, 1]
    assert x.max() == pytest.approx(np.sqrt(2 * radius * vertical), abs=1.1 * size)
    assert x.min() == pytest.approx(-x.max(), abs=1e-9)
    assert points.upstream.shape == (3, len(x))


# y m; height over the load's, lateral and longitudinal force N by exact laws on strips (lines 2 mm apart)
EXACT = [(6.25e-3, 335.9e-6, -23130.5, 21959.5), (6.5e-3, 369.1e-6, -25550.5, 22165.0)]


@pytest.mark.parametrize(("y", "approach", "lateral", "longitudinal"), EXACT)
def test_wheel_loads_on_the_flange_root(y: float, approach: float, lateral: float, longitudinal: float) -> None:
    watched = Watched(pair(1e-3))
    seat = wheel_under_load(WheelsetContact(watched, MOUNTING), state(y), "left", LOAD, expected=EXPECTED)
    found = seat.results["left"]
    assert found.status == "converged"
    # three lines across a patch 2.8 mm wide
    assert found.approach == pytest.approx(approach, rel=0.02)
    assert found.force[1] == pytest.approx(lateral, rel=0.01)
    assert found.force[0] == pytest.approx(longitudinal, rel=0.01)
    # twice the penetration has four times the points and sixteen times the memory
    assert max(watched.approaches) < 1.2 * found.approach


def test_contact_points_without_friction_cover_the_same_region() -> None:
    contact = WheelsetContact(pair(3e-3, 0.0), MOUNTING)
    found = wheel_under_load(contact, state(6.5e-3), "left", LOAD, expected=EXPECTED).results["left"]
    assert found.force[2] == pytest.approx(LOAD, rel=1e-6)
    assert found.force[0] == pytest.approx(0.0, abs=1e-6 * LOAD)


@pytest.mark.parametrize(
    ("y", "z", "way"),
    [
        # depth and place as by `benchmarks.population.oracle`
        (6.25e-3, -1.5e-3, r"2.01 mm deep at y = -29.4, z = 3.7 mm .* it passes 36 mm along the rail"),
        (
            0.03,
            0.0238,
            r"[0-9.]+ mm deep at y = -5[0-9.]+, z = 2[0-9.]+ mm of its profile, beyond the part of",
        ),
        (
            -0.03,
            -1e-3,
            r"[0-9.]+ mm deep at y = 3[0-9.]+, z = -0.8 mm of its profile, beyond the part of",
        ),
    ],
)
def test_penetration_beyond_the_points_names_the_place(y: float, z: float, way: str) -> None:
    pose, _ = MOUNTING.left_pair(state(y, z))
    with pytest.raises(OutsideSurface, match=way):
        pair(2e-3).geometry.contact_points(pose, 2)
