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

from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled

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


@compiled
def strip_antiderivative(x: Array, sides: Array, nu: float) -> Array:
    """G (pairs, nodes, 4) at distances x (nodes,) of which the second derivative is the mean compliance between strips
    with sides (S, 2), row by row of the pairs i <= j; unit modulus, components as above. The last one is odd in x, the
    others are even.
    """
    S = len(sides)
    where, apart, place = _distances(sides)
    found = np.empty((S * (S + 1) // 2, len(x), 4))
    known = np.empty((3, len(apart)))
    for k in range(len(x)):
        for d in range(len(apart)):
            known[0, d], known[1, d], known[2, d] = _fourfold(abs(x[k]), apart[d])
        turn = 1.0 if x[k] >= 0.0 else -1.0
        at = 0
        for i in range(S):
            for j in range(i, S):
                low, high, first, last = where[i, 0], where[i, 1], where[j, 0], where[j, 1]
                # distances of upper and lower sides, crosswise and alike
                up, down, lows, highs = place[high, first], place[low, last], place[low, first], place[high, last]
                xx = known[0, up] + known[0, down] - known[0, lows] - known[0, highs]
                yy = known[1, up] + known[1, down] - known[1, lows] - known[1, highs]
                xy = 0.0  # odd across: nothing on the strip itself, and i lies below j
                if i != j:
                    xy = known[2, lows] + known[2, highs] - known[2, down] - known[2, up]
                scale = (1.0 + nu) / np.pi / ((sides[i, 1] - sides[i, 0]) * (sides[j, 1] - sides[j, 0]))
                found[at, k, 0] = scale * ((1.0 - nu) * (xx + yy) + nu * xx)
                found[at, k, 1] = scale * ((1.0 - nu) * (xx + yy) + nu * yy)
                found[at, k, 2] = scale * (1.0 - nu) * (xx + yy)
                found[at, k, 3] = turn * scale * nu * xy
                at += 1
    return found


@compiled
def _distances(sides: Array) -> tuple[Nodes, Array, Nodes]:
    """Which of the E different sides are whose (S, 2), the different distances (D,) between them, and which they are
    (E, E): sides of neighbours are the same, and strips alike.
    """
    span = sides.max() - sides.min()
    ordered = np.sort(sides.ravel())
    edges = ordered[np.concatenate((np.ones(1, dtype=np.bool_), np.diff(ordered) > 1e-9 * span))]
    where = np.searchsorted(edges, sides.ravel() - 1e-9 * span).reshape(sides.shape)
    E = len(edges)
    between = np.abs(edges.reshape(-1, 1) - edges.reshape(1, -1)).ravel()
    order = np.argsort(between)
    place = np.empty(E * E, dtype=np.int64)
    apart = np.empty(E * E)
    count = 0
    for at in order:
        if count == 0 or between[at] - apart[count - 1] > 1e-11 * span:
            apart[count] = between[at]
            count += 1
        place[at] = count - 1
    return where, apart[:count], place.reshape(E, E)


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


@compiled
def _fourfold(x: float, y: float) -> tuple[float, float, float]:
    """Antiderivatives, twice in x and twice in y, of x^2/r^3, y^2/r^3 and x y/r^3 at x, y >= 0; the first two add up to
    that of 1/r.
    """
    r = np.sqrt(x * x + y * y)
    over_x = np.arcsinh(y / x) if x > 0.0 else 0.0
    over_y = np.arcsinh(x / y) if y > 0.0 else 0.0
    a, b, c = 0.5 * x * x * y * over_x, 0.5 * x * y * y * over_y, r * r * r / 6.0
    cross = -(x * y * r / 3.0 + x * x * x / 6.0 * over_x + y * y * y / 6.0 * over_y)
    return c + b - 0.5 * y * y * r, c + a - 0.5 * x * x * r, cross


def _waves(k: Array, y: Array) -> Array:
    return np.asarray(np.maximum(np.outer(k, y), 1e-12))


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
