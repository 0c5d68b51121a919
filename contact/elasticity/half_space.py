"""Strips on a half-space: flexibility by wavenumbers and by distance along x, in closed form (Boussinesq, Cerruti).

The displacement by a unit force in its own direction at (x, y) is 1/(2 pi G) times (1 - nu)/r along the normal, (1 -
nu)/r + nu x^2/r^3 along x and (1 - nu)/r + nu y^2/r^3 across; x and across are coupled by nu x y/r^3. A force along the
outward normal displaces the surface by (1/2 - nu) x/r^2 along x and (1/2 - nu) y/r^2 across, away from itself (Johnson
1985, eqs. 3.18, 3.19, 3.75); tangential forces displace it along the normal by the same with the opposite sign. Means
over strips, and over cells along x, are second differences of antiderivatives.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.special import iti0k0, k0, k1

from wheelrail.support.arrays import Array

TERMS = 40  # of the series of `cutoff_correction`, for arguments up to 10


def strip_flexibility(k: Array, rows: Array, columns: Array, nu: float, cutoff: float) -> Array:
    """Mean displacement (nk, R, C, 6) of strips by harmonic unit loads per length along x on strips; unit modulus.

    Parameters:
        k: (nk,) 1/m, wavenumbers.
        rows, columns: (R, 2) and (C, 2) m, lateral bounds of displaced and of loaded strips.
        nu: Poisson's ratio.
        cutoff: 1/m, low-wavenumber cut-off: the transform of 1/r, singular like ln k at k = 0, is taken at
            sqrt(k^2 + cutoff^2); see `cutoff_correction`.

    Components: along x, across, normal, along x by across (sine by cosine), along x by normal (sine by cosine), and
    across by normal; the last two for outward normals, bounded at k = 0.
    """

    def second_antiderivative(z: Array) -> Array:  # second antiderivative of K0
        once = z * k1(z)
        return np.asarray(np.where(z < 40.0, z * iti0k0(np.minimum(z, 40.0))[1], 0.5 * np.pi * z) + once - 1.0)

    def antiderivative(z: Array) -> Array:  # of z K0
        return np.asarray(z * k0(z) - np.where(z < 40.0, iti0k0(np.minimum(z, 40.0))[1], 0.5 * np.pi))

    def exponential(z: Array) -> Array:  # second antiderivative of exp(-z)
        return np.asarray(np.where(z < 0.5, _exponential_series(z), np.expm1(-z) + z))

    widths = (rows[:, 1] - rows[:, 0])[:, None] * (columns[:, 1] - columns[:, 0])
    regularised, plain = np.hypot(k, cutoff), np.maximum(k, 1e-9 * k[-1])
    K0 = second_difference(rows, columns, lambda y: second_antiderivative(_phases(regularised, y)), 0.0)
    zK1 = second_difference(rows, columns, lambda y: _phases(regularised, y) * k1(_phases(regularised, y)), 1.0) + K0
    yK0 = second_difference(rows, columns, lambda y: antiderivative(_phases(plain, y)), 0.0, odd=True)
    decay = second_difference(rows, columns, lambda y: exponential(_phases(plain, y)), 0.0)
    signed = second_difference(rows, columns, lambda y: exponential(_phases(plain, y)), 0.0, odd=True)
    scale = 2 * (1 + nu) / np.pi / (regularised[:, None, None] ** 2 * widths)
    cross = 2 * (1 + nu) / np.pi / (plain[:, None, None] ** 2 * widths)
    normal = 0.25 * np.pi * (1 - 2 * nu) * cross
    return np.stack(
        [
            (K0 - nu * zK1) * scale,
            ((1 - nu) * K0 + nu * zK1) * scale,
            (1 - nu) * K0 * scale,
            nu * yK0 * cross,
            decay * normal,
            signed * normal,
        ],
        axis=-1,
    )


def cutoff_correction(x: Array, cutoff: float, nu: float) -> Array:
    """G (nodes, 3) missing in the flexibility at sqrt(k^2 + cutoff^2): along x, across, normal; equal for all strips.

    Parameters:
        x: (nodes,) m, distances.
        cutoff: 1/m, low-wavenumber cut-off.
        nu: Poisson's ratio.

    The difference of ln k and its regularised form is a compliance (1 - exp(-cutoff x)) / (2 x).
    """
    z = cutoff * np.abs(x)
    total, term = np.zeros_like(z), np.ones_like(z)
    for m in range(TERMS):
        total += term / ((m + 1) * (m + 1) * (m + 2))  # term: z^m (-1)^m / m!
        term *= -z / (m + 1)
    correction = 2 * (1 + nu) / np.pi * 0.5 * cutoff * x * x * total
    return np.asarray(correction[:, None] * np.array([1.0, 1 - nu, 1 - nu]))


def _exponential_series(z: Array) -> Array:
    """exp(-z) + z - 1 to 1e-15 at z < 0.5, without cancellation."""
    total = np.ones_like(z)
    for m in range(16, 2, -1):
        total = 1.0 - total * z / m
    return np.asarray(0.5 * z * z * total)


def _phases(k: Array, y: Array) -> Array:
    return np.asarray(np.maximum(np.outer(k, y), 1e-12))


def second_difference(
    rows: Array, columns: Array, of: Callable[[Array], Array], same: Array | float, *, odd: bool = False
) -> Array:
    """Second difference (m, R, C) over the bounds of strips of a function of their distance.

    Parameters:
        rows, columns: (R, 2) and (C, 2), bounds.
        of: function (m, n) of distances (n,) > 0.
        same: its value at zero.
        odd: whether it changes sign with the distance.

    The function is evaluated at the distinct distances only: neighbouring strips share bounds.
    """
    edges, number = np.unique(np.concatenate([rows.ravel(), columns.ravel()]), return_inverse=True)
    row, column = number[: rows.size].reshape(rows.shape), number[rows.size :].reshape(columns.shape)
    first, second = np.triu_indices(len(edges), 1)
    span = np.ptp(edges)
    distances, position = np.unique(np.round((edges[second] - edges[first]) / span, 12), return_inverse=True)
    values = of(np.maximum(distances, 1e-12) * span)
    v = np.empty((len(values), len(edges), len(edges)))
    v[:] = np.asarray(same).reshape(-1, 1, 1)
    v[:, second, first] = values[:, position]
    v[:, first, second] = -values[:, position] if odd else values[:, position]
    if (row[:, 1] == row[:, 0] + 1).all() and (column[:, 1] == column[:, 0] + 1).all():
        steps = np.diff(np.diff(v, axis=1), axis=2)
        return np.asarray(-steps[:, row[:, 0]][:, :, column[:, 0]])
    ends = [v[:, row[:, i]][:, :, column[:, j]] for i, j in ((1, 0), (0, 1), (0, 0), (1, 1))]
    return np.asarray(ends[0] + ends[1] - ends[2] - ends[3])
