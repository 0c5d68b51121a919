"""State vector of the plane wagon: ten coordinates, their rates, spring deflections of Maxwell elements, and motions of
axle and rails where these are elastic.
"""

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
MIRROR = np.tile(
    [-1.0, 1.0, -1.0, -1.0, 1.0, -1.0, -1.0, 1.0, -1.0, 1.0], 2
)  # signs of the mirrored coordinates and rates


def mirrored(state: Array) -> Array:
    """States (..., 20 + m) mirrored at y = 0; the Maxwell elements of left and right are exchanged."""
    left, right = np.split(state[..., 2 * COUNT :], 2, axis=-1)
    return np.concatenate([MIRROR * state[..., : 2 * COUNT], right, left], axis=-1)


class Split(NamedTuple):
    """Parts of a state.

    Parameters:
        position, rate: (..., 3, 3) y m, z m, roll rad of the three bodies, and their rates.
        pitch, pitch_rate: (...) rad and rad/s of the wheelset.
        series: (..., m) m, spring deflections of Maxwell elements, outwards, left side first.
        motions: (..., k) m and rad, of axle and rails, see `wheelrail.contact.loading.quasi_static_structure`.
    """

    position: Array
    rate: Array
    pitch: Array
    pitch_rate: Array
    series: Array
    motions: Array


def split(state: Array, motions: int = 0) -> Split:
    """Parts of states (..., 20 + m + k): y, z in m (z from the nominal height), angles in rad, rates per second.

    The pitch is measured from nominal rolling, s(t) / r: tolerances then apply to the creepage and not to the speed.

    Parameters:
        state: of the wagon.
        motions: their number k.
    """
    end = state.shape[-1] - motions
    shape = (*state.shape[:-1], 3, 3)
    position, rate = state[..., :9].reshape(shape), state[..., 10:19].reshape(shape)
    return Split(position, rate, state[..., 9], state[..., 19], state[..., 2 * COUNT : end], state[..., end:])


RATE_SCALE = 100.0  # 1/s


def graded(atol: float, size: int = 2 * COUNT, velocities: int = 0) -> Array:
    """Absolute tolerances (size,) of a state for implicit steps: atol in m and rad, 100 atol in m/s and rad/s.

    Motions that such steps do not resolve decay within 10 ms: an error of a rate then changes the position by no more
    than its tolerance.

    Parameters:
        atol: of positions, m and rad.
        size: of the state.
        velocities: number of rates at its end, of a track with mass.
    """
    tolerances = np.full(size, float(atol))
    tolerances[COUNT : 2 * COUNT] *= RATE_SCALE
    tolerances[size - velocities :] *= RATE_SCALE
    return tolerances
