"""Rates of contacts along profiles: energy and volume are kept, in every model, on wheel and rail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from small_pairs import BRICKS, CREEP, condensed, full
from small_strips import few_strips
from standard_pair import RAIL, WHEEL, wheel_on_rail

from benchmarks.wear import contact as checks
from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.laws.friction import FallingFriction
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.wear.laws import Archard, Kth, Usfd
from wheelrail.contact.wear.strips import ProfileGrid, WornStrips, profile_rates, total, worn_strips

SPEED, FRICTION = 20.0, 0.3
STATE = WheelsetState(y=2e-3, z=-1.5e-4, yaw=2e-3, speed=SPEED, pitch_rate=SPEED / 0.46)
FLANGE = replace(STATE, y=6.6e-3, z=-5e-5, yaw=5e-3)
GRIDS = ProfileGrid.wheel(WHEEL, 0.46), ProfileGrid.rail(RAIL)


def solved(model: str, state: WheelsetState, side: Side = "left") -> ContactResult:
    contacts: dict[str, WheelsetContact] = {
        "strips": few_strips(),
        "fastsim": wheel_on_rail(),
        "hertz": wheel_on_rail(normal="hertz"),
    }
    result = contacts[model](state if side == "left" else state.mirrored(), side)
    assert result.status == "converged"
    return result


@pytest.mark.parametrize("state", [STATE, FLANGE], ids=["tread", "flange"])
@pytest.mark.parametrize("model", ["strips", "fastsim", "hertz"])
def test_energy_and_volume_are_kept(model: str, state: WheelsetState) -> None:
    """T-gamma over both profiles, and Archard's volume k T-gamma / mu H."""
    result, law = solved(model, state), Archard(k=1e-3, hardness=2e9)
    t_gamma = sum(patch.frictional_power for patch in result.patches) / SPEED
    strips = worn_strips(result, law, FRICTION, SPEED)
    for grid in GRIDS:
        rates = profile_rates(strips, grid)
        assert rates.energy @ grid.per_passage == pytest.approx(t_gamma, rel=1e-12)
        assert rates.removed @ grid.per_passage == pytest.approx(1e-3 * t_gamma / (FRICTION * 2e9), rel=1e-12)
        assert (rates.removed >= 0.0).all()
        assert abs(rates.outside) < 1e-12 * strips.volume.sum()
    assert 0.6 * t_gamma < strips.unbalanced.sum() < 1.1 * t_gamma


@pytest.mark.parametrize("build", [condensed, full])
def test_energy_is_kept_on_grids(build: Callable[..., ContactModel]) -> None:
    result = build(BRICKS, (0.3, 0.3), size=1e-3, laws=ContactLaws.penalty())(hertz_pose(1e-5), CREEP, None)
    for body in ("wheel", "rail"):
        grid = ProfileGrid(body, np.linspace(-0.02, 0.02, 81), np.full(80, 2.0))
        rates = profile_rates(worn_strips(result, Archard(), FRICTION, SPEED), grid)
        t_gamma = sum(patch.frictional_power for patch in result.patches) / SPEED
        assert t_gamma > 0.0
        assert rates.energy @ grid.per_passage == pytest.approx(t_gamma, rel=1e-12)


def test_both_sides_wear_alike() -> None:
    left, right = (
        profile_rates(worn_strips(solved("strips", FLANGE, side), Usfd(), FRICTION, SPEED), GRIDS[0])
        for side in ("left", "right")
    )
    np.testing.assert_array_equal(left.removed, right.removed)
    np.testing.assert_array_equal(left.traction, right.traction)


def test_wear_lies_where_the_patch_is() -> None:
    result = solved("strips", FLANGE)
    strips, fields = worn_strips(result, Archard(), FRICTION, SPEED), result.fields
    assert fields is not None
    power = fields.area * (fields.traction * fields.slip).sum(axis=1)
    for grid, place in zip(GRIDS, (fields.wheel_s, fields.rail_s), strict=True):
        rates = profile_rates(strips, grid)
        middle = 0.5 * (grid.bounds[1:] + grid.bounds[:-1])
        volume = rates.removed * grid.per_passage
        assert volume @ middle / volume.sum() == pytest.approx(power @ place / power.sum(), abs=1e-4)


def test_pressure_of_what_is_removed() -> None:
    """Sums of p over cells weighted by their strips' wear, however they are deposited; 0 where nothing wears."""
    strips = worn_strips(solved("strips", STATE), Archard(), FRICTION, SPEED)
    rates = profile_rates(strips, GRIDS[1])
    mean = strips.volume @ strips.pressure / strips.volume.sum()
    assert rates.pressed.sum() / rates.removed.sum() == pytest.approx(mean, rel=1e-12)
    much = rates.removed > 0.05 * rates.removed.max()
    assert 0.8 * strips.pressure.min() < rates.pressure[much].min()
    assert rates.pressure[much].max() < 1.1 * strips.pressure.max()
    assert not rates.pressure[rates.removed == 0.0].any()


