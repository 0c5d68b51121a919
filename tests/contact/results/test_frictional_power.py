"""Frictional power of a patch: tractions on the rigid slip, compared with the local slip."""

from __future__ import annotations

import numpy as np
import pytest
from small_strips import few_strips
from test_strips import LOAD, exact, flowing, pair

from wheelrail.contact.kinematics.frames import RigidMotion
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.hertz import hertz_under_load
from wheelrail.contact.loading.wheelset import wheel_under_load
from wheelrail.contact.models.lattice.resolution import LatticeResolution
from wheelrail.contact.results.result import ContactResult, Patch

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


@pytest.mark.parametrize("yaw", [-4e-3, 4e-3])
def test_pressure_works_on_a_flange(yaw: float) -> None:
    """Tractions on a flange shift the pressure along x, whose work is part of the heat: 1.0 and 1.2 % of it here."""
    contact = few_strips()
    seat = wheel_under_load(
        contact, WheelsetState(y=6.6e-3, yaw=yaw, speed=25.0, pitch_rate=25.1 / 0.46), "left", 1e5, expected=1e-4
    )
    result, (_, motion) = seat.results["left"], contact.mounting.left_pair(seat.state)
    fields = result.fields
    assert fields is not None
    load = fields.area * fields.pressure
    wheel, rail = motion.wheel.at(fields.point), motion.rail.at(fields.point)
    speed = -0.5 * (load @ (wheel + rail)[:, 0]) / load.sum()  # slips are over the rolling speed, 1 % above 25 m/s
    power = sum(patch.frictional_power for patch in result.patches)
    assert speed * by_local_slip(result) == pytest.approx(power, rel=3e-3)
    normal = load @ np.einsum("nc,nc->n", wheel - rail, fields.axes[:, 2])
    assert -0.02 < normal / power < -0.008


def test_no_power_without_friction_or_motion() -> None:
    model = pair(0.0)
    (patch,) = hertz_under_load(model, flowing(xi=1e-3), LOAD, expected=exact().approach).results[0].patches
    assert (patch.creepage, patch.frictional_power) == ((0.0, 0.0, 0.0), 0.0)
    assert isinstance(patch, Patch)
