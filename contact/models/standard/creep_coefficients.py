"""Kalker's coefficients of a pair of materials for the core."""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import PairElasticity
from wheelrail.contact.analytical.hertz import modulus
from wheelrail.contact.analytical.kalker import RATIO, Name, kalker
from wheelrail.contact.laws.material import Material

NAMES: tuple[Name, ...] = ("C11", "C22", "C23")


def pair_elasticity(upper: Material, lower: Material) -> PairElasticity:
    """Combined constants: 1/G and nu/G are means over both bodies. Raises ValueError for a mean Poisson's ratio
    below 0.
    """
    compliance = [2.0 * (1.0 + material.nu) / material.E for material in (upper, lower)]
    nu = (compliance[0] * upper.nu + compliance[1] * lower.nu) / (compliance[0] + compliance[1])
    rows = [[[kalker(name, ratio, nu) for name in NAMES] for ratio in ratios] for ratios in (RATIO, 1.0 / RATIO)]
    return PairElasticity(modulus((upper.E, upper.nu), (lower.E, lower.nu)), 2.0 / sum(compliance), np.array(rows))
