"""Kalker's coefficients of a pair of materials for compiled code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.analytical.kalker import RATIO, Name, kalker
from wheelrail.contact.laws.material import Material
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

NAMES: tuple[Name, ...] = ("C11", "C22", "C23")


class PairElasticity(NamedTuple):
    """E* [Pa] and shear modulus G [Pa] of two bodies together, and C11, C22, C23 (2, 10, 3) as `kalker` tabulates them:
    for a <= b, then for a >= b, at the ratios RATIO.
    """

    E_star: float
    G: float
    table: Array

    @classmethod
    def of(cls, upper: Material, lower: Material) -> PairElasticity:
        """1/G is the mean of both bodies', and so is nu/G. Raises ValueError for a mean Poisson's ratio below 0."""
        soft = [2.0 * (1.0 + steel.nu) / steel.E for steel in (upper, lower)]
        nu = (soft[0] * upper.nu + soft[1] * lower.nu) / (soft[0] + soft[1])
        rows = [[[kalker(name, ratio, nu) for name in NAMES] for ratio in ratios] for ratios in (RATIO, 1.0 / RATIO)]
        return cls(modulus((upper.E, upper.nu), (lower.E, lower.nu)), 2.0 / sum(soft), np.array(rows))


@compiled
def coefficients(table: Array, ratio: float) -> tuple[float, float, float]:
    """C11, C22, C23 at a / b, linear in the shorter over the longer semi-axis, as at 1/10 beyond that."""
    side = 1 if ratio > 1.0 else 0
    t = 10.0 * max(min(ratio, 1.0 / ratio), 0.1) - 1.0
    i = min(int(t), 8)
    t -= i
    one, other = table[side, i], table[side, i + 1]
    return (
        one[0] + t * (other[0] - one[0]),
        one[1] + t * (other[1] - one[1]),
        one[2] + t * (other[2] - one[2]),
    )
