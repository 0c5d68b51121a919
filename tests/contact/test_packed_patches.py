"""Patches of the rows of a run as arrays: all numbers kept, in a fraction of the memory."""

from __future__ import annotations

import gc
import tracemalloc
from dataclasses import fields, replace

import numpy as np
from standard_pair import wheel_on_rail

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.packed_patches import PackedPatches
from wheelrail.contact.results.result import Patch
from wheelrail.support.plain_data import decode, encode
from wheelrail.vehicle.multibody.equations import VehicleEvaluation
from wheelrail.vehicle.simulation.row import Row


def touching() -> tuple[Patch, ...]:
    contact = wheel_on_rail()
    return tuple(contact(WheelsetState(y=5e-3, z=-2e-4, speed=20.0, pitch_rate=20.0 / 0.46), "left").patches)


def test_packed_patches_are_the_same() -> None:
    patches = touching()
    packed = PackedPatches.of(patches)
    assert len(packed) == len(patches) >= 1
    assert PackedPatches.of(packed) is packed
    for one, other in zip(patches, decode(encode(packed), ("wheelrail.contact",)), strict=True):
        for part in fields(Patch):
            value = getattr(other, part.name)
            np.testing.assert_array_equal(value, getattr(one, part.name))
            assert type(value) in (float, int, tuple, np.ndarray)
    np.testing.assert_array_equal(packed.column("creepage"), [patch.creepage for patch in patches])
    np.testing.assert_array_equal(packed.column("x"), [patch.x for patch in patches])
    assert len(PackedPatches.of(())) == 0
    assert len(packed[:5]) == len(patches)
    assert packed[-1].area == patches[-1].area


def test_a_row_of_a_plane_run_takes_less_than_3_kb() -> None:
    """Two wheels with two patches each; 7.7 kB at 06d44fc, 12 kB with contacts on strips."""
    contact, state = wheel_on_rail(), WheelsetState(y=0.0, z=-2e-4, speed=20.0, pitch_rate=20.0 / 0.46)
    rows, kept = list[Row](), list[int]()
    tracemalloc.start()
    for i in range(300):
        if i in (100, 299):
            gc.collect()
            kept.append(tracemalloc.get_traced_memory()[0])
        at = replace(state, y=1e-6 * i)
        contacts = {"wheelset": {side: contact(at, side) for side in SIDES}}
        rows.append(Row.of(0.1 * i, np.zeros(20), VehicleEvaluation(np.zeros(20), contacts)))
    tracemalloc.stop()
    assert sum(len(patches) for patches in rows[0].patches[0]) >= 2
    assert (kept[1] - kept[0]) / 199 < 3000.0
