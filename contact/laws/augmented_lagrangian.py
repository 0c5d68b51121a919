"""Exact laws from regularised ones, by an augmented Lagrangian.

Penalty K and regularisation eps stay finite, and multipliers remove their bias: p = K max(d + lambda / K, 0) with
lambda = p is 0 <= p, d <= 0; friction that is viscous in s - eps m with m = q / b is Coulomb's in s. The multipliers
are the tractions of the previous solution and enter as offsets of d and s.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wheelrail.contact.laws.normal import Penalty
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.support.arrays import Array

PENALTY = 30.0  # times Young's modulus over the surface size; the stiffest mode of the surface has about 3
REGULARISATION = 1e-5
LOOPS = 60  # augmented-Lagrangian iterations


def softened(laws: ContactLaws, *, modulus: float, size: float) -> ContactLaws:
    """The laws with a finite penalty and regularisation.

    Parameters:
        laws: their own finite values are retained, others are chosen for fast convergence of the multipliers.
        modulus: Young's modulus, Pa.
        size: surface size, m.
    """
    regularised = replace(laws, regularisation=laws.regularisation or REGULARISATION)
    return replace(regularised, normal=Penalty(PENALTY * modulus / size)) if laws.exact_normal else regularised


def offset(laws: ContactLaws, regularised: ContactLaws, traction: Array, slip: Array, speed: float) -> Array:
    """Offsets (n, c) of penetration and slip by the multipliers.

    Parameters:
        laws, regularised: the laws, and those of `softened`.
        traction: (n, c) Pa, along the wheel's normal first.
        slip: (n, c - 1) over the rolling speed, to which the tractions belong.
        speed: m/s.
    """
    offsets = np.zeros(traction.shape)
    if laws.exact_normal:
        assert regularised.normal_compliance is not None
        offsets[:, 0] = -traction[:, 0] * regularised.normal_compliance
    if traction.shape[1] == 3 and not laws.regularisation:
        bound = laws.friction_bound(-traction[:, 0], np.hypot(*slip.T), speed)
        ratio = traction[:, 1:] / np.maximum(bound, 1e-300)[:, None]
        # before convergence the bound may be smaller than the traction
        offsets[:, 1:] = -regularised.regularisation * ratio / np.maximum(np.hypot(*ratio.T), 1.0)[:, None]
    return offsets