def test_a_map_moves_wear_and_loses_nothing() -> None:
    strips = worn_strips(solved("strips", STATE), Archard(), FRICTION, SPEED)
    fixed, moved = (profile_rates(strips, GRIDS[1], place) for place in (None, lambda s: 0.9 * s + 2.5e-3))
    middle = 0.5 * (GRIDS[1].bounds[1:] + GRIDS[1].bounds[:-1])
    one, other = (rates.removed @ middle / rates.removed.sum() for rates in (fixed, moved))
    assert other == pytest.approx(0.9 * one + 2.5e-3, abs=1e-5)
    assert moved.removed.sum() == pytest.approx(fixed.removed.sum(), rel=1e-12)


def test_volume_beyond_the_profile_is_told() -> None:
    strips = worn_strips(solved("strips", STATE), Archard(), FRICTION, SPEED)
    place = float(strips.volume @ strips.wheel_s / strips.volume.sum())
    half = ProfileGrid("wheel", np.linspace(-0.09, place, 100), np.ones(99))
    rates = profile_rates(strips, half)
    assert rates.outside == pytest.approx(0.5 * strips.volume.sum(), rel=0.3)
    assert rates.removed.sum() + rates.outside == pytest.approx(strips.volume.sum(), rel=1e-12)


def test_severe_wear_is_told() -> None:
    result = solved("strips", FLANGE)
    with pytest.warns(UserWarning, match="0.8 times the hardness"):
        strips = worn_strips(result, Kth(hardness=5e8, limit=5e8), FRICTION, SPEED)
    rates = profile_rates(strips, GRIDS[0])
    assert (rates.severe <= rates.removed).all()
    expected = strips.severe.sum() / strips.volume.sum()
    assert 0.1 < expected < 1.0
    assert rates.severe.sum() / rates.removed.sum() == pytest.approx(expected, rel=0.02)


def test_friction_may_depend_on_the_slip() -> None:
    """Archard's p |w| is tau w over the friction of each cell."""
    law = ContactLaws(friction=FallingFriction(0.4, 0.5, 1.0))
    result = solved("strips", FLANGE)
    falling, constant = (worn_strips(result, Archard(), mu, SPEED).volume.sum() for mu in (law, 0.4))
    assert constant < falling < 2.0 * constant


def test_damage_and_index_are_of_the_patch() -> None:
    strips = worn_strips(solved("strips", FLANGE), Archard(), FRICTION, SPEED, shear_yield=1e8)
    quiet = replace(strips, t_gamma=np.array([40.0]))
    rates = profile_rates(quiet, GRIDS[1])
    assert rates.damage.sum() == pytest.approx(5e-6, rel=1e-9)
    assert rates.fatigue_index.max() == pytest.approx(strips.fatigue_index[0], rel=0.02)
    assert profile_rates(strips, GRIDS[1]).damage.min() >= 0.0


def test_rates_add() -> None:
    one, other = (
        profile_rates(worn_strips(solved("fastsim", state), Usfd(), FRICTION, SPEED), GRIDS[0])
        for state in (STATE, FLANGE)
    )
    both = total([one, other], [0.25, 0.75])
    np.testing.assert_allclose(both.removed, 0.25 * one.removed + 0.75 * other.removed, rtol=1e-12)
    assert both.t_gamma == pytest.approx(0.25 * one.t_gamma + 0.75 * other.t_gamma)


def test_a_patch_that_sticks_wears_where_its_pressure_is() -> None:
    result = solved("strips", STATE)
    assert result.fields is not None
    stuck = replace(result, fields=replace(result.fields, slip=np.zeros_like(result.fields.slip)))
    strips = worn_strips(stuck, Archard(), FRICTION, SPEED)
    assert strips.energy.sum() == pytest.approx(strips.t_gamma.sum(), rel=1e-12)
    assert strips.unbalanced.sum() == 0.0


def test_separated_and_failed_contacts() -> None:
    none: WornStrips = worn_strips(ContactResult.separated(-1e-3), Archard(), FRICTION, SPEED)
    assert profile_rates(none, GRIDS[0]).removed.sum() == 0.0
    with pytest.raises(ValueError, match="has no result: failed: reason"):
        worn_strips(ContactResult.failed("reason"), Archard(), FRICTION, SPEED)
    with pytest.raises(ValueError, match=r"speed = 0\.0: must be positive"):
        worn_strips(solved("fastsim", STATE), Archard(), FRICTION, 0.0)
    with pytest.raises(ValueError, match="no cells"):
        worn_strips(replace(solved("fastsim", STATE), fields=None), Archard(), FRICTION, SPEED)


def test_closed_forms() -> None:
    """Full sliding on 14 and 28 strips; USFD beside Archard."""
    assert all(check.passed for name in (checks.full_sliding, checks.mild_wear) for check in name())
