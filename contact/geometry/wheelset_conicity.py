"""Equivalent conicity of a rigid wheelset, from its rolling radius difference over the lateral position."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.geometry.conicity import equivalent_conicity
from wheelrail.contact.geometry.first_contact import (
    FirstContact,
    RigidWheelset,
    contact_without_roll,
    first_contacts_over,
)
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array

FINEST = 1e-4  # m, largest spacing of the lateral positions for the equivalent conicity
BEND = 2e-5  # m, of the rolling radius difference from a line between positions, which are closer above it, down to
NARROW = 2e-6  # m
BEYOND = (5e-3, 4e-3, 3e-3, 2e-3, 1e-3, 0.0)  # m, tried in this order


def difference_with_roll(wheelset: RigidWheelset, y: Array) -> Array:
    """Rolling radius difference (n,) m at positions (n,) m of the wheelset that touches both rails."""
    touches = [touch for _, touch in first_contacts_over(wheelset, y)]
    left, right = (np.array([_rolling_radius(wheelset.on(side), touch[side]) for touch in touches]) for side in SIDES)
    return np.asarray(left - right)


def difference_without_roll(wheelset: RigidWheelset, y: Array) -> Array:
    """Rolling radius difference (n,) m at positions (n,) m of a wheelset that does not roll."""
    left, right = (
        _radii_without_roll(pair, hand * y) for pair, hand in ((wheelset, 1.0), (wheelset.on("right"), -1.0))
    )
    return np.asarray(left - right)


def _radii_without_roll(wheelset: RigidWheelset, y: Array) -> Array:
    """Rolling radii (n,) m of the left wheel at positions (n,) m, each sought from the height of the one before."""
    radii, z = np.empty(len(y)), 0.0
    for i, at in enumerate(y.tolist()):
        z, touch = contact_without_roll(wheelset, at, z)
        radii[i] = _rolling_radius(wheelset, touch)
    return radii


def _rolling_radius(wheelset: RigidWheelset, touch: FirstContact) -> float:
    return wheelset.pair.radius + float(wheelset.pair.wheel.point(touch.wheel_s)[1])


def wheelset_conicity(
    wheelset: RigidWheelset, amplitude: Array, difference_at: Callable[[RigidWheelset, Array], Array]
) -> Array:
    """Equivalent conicity (n,) at amplitudes (n,) m, in order.

    Parameters:
        wheelset: profiles and mounting.
        amplitude: (n,) m.
        difference_at: rolling radius difference (n,) m of the wheelset at positions (n,) m.

    The difference is sampled closer across its jumps and bends.
    """
    if not amplitude.size:
        return np.empty(0)
    y, difference = _sampled(wheelset, float(amplitude[-1]), difference_at)
    while len(wide := np.flatnonzero(_bent(y, difference) & (np.diff(y) > NARROW))):
        between = 0.5 * (y[wide] + y[wide + 1])
        difference = np.insert(difference, wide + 1, difference_at(wheelset, between))
        y = np.insert(y, wide + 1, between)
    base, radius = 2.0 * wheelset.mounting.wheel_y, wheelset.mounting.radius
    return equivalent_conicity(y, difference, amplitude, base=base, radius=radius)


def _bent(y: Array, difference: Array) -> NDArray[np.bool_]:
    """Which of the (n - 1) intervals between positions have an end away from the line between its neighbours."""
    part = np.diff(y)[:-1] / (y[2:] - y[:-2])
    away = np.abs(difference[:-2] + part * (difference[2:] - difference[:-2]) - difference[1:-1]) > BEND
    return np.asarray(np.concatenate([[False], away]) | np.concatenate([away, [False]]))


def _sampled(
    wheelset: RigidWheelset, amplitude: float, difference_at: Callable[[RigidWheelset, Array], Array]
) -> tuple[Array, Array]:
    """Positions (n,) m at most FINEST apart up to an amplitude m, and the rolling radius difference there.

    They start from 0 where the sides are alike. Sides that differ swing about another position, so that theirs reach
    farther to both sides, by BEYOND or as far as both wheels touch.
    """
    if wheelset.right is None:
        y = np.linspace(0.0, amplitude, max(2, int(np.ceil(amplitude / FINEST))) + 1)
        return y, difference_at(wheelset, y)
    for farther in BEYOND:
        reach = amplitude + farther
        y = np.linspace(-reach, reach, 2 * max(2, int(np.ceil(reach / FINEST))) + 1)
        try:
            return y, difference_at(wheelset, y)
        except ValueError:
            if farther == 0.0:
                raise
    raise AssertionError
