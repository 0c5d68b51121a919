"""Kalker's coefficients of a pair of materials for compiled code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.analytical.kalker import RATIO, Name, kalker
from wheelrail.contact.laws.material import Material
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing

NAMES: tuple[Name, ...] = ("C11", "C22", "C23")


class PairElasticity(NamedTuple):
    """Combined elastic constants of two bodies.

    Parameters:
        E_star: Pa.
        G: combined shear modulus, Pa.
        table: (2, 10, 3), C11, C22, C23 of `kalker` for a <= b, then for a >= b, at the ratios RATIO.
    """

    E_star: float
    G: float
    table: Array

    @classmethod
    def of(cls, upper: Material, lower: Material) -> PairElasticity:
        """1/G and nu/G are means over both bodies. Raises ValueError for a mean Poisson's ratio below 0."""
        compliance = [2.0 * (1.0 + material.nu) / material.E for material in (upper, lower)]
        nu = (compliance[0] * upper.nu + compliance[1] * lower.nu) / (compliance[0] + compliance[1])
        rows = [[[kalker(name, ratio, nu) for name in NAMES] for ratio in ratios] for ratios in (RATIO, 1.0 / RATIO)]
        return cls(modulus((upper.E, upper.nu), (lower.E, lower.nu)), 2.0 / sum(compliance), np.array(rows))


@borrowing
def coefficients(table: Array, ratio: float) -> tuple[float, float, float]:
    """C11, C22, C23 at a / b, linear in the shorter over the longer semi-axis; constant below a ratio of 1/10."""
    side = 1 if ratio > 1.0 else 0
    t = 10.0 * max(min(ratio, 1.0 / ratio), 0.1) - 1.0
    i = min(int(t), 8)
    t -= i
    low, high = table[side, i], table[side, i + 1]
    return (
        low[0] + t * (high[0] - low[0]),
        low[1] + t * (high[1] - low[1]),
        low[2] + t * (high[2] - low[2]),
    )
