"""Flexibility of a half-space for strips loaded by waves along x: closed form, Boussinesq and Cerruti by wavenumbers.

A line load cos(k x) displaces its own direction at a distance y by 1/(pi G) times (1 - nu) K0 along the normal,
K0 - nu z K1 along x and (1 - nu) K0 + nu z K1 across, z = k |y|: the transforms of 1/r and x^2/r^3. Means over strips
are second differences of antiderivatives over their widths.
"""

from __future__ import annotations

import numpy as np
from scipy.special import iti0k0, k1

from contact.pose import Array


def strip_flexibility(k: Array, rows: Array, columns: Array, nu: float) -> Array:
    """Mean displacement (nk, R, C, 3) along x, across and normal of strips rows (R, 2) by unit loads per length along x
    spread over strips columns (C, 2), unit modulus; wavenumbers k (nk,) > 0.
    """
    z = k[:, None, None, None, None] * np.abs(rows[:, :, None, None] - columns)
    shape = z.shape
    flat = np.maximum(z.ravel(), 1e-12)
    once = flat * k1(flat)
    # second antiderivatives of K0 and of z K1
    twice = np.where(flat < 40.0, flat * iti0k0(np.minimum(flat, 40.0))[1], 0.5 * np.pi * flat) + once - 1.0
    widths = (rows[:, 1] - rows[:, 0])[:, None] * (columns[:, 1] - columns[:, 0])
    scale = 2 * (1 + nu) / np.pi / (k[:, None, None] ** 2 * widths)

    def mean(values: Array) -> Array:
        v = values.reshape(shape)
        return np.asarray((v[:, :, 1, :, 0] + v[:, :, 0, :, 1] - v[:, :, 0, :, 0] - v[:, :, 1, :, 1]) * scale)

    K0, zK1 = mean(twice), mean(once + twice)
    return np.stack([K0 - nu * zK1, (1 - nu) * K0 + nu * zK1, (1 - nu) * K0], axis=-1)
