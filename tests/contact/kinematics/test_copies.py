"""Copies of frozen dataclasses with changes."""

from __future__ import annotations

from dataclasses import replace

from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.wheelset_state import WheelsetState


def test_a_changed_record_is_a_replaced_one() -> None:
    state = WheelsetState(y=1e-3, speed=20.0)
    copy = changed(state, y=2e-3, rail_shift=None)
    assert copy == replace(state, y=2e-3)
    assert state.y == 1e-3
    assert type(copy) is WheelsetState
