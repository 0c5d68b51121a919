"""Compiles the machine code that most tests use, once, before several processes need it at the same time."""

from __future__ import annotations

from small_strips import few_strips
from standard_pair import wheel_on_rail

from wheelrail.contact.kinematics.wheelset_state import WheelsetState

if __name__ == "__main__":
    state = WheelsetState(y=2e-3, z=-1e-4, speed=20.0, pitch_rate=20.0 / 0.46)
    strips = few_strips()
    strips.tangent(state, "left", strips(state, "left"))
    for tangential in ("polach", "fastsim"):
        wheel_on_rail(tangential=tangential)(state, "left")
