"""Standard contact of several wheels on moved rails in one call: each as alone, with derivatives and mirror image."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from standard_pair import wheel_on_rail

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.flexible_contact import FlexibleContact
from wheelrail.contact.loading.flexible_state import FlexibleState
from wheelrail.contact.loading.flexible_wheelset import Flexibility
from wheelrail.contact.loading.moved_wheels import moved_together
from wheelrail.contact.solvers.tangent import MIRRORED

STEPS = np.array([1e-7] * 4 + [1e-5] * 5 + [1e-7] * 18)


def contact() -> FlexibleContact:
    return FlexibleContact(wheel_on_rail(), Flexibility())


def states() -> list[WheelsetState]:
    """Two wheelsets with moving hubs and rails, and a rigid one."""
    random = np.random.default_rng(3)
    rigid = WheelsetState(2e-3, -8e-4, 1e-4, 2e-3, 0.01, 0.002, -0.003, 0.004, 43.5, 20.0)
    moving = FlexibleState(**{f.name: getattr(rigid, f.name) for f in fields(rigid)})
    own = [replace(moving, y=y, motions=tuple((2e-4 * random.normal(size=18)).tolist())) for y in (2e-3, -6e-3)]
    return [own[0], rigid, own[1]]


@pytest.mark.parametrize("side", SIDES)
def test_wheels_together_are_as_each_alone(side: Side) -> None:
    model = contact()
    together = model.solve_side(states(), side, [None] * 3)
    assert model.together
    assert moved_together(together) is not None
    tangents = model.side_tangents(states(), side, together)
    for state, result, tangent in zip(states(), together, tangents, strict=True):
        pair = model.pairs.pair(state, side)
        alone = pair.in_track(model.model(pair.pose, pair.motion, None))
        alone = alone if side == "left" else alone.mirrored()
        assert result.status == "converged"
        np.testing.assert_allclose(result.force, alone.force, rtol=1e-9, atol=1e-6)
        np.testing.assert_allclose(result.moment, alone.moment, rtol=1e-9, atol=1e-6)
        for one, other in zip(result.patches, alone.patches, strict=True):
            np.testing.assert_allclose(one.force, other.force, rtol=1e-9, atol=1e-6)
            assert one.contact_angle == pytest.approx(other.contact_angle, abs=1e-12)
        np.testing.assert_allclose(tangent, model.tangent(state, side, alone), rtol=1e-7, atol=1e-3)
        np.testing.assert_allclose(result.tangent(), alone.tangent(), rtol=1e-7, atol=1e-3)


@pytest.mark.parametrize("side", SIDES)
def test_derivatives_are_those_of_differences(side: Side) -> None:
    model, state = contact(), states()[0]
    assert isinstance(state, FlexibleState)
    tangent = model.tangent(state, side, model(state, side))

    def wrench(change: np.ndarray) -> np.ndarray:
        moved = {name: getattr(state, name) + change[k] for k, name in enumerate(WheelsetState.coordinates)}
        motions = tuple((np.array(state.motions) + change[9:]).tolist())
        result = model(replace(state, **moved, motions=motions), side)
        return np.concatenate([result.force, result.moment])

    for column, step in enumerate(np.diag(STEPS)):
        change = (wrench(step) - wrench(-step)) / (2 * STEPS[column])
        np.testing.assert_allclose(tangent[:, column], change, atol=1e-4 * np.abs(tangent[:, column]).max() + 1.0)


def test_mirror_images_bit_for_bit() -> None:
    model, state = contact(), states()[0]
    left, right = model(state, "left"), model(state.mirrored(), "right")
    np.testing.assert_array_equal(
        np.concatenate([right.force, right.moment]), MIRRORED * np.concatenate([left.force, left.moment])
    )
