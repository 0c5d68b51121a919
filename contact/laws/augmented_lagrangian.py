"""Exact laws from soft ones, by an augmented Lagrangian.

Penalty K and regularisation eps stay finite, and the answer's own tractions, the multipliers, take their bias away:
p = K max(d + lambda / K, 0) with lambda = p is 0 <= p, d <= 0; friction that is viscous in s - eps m with m = q / b is
Coulomb's in s. Multipliers are taken from the answer, and only move what the law is told of d and s.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.support.arrays import Array

PENALTY = 30.0  # times Young's modulus over the surface size: the stiffest ripple of the surface has about 3
REGULARISATION = 1e-5
LOOPS = 60


def softened(laws: ContactLaws, *, modulus: float, size: float) -> ContactLaws:
    """The laws with a finite penalty and regularisation: their own, or some that make multipliers converge fast.

    modulus Pa and surface size m.
    """
    soft = replace(laws, regularisation=laws.regularisation or REGULARISATION)
    return soft if laws.normal_compliance else replace(soft, stiffness_per_area=PENALTY * modulus / size)


def offset(laws: ContactLaws, soft: ContactLaws, traction: Array, slip: Array, speed: float) -> Array:
    """What multipliers add to overlap and slip (n, c), from tractions (n, c) Pa, along the wheel's normal first, and
    the slip (n, c - 1) that they belong to.
    """
    added = np.zeros(traction.shape)
    if not laws.normal_compliance:
        added[:, 0] = -traction[:, 0] * soft.normal_compliance
    if traction.shape[1] == 3 and not laws.regularisation:
        bound = -traction[:, 0] * laws.friction_at(np.hypot(*slip.T), speed)[0]
        share = traction[:, 1:] / np.maximum(bound, 1e-300)[:, None]
        # a bound that has not settled may lie below the traction
        added[:, 1:] = -soft.regularisation * share / np.maximum(np.hypot(*share.T), 1.0)[:, None]
    return added
