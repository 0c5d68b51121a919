"""Frictional power of a patch: tractions on the rigid slip, compared with the local slip."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from test_strips import LOAD, exact, flowing, pair

from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_under_load
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Bodies, Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.meshes.profiles.named import named_profile

SPEED = 1.0  # of `flowing`


def rolling(motion: RigidMotion, resolution: LatticeResolution | None = None) -> ContactResult:
    model = pair(0.3, resolution=resolution)
    return hertz_under_load(model, motion, LOAD, expected=exact().approach).results[0]


def by_local_slip(result: ContactResult) -> float:
    fields = result.fields
    assert fields is not None
    return float(-SPEED * fields.area @ np.einsum("nk,nk->n", fields.traction, fields.slip))


def test_power_is_force_times_creepage_and_moment_times_spin() -> None:
    result = rolling(flowing(5e-4, -7e-4, 0.4))
    (patch,) = result.patches
    xi, eta, phi = patch.creepage
    assert (xi, phi) == pytest.approx((5e-4, 0.4))
    assert eta == pytest.approx(-7e-4, rel=2e-3)  # the resultant lies a little ahead, where spin adds to it
    along, across = patch.tangential_force
    # about the resultant
    moment = result.moment[2] - patch.x * result.force[1]
    expected = -SPEED * (along * xi + across * eta + moment * phi)
    assert patch.frictional_power == pytest.approx(expected, rel=1e-4)
    assert patch.mirrored().creepage == (xi, -eta, -phi)


def test_full_sliding_dissipates_the_whole_work() -> None:
    (patch,) = rolling(flowing(xi=2e-2)).patches
    assert patch.frictional_power == pytest.approx(0.3 * LOAD * 2e-2 * SPEED, rel=1e-4)


def test_local_slip_tends_to_the_same_power() -> None:
    """The elastic part of the slip does no work in steady rolling, in the limit of fine cells."""
    apart = []
    cells = (8, 16, 32)
    for count in cells:
        result = rolling(flowing(xi=1e-3), LatticeResolution(8, count))
        power = result.patches[0].frictional_power
        apart.append(1.0 - by_local_slip(result) / power)
    slope = np.polyfit(np.log(cells), np.log(apart), 1)[0]
    assert 0.0 < apart[-1] < 0.02
    assert -2.2 < slope < -1.6  # second order


PLACES = {"tread": (3.5e-3, 1e-3), "gauge corner": (6e-3, 3e-3), "flange": (6.9e-3, 6e-3)}  # y m, yaw rad


@cache
def on_wheelset(bodies: Bodies, place: str, cells: int | None) -> tuple[float, float]:
    """Power W by patches and as the sum over points of S1002 on UIC60, on strips of cells or on a grid."""
    y, yaw = PLACES[place]
    rail = named_profile("UIC60-benchmark")
    strips = Discretisation(1e-3, bodies=bodies, strips=14, cells=cells)
    how = strips if cells else Discretisation(1e-3, bodies=bodies, points="grid")
    profiles, steels = (named_profile("S1002"), rail), (Material(), Material())
    model = wheel_rail_pair(profiles, 0.46, steels, ContactLaws(friction=0.3), how)
    contact = WheelsetContact(model, Mounting(0.75, rail.gauge_offset(1.435, 0.014), 0.46))
    state = WheelsetState(y=y, yaw=yaw, speed=20.0, pitch_rate=20.0 / 0.46)
    seat = wheel_under_load(contact, state, "left", 6e4, expected=1e-4)
    result, (pose, motion) = seat.results["left"], contact.mounting.left_pair(seat.state)
    power = sum(patch.frictional_power for patch in result.patches)
    speed = model.problem(pose, motion).lines.speed if isinstance(model, LatticeContact) else 20.0
    return power, speed * by_local_slip(result)


@pytest.mark.parametrize(
    ("bodies", "place"),
    [("waveguide", "tread"), ("waveguide", "gauge corner"), ("half-space", "gauge corner"), ("half-space", "flange")],
)
def test_power_is_the_limit_of_the_heat_of_cells(bodies: Bodies, place: str) -> None:
    """On finite bodies too, whose wheel rolls on a smaller radius and whose tractions shift the pressure along x: 3.5
    and 4 % of it without. Few cells have nearly the same power.
    """
    powers, sums = zip(*(on_wheelset(bodies, place, cells) for cells in (10, 20, 40)), strict=True)
    assert (4.0 * sums[2] - sums[1]) / 3.0 == pytest.approx(powers[2], rel=2e-3)
    assert powers[0] == pytest.approx(powers[2], rel=1e-2)


def test_grids_have_the_power_of_strips() -> None:
    """Of 1 mm, where the compression alone takes 2.8 %, and the work of the pressure adds as much."""
    strips, grid = (on_wheelset("waveguide", "gauge corner", cells)[0] for cells in (20, None))
    assert grid == pytest.approx(strips, rel=1.2e-2)


def test_no_power_without_friction_or_motion() -> None:
    model = pair(0.0)
    (patch,) = hertz_under_load(model, flowing(xi=1e-3), LOAD, expected=exact().approach).results[0].patches
    assert (patch.creepage, patch.frictional_power) == ((0.0, 0.0, 0.0), 0.0)
    assert isinstance(patch, Patch)
