"""States and results of a wheelset's contact as plain arrays, in the order of `wheelrail.api.elements.variables`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wheelrail.api.elements.checks import OFFSET, RANGES, RATE
from wheelrail.api.elements.variables import INPUTS, PATCH
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.support.arrays import Array

LIMITS = tuple(
    RANGES.get(variable.name, RATE if variable.name.startswith("frame_rate") else OFFSET) for variable in INPUTS
)
_ENDS = tuple((limits.low, limits.high) for limits in LIMITS)


def invalid_input(values: Sequence[float]) -> str:
    """First input that is not a number in its range, with the range; empty where there is none.

    Parameters:
        values: (17,) in the order of INPUTS.
    """
    for number, (value, (low, high)) in enumerate(zip(values, _ENDS, strict=True)):
        if not low <= value <= high:
            return f"{INPUTS[number].name} = {value!r}: must be {LIMITS[number]}"
    return ""


def state_of(values: Sequence[float]) -> WheelsetState:
    """State of the wheelset of numbers (17,) in the order of INPUTS."""
    y, z, roll, yaw, y_rate, z_rate, roll_rate, yaw_rate, pitch_rate, speed, *track = values
    frame_rate, rail_shift = (track[0], track[1], track[2]), ((track[3], track[4]), (track[5], track[6]))
    rates = y_rate, z_rate, roll_rate, yaw_rate, pitch_rate
    return WheelsetState(y, z, roll, yaw, *rates, speed, frame_rate, rail_shift)


def inputs_of(state: WheelsetState) -> Array:
    """Array (17,) of a state of the wheelset."""
    (left_y, left_z), (right_y, right_z) = state.rail_shift or ((0.0, 0.0), (0.0, 0.0))
    coordinates = [getattr(state, name) for name in WheelsetState.coordinates]
    return np.array([*coordinates, state.speed, *state.frame_rate, left_y, left_z, right_y, right_z], dtype=float)


def write_outputs(results: Sequence[ContactResult], outputs: Array) -> None:
    """Write forces, moments and approaches of both sides; forces of one that failed are NaN.

    Parameters:
        results: of the left and the right side.
        outputs: (14,).
    """
    for side, result in enumerate(results):
        first = 6 * side
        outputs[first : first + 3] = result.force if result.ok else np.nan
        outputs[first + 3 : first + 6] = result.moment if result.ok else np.nan
        outputs[12 + side] = result.approach


def patch_values(patches: Sequence[Patch]) -> Array:
    """The patch with the largest normal force of a side, (13,); zeros where there is none."""
    if not patches:
        return np.zeros(len(PATCH))
    patch = max(patches, key=lambda candidate: candidate.normal_force)
    return np.array(
        [
            len(patches),
            patch.area,
            patch.max_pressure,
            patch.normal_force,
            *patch.tangential_force,
            *patch.semi_axes,
            patch.contact_angle,
            patch.wheel_y,
            patch.rail_y,
            patch.stick_area,
            patch.frictional_power,
        ]
    )
