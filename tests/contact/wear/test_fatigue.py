"""Fatigue of patches: damage by T-gamma, ratcheting, direction of traction."""

from __future__ import annotations

import numpy as np
import pytest
from standard_pair import wheel_on_rail

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.wear.fatigue import direction, ratcheting, whole_life_rail_damage


def test_damage_by_t_gamma() -> None:
    damage = whole_life_rail_damage(np.array([0.0, 15.0, 40.0, 65.0, 120.0, 175.0, 285.0]))
    assert damage == pytest.approx([0.0, 0.0, 5e-6, 1e-5, 5e-6, 0.0, -1e-5])


def test_ratcheting_is_above_the_shakedown_branch() -> None:
    state = WheelsetState(y=6.6e-3, z=-1e-4, yaw=4e-3, speed=20.0, pitch_rate=20.0 / 0.46)
    (patch,) = wheel_on_rail()(state, "left").patches
    used = np.hypot(*patch.tangential_force) / patch.normal_force
    limit = patch.max_pressure * used  # k at which FI = 0
    assert ratcheting([patch], 0.9 * limit) == pytest.approx([0.1 * used])
    assert ratcheting([patch], 1.1 * limit) == [0.0]
    assert ratcheting([], 3e8).shape == (0,)
    with pytest.raises(ValueError, match=r"shear_yield = 0\.0: must be positive"):
        ratcheting([patch], 0.0)


def test_direction_of_traction() -> None:
    angle = direction(np.array([[1.0, 0.0], [0.0, -2.0], [0.0, 0.0]]))
    assert angle[:2] == pytest.approx([0.0, -np.pi / 2])
    assert np.isnan(angle[2])
