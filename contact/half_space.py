"""Strips on a half-space: flexibility by wavenumbers and by distance along x, in closed form (Boussinesq and Cerruti).

A unit force displaces its own direction at (x, y) by 1/(2 pi G) times (1 - nu)/r along the normal, (1 - nu)/r + nu
x^2/r^3 along x and (1 - nu)/r + nu y^2/r^3 across; x and across are coupled by nu x y/r^3 (Johnson 1985, eqs. 3.19,
3.75).
Means over strips, and over cells along x, are second differences of antiderivatives.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.special import iti0k0, k0, k1

from contact.pose import Array

TERMS = 40  # of the series of the correction, for arguments up to 10


def strip_flexibility(k: Array, rows: Array, columns: Array, nu: float, floor: float) -> Array:
    """Mean displacement (nk, R, C, 4) of strips rows (R, 2) by unit loads per length along x, waves of wavenumbers k
    (nk,), spread over strips columns (C, 2); unit modulus.

    Components: along x, across, normal, and along x by across (sine by cosine). 1/r goes like ln k at k = 0, and is
    taken at sqrt(k^2 + floor^2) instead; see `floor_correction`.
    """

    def twice(z: Array) -> Array:  # second antiderivative of K0
        once = z * k1(z)
        return np.asarray(np.where(z < 40.0, z * iti0k0(np.minimum(z, 40.0))[1], 0.5 * np.pi * z) + once - 1.0)

    def turned(z: Array) -> Array:  # of z K0
        return np.asarray(z * k0(z) - np.where(z < 40.0, iti0k0(np.minimum(z, 40.0))[1], 0.5 * np.pi))

    widths = (rows[:, 1] - rows[:, 0])[:, None] * (columns[:, 1] - columns[:, 0])
    raised, plain = np.hypot(k, floor), np.maximum(k, 1e-9 * k[-1])
    K0 = second_difference(rows, columns, lambda y: twice(_waves(raised, y)), 0.0)
    zK1 = second_difference(rows, columns, lambda y: _waves(raised, y) * k1(_waves(raised, y)), 1.0) + K0
    yK0 = second_difference(rows, columns, lambda y: turned(_waves(plain, y)), 0.0, odd=True)
    scale = 2 * (1 + nu) / np.pi / (raised[:, None, None] ** 2 * widths)
    cross = 2 * (1 + nu) / np.pi / (plain[:, None, None] ** 2 * widths)
    return np.stack(
        [(K0 - nu * zK1) * scale, ((1 - nu) * K0 + nu * zK1) * scale, (1 - nu) * K0 * scale, nu * yK0 * cross], axis=-1
    )


def strip_antiderivative(x: Array, sides: Array, nu: float, *, tangential: bool = True) -> Array:
    """G (nodes, S, S, 4) at distances x (nodes,) >= 0 of which the second derivative is the mean compliance between
    strips with sides (S, 2); unit modulus, components as above, or across and normal alone (2).
    """
    widths = sides[:, 1] - sides[:, 0]
    scale = (1 + nu) / np.pi / (widths[:, None] * widths)

    known: list[tuple[Array, Array, Array, Array]] = []

    def part(which: int) -> Callable[[Array], Array]:
        def of(y: Array) -> Array:
            if not known:  # the distances are the same for all components
                known.append(_fourfold(x[:, None], y))
            return known[0][which]

        return of

    still = _fourfold(x, np.zeros(1))
    inverse, yy = (second_difference(sides, sides, part(which), still[which]) for which in (0, 2))
    if not tangential:
        return np.stack([((1 - nu) * inverse + nu * yy) * scale, (1 - nu) * inverse * scale], axis=-1)
    xx = second_difference(sides, sides, part(1), still[1])
    xy = second_difference(sides, sides, part(3), 0.0, odd=True)
    parts = [(1 - nu) * inverse + nu * xx, (1 - nu) * inverse + nu * yy, (1 - nu) * inverse, nu * xy]
    return np.stack([value * scale for value in parts], axis=-1)


def floor_correction(x: Array, floor: float, nu: float) -> Array:
    """G (nodes, 3) at distances x (nodes,) that the flexibility at sqrt(k^2 + floor^2) lacks: along x, across, normal.

    Between ln k and its floored form lies a compliance (1 - exp(-floor x)) / (2 x), the same for all strips.
    """
    z = floor * np.abs(x)
    total, term = np.zeros_like(z), np.ones_like(z)
    for m in range(TERMS):
        total += term / ((m + 1) * (m + 1) * (m + 2))  # z^m (-1)^m / m! by then
        term *= -z / (m + 1)
    both = 2 * (1 + nu) / np.pi * 0.5 * floor * x * x * total
    return np.asarray(both[:, None] * np.array([1.0, 1 - nu, 1 - nu]))


def _fourfold(x: Array, y: Array) -> tuple[Array, Array, Array, Array]:
    """Antiderivatives, twice in x and twice in y, of 1/r, x^2/r^3, y^2/r^3 and x y/r^3 at x, y >= 0."""
    r = np.hypot(x, y)
    over_x, over_y = np.arcsinh(y / np.maximum(x, 1e-300)), np.arcsinh(x / np.maximum(y, 1e-300))
    a, b, c = 0.5 * x * x * y * over_x, 0.5 * x * y * y * over_y, r**3 / 6
    cross = -(x * y * r / 3 + x**3 / 6 * over_x + y**3 / 6 * over_y)
    return a + b - c, c + b - 0.5 * y * y * r, c + a - 0.5 * x * x * r, cross


def _waves(k: Array, y: Array) -> Array:
    return np.maximum(np.outer(k, y), 1e-12)


def second_difference(
    rows: Array, columns: Array, of: Callable[[Array], Array], same: Array | float, *, odd: bool = False
) -> Array:
    """Second difference (m, R, C) over the sides of rows (R, 2) and columns (C, 2) of a function (m, n) of the distance
    (n,) > 0 between them; same is its value at zero. It changes sign with the distance if odd.

    The sides of neighbours are the same, and strips alike: few distances have to be looked at.
    """
    edges, where = np.unique(np.concatenate([rows.ravel(), columns.ravel()]), return_inverse=True)
    row, column = where[: rows.size].reshape(rows.shape), where[rows.size :].reshape(columns.shape)
    one, other = np.triu_indices(len(edges), 1)
    span = np.ptp(edges)
    apart, place = np.unique(np.round((edges[other] - edges[one]) / span, 12), return_inverse=True)
    values = of(np.maximum(apart, 1e-12) * span)
    v = np.empty((len(values), len(edges), len(edges)))
    v[:] = np.asarray(same).reshape(-1, 1, 1)
    v[:, other, one] = values[:, place]
    v[:, one, other] = -values[:, place] if odd else values[:, place]
    if (row[:, 1] == row[:, 0] + 1).all() and (column[:, 1] == column[:, 0] + 1).all():
        steps = np.diff(np.diff(v, axis=1), axis=2)
        return np.asarray(-steps[:, row[:, 0]][:, :, column[:, 0]])
    ends = [v[:, row[:, i]][:, :, column[:, j]] for i, j in ((1, 0), (0, 1), (0, 0), (1, 1))]
    return np.asarray(ends[0] + ends[1] - ends[2] - ends[3])
