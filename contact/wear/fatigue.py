"""Fatigue of surfaces in rolling contact, patch by patch: surface fatigue index, damage by T-gamma, crack direction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from wheelrail.contact.results.result import Patch
from wheelrail.contact.stress.shakedown import load_factor, surface_fatigue_index, utilisation
from wheelrail.support.arrays import Array

# N and damage of a passage: M. Burstow, whole life rail model, RSSB. Remembered values, not compared with the report.
WHOLE_LIFE_RAIL = ((0.0, 0.0), (15.0, 0.0), (65.0, 1e-5), (175.0, 0.0))


def whole_life_rail_damage(t_gamma: Array) -> Array:
    """Damage (k,) of a passage by T-gamma (k,) N of a patch.

    Cracks start from 15 N; above 175 N, where wear removes them, it is negative, with the slope before.
    """
    at, damage = np.array(WHOLE_LIFE_RAIL).T
    beyond = np.maximum(t_gamma - at[-1], 0.0)
    return np.asarray(np.interp(t_gamma, at, damage) + beyond * (damage[-1] - damage[-2]) / (at[-1] - at[-2]))


def ratcheting(patches: Sequence[Patch], shear_yield: float) -> Array:
    """Surface fatigue index (k,) of patches that ratchet, else 0.

    Parameters:
        patches: k of them.
        shear_yield: yield stress in shear, Pa.

    Raises ValueError unless this is positive.
    """
    if not shear_yield > 0.0:
        raise ValueError(f"shear_yield = {shear_yield}: must be positive, Pa")
    if not patches:
        return np.zeros(0)
    used = utilisation(
        np.array([patch.normal_force for patch in patches]), np.array([patch.tangential_force for patch in patches])
    )
    loaded = load_factor(np.array([patch.max_pressure for patch in patches]), shear_yield)
    return np.maximum(surface_fatigue_index(used, loaded), 0.0)


def direction(traction: Array) -> Array:
    """Angle (n,) rad of sums of traction (n, 2) from forward to the field side; NaN without traction.

    Cracks of ratcheting surfaces run across it.
    """
    along, across = traction.T
    return np.where((along != 0.0) | (across != 0.0), np.arctan2(across, along), np.nan)
