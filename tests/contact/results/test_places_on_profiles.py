"""Contact points lie at their arc lengths on both profiles, in every model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import small_wheelset
from small_pairs import BRICKS, CREEP, condensed, full
from small_strips import few_strips
from standard_pair import wheel_on_rail

import wheelrail as wr
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.contact.results.result import Fields
from wheelrail.support.arrays import Array

STATE = WheelsetState(y=2e-3, z=-2e-4, yaw=5e-3, speed=20.0, pitch_rate=20.0 / 0.46)
FLANGE = replace(STATE, y=6.8e-3, z=-1e-4)


def off_profiles(contact: WheelsetContact, state: WheelsetState, side: Side) -> tuple[Fields, Array, Array, Array]:
    """Fields, distances (n,) m from the wheel's surface at `wheel_s`, distances along the rail's tangent at `rail_s`,
    and distances along the rail, of the contact points from the lowest circle of the wheel.
    """
    result = contact(state, side)
    assert result.status == "converged"
    fields, own = result.fields, contact.of(side)
    assert fields is not None
    assert fields.wheel_s is not None
    assert fields.rail_s is not None
    pose, _ = own.mounting.left_pair(state if side == "left" else state.mirrored())
    pair = getattr(own.model, "surfaces", None) or getattr(own.model, "geometry", None) or own.model.operators.surfaces  # type: ignore[attr-defined]
    x, y, z = ((fields.point - pose.origin) @ pose.rotation).T
    wheel = np.column_stack([y, np.hypot(x, z) - pair.radius]) - pair.wheel.point(fields.wheel_s)
    rail = fields.point[:, 1:] - pair.rail.point(fields.rail_s)
    return fields, np.hypot(*wheel.T), np.abs((rail * pair.rail.tangent(fields.rail_s)).sum(axis=1)), x


@pytest.mark.parametrize("state", [STATE, FLANGE], ids=["tread", "flange"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_strips_lie_on_both_profiles(state: WheelsetState, side: Side) -> None:
    own = state if side == "left" else state.mirrored()
    _, wheel, rail, _ = off_profiles(few_strips(), own, side)
    assert max(wheel.max(), rail.max()) < 1e-12


def test_points_of_a_grid_lie_on_both_profiles() -> None:
    straight = replace(small_wheelset.STATE, frame_rate=(0.0, 0.0, 0.0))
    _, wheel, rail, _ = off_profiles(small_wheelset.wheelset(), straight, "left")
    assert max(wheel.max(), rail.max()) < 1e-12


@pytest.mark.parametrize("state", [STATE, FLANGE], ids=["tread", "flange"])
def test_strips_of_the_standard_contact_lie_on_a_tangent_of_the_wheel(state: WheelsetState) -> None:
    """Middles of strips lie on both profiles, cells off the wheel by the rise x^2 / 2 r of its circle."""
    fields, wheel, _, x = off_profiles(wheel_on_rail(), state, "left")
    middles = fields.point.reshape(16, 16, 3).mean(axis=1)
    contact = wheel_on_rail()
    pose, _ = contact.mounting.left_pair(state)
    local, pair = (middles - pose.origin) @ pose.rotation, contact.model.surfaces  # type: ignore[attr-defined]
    assert fields.wheel_s is not None
    assert fields.rail_s is not None
    places = np.column_stack([local[:, 1], np.hypot(local[:, 0], local[:, 2]) - pair.radius])
    np.testing.assert_allclose(places, pair.wheel.point(fields.wheel_s[::16]), atol=1e-12)
    rail = middles[:, 1:] - pair.rail.point(fields.rail_s[::16])
    assert np.abs((rail * pair.rail.tangent(fields.rail_s[::16])).sum(axis=1)).max() < 1e-12
    rise = (x.reshape(16, 16) - local[:, :1]).ravel() ** 2 / (2.0 * 0.43)
    assert (wheel <= 1.05 * rise + 1e-9).all()


def test_a_hertz_pair_has_lateral_positions() -> None:
    for build in (condensed, full):
        result = build(BRICKS, (0.3, 0.3), size=1e-3, laws=ContactLaws.penalty())(hertz_pose(1e-5), CREEP, None)
        fields = result.fields
        assert fields is not None
        np.testing.assert_array_equal(fields.wheel_s, fields.point[:, 1])
        np.testing.assert_allclose(fields.rail_s, fields.point[:, 1], atol=1e-12)


def test_datasets_have_the_places() -> None:
    solution = wr.Wheelset(model="standard").solve(wheel_load=6e4)
    data = solution.data
    for name in ("wheel_s", "rail_s"):
        assert data[f"point_{name}"].attrs["units"] == "m"
        for side in ("left", "right"):
            own = data.where((data.point_side == side) & (data.point_patch == 0), drop=True)
            load = own.pressure * own.area
            mean = float((load * own[f"point_{name}"]).sum() / load.sum())
            assert mean == pytest.approx(float(data[name].sel(side=side, patch=0)), abs=1e-9)
