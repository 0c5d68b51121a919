"""Compiles machine code that many tests use, once, before several processes need it at the same time.

python tests/helpers/machine_code.py strips|standard|table
"""

from __future__ import annotations

import sys

import numpy as np
from small_strips import few_strips
from standard_pair import MOUNTING, wheel_on_rail

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.table.force_table import ForceTable, FrictionTable, NormalTable, TreadFrame

STATE = WheelsetState(y=2e-3, z=-1e-4, speed=20.0, pitch_rate=20.0 / 0.46)


def strips() -> None:
    """Contact on strips."""
    contact = few_strips()
    contact.tangent(STATE, "left", contact(STATE, "left"))


def standard() -> None:
    """The standard model."""
    for tangential in ("polach", "fastsim"):
        wheel_on_rail(tangential=tangential)(STATE, "left")


def table() -> None:
    """Look-up of a table."""
    node, ends = np.zeros(1), np.array([0.0, 1.0])
    values = np.zeros(2 * 9)
    values[[0, 9]] = 1.0, -1.0  # heights m without load and at the larger level
    normal = NormalTable(node, node, node, ends, values)
    friction = FrictionTable(node, node, node, ends, node, node, np.zeros(2 * 6), 0.3)
    forces = ForceTable(TreadFrame(MOUNTING.radius, 0.0), normal, friction)
    pose, motion = MOUNTING.left_pair(STATE)
    forces.force(pose, motion)
    forces.derivative(pose, motion)


if __name__ == "__main__":
    {"strips": strips, "standard": standard, "table": table}[sys.argv[1]]()
