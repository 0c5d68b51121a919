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
    edges, where = np.unique(np.concatenate([rows.ravel(), columns.ravel()]), return_inverse=True)
    row, column = where[: rows.size].reshape(rows.shape), where[rows.size :].reshape(columns.shape)
    one, other = np.triu_indices(len(edges), 1)
    apart, place = np.unique(np.round((edges[other] - edges[one]) / np.ptp(edges), 12), return_inverse=True)
    z = np.maximum(np.outer(k, apart * np.ptp(edges)), 1e-12)
    once = z * k1(z)
    # second antiderivatives of K0 and of z K1
    twice = np.where(z < 40.0, z * iti0k0(np.minimum(z, 40.0))[1], 0.5 * np.pi * z) + once - 1.0
    widths = (rows[:, 1] - rows[:, 0])[:, None] * (columns[:, 1] - columns[:, 0])
    scale = 2 * (1 + nu) / np.pi / (k[:, None, None] ** 2 * widths)

    def mean(values: Array, same: float) -> Array:
        v = np.full((len(k), len(edges), len(edges)), same)
        v[:, one, other] = v[:, other, one] = values[:, place]
        ends = [v[:, row[:, i]][:, :, column[:, j]] for i, j in ((1, 0), (0, 1), (0, 0), (1, 1))]
        return np.asarray((ends[0] + ends[1] - ends[2] - ends[3]) * scale)

    K0, zK1 = mean(twice, 0.0), mean(once + twice, 1.0)
    return np.stack([K0 - nu * zK1, (1 - nu) * K0 + nu * zK1, (1 - nu) * K0], axis=-1)
