"""The state of the plane wagon as one array: ten coordinates, their rates, springs in series with dampers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array

COORDINATES = (
    "car_body_y",
    "car_body_z",
    "car_body_roll",
    "bogie_y",
    "bogie_z",
    "bogie_roll",
    "wheelset_y",
    "wheelset_z",
    "wheelset_roll",
    "wheelset_pitch",
)
COUNT = len(COORDINATES)
Y, Z, ROLL, PITCH = 6, 7, 8, 9  # of the wheelset
MIRROR = np.tile([-1.0, 1.0, -1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0, 1.0], 2)  # coordinates and rates seen in a mirror


def mirrored(state: Array) -> Array:
    """States (..., 20 + m) seen in a mirror at y = 0, where left and right springs in series with dampers swap."""
    left, right = np.split(state[..., 2 * COUNT :], 2, axis=-1)
    return np.concatenate([MIRROR * state[..., : 2 * COUNT], right, left], axis=-1)


class Split(NamedTuple):
    """position, rate (..., 3, 3): y, z, roll of the three bodies, and their rates; pitch and its rate (...); series
    (..., m): deflections of the springs in series with dampers, outwards, left side first.
    """

    position: Array
    rate: Array
    pitch: Array
    pitch_rate: Array
    series: Array


def split(state: Array) -> Split:
    """Parts of states (..., 20 + m): y, z in m (z from the nominal height), angles in rad, rates per second.

    The pitch counts what exceeds nominal rolling, s(t) / r: tolerances then bear on the creepage and not on the speed.
    """
    shape = (*state.shape[:-1], 3, 3)
    position, rate = state[..., :9].reshape(shape), state[..., 10:19].reshape(shape)
    return Split(position, rate, state[..., 9], state[..., 19], state[..., 2 * COUNT :])


RATE_SCALE = 100.0  # 1/s


def graded(atol: float, size: int = 2 * COUNT) -> Array:
    """Absolute tolerance of each component of a state for implicit steps: atol in m and rad, and 100 times that per
    second for rates.

    What such steps go over fades within 10 ms, so that a rate moves a position by as much as the tolerance of a
    position.
    """
    each = np.full(size, float(atol))
    each[COUNT : 2 * COUNT] *= RATE_SCALE
    return each
