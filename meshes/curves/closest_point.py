"""Closest points of a curve, compiled: Newton's method on the curve, started from fine samples."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array, Complex
from wheelrail.support.compiled import borrowing, fma, unchecked

SPACING = 1e-4  # m, of the samples, and the longest step
STRIDE = 8  # samples between those of the first, coarse search
HOLLOW = 0.3  # rad, more than the waves of a worn or measured rail
SMALL_STEP = 3e-8  # m; the error after one more step is quadratic in it, below 1e-12 m
_FAST, _SAFE = 4, 1000


class Closest(NamedTuple):
    """Closest points of the curve to n points.

    Parameters:
        s: (n,) m, arc length.
        distance: (n,) m, positive on the outward side.
        inside: (n,), False where the closest point is an end of the curve and the point lies beyond it.
    """

    s: Array
    distance: Array
    inside: NDArray[np.bool_]


class Shape(NamedTuple):
    """A curve of m pieces for compiled code.

    Parameters:
        breaks: (m + 1,) m, arc length of the ends of the pieces.
        middles: (m,) m.
        table: (m, 3, 8), coefficients of y + iz and its first two derivatives.
        samples: (n,) m, arc length.
        sampled: (n,) m, points y + iz there.
        hollow: whether it turns back by more than `HOLLOW`, as in a groove: a point has several closest points nearby.
    """

    breaks: Array
    middles: Array
    table: Complex
    samples: Array
    sampled: Complex
    hollow: bool


@borrowing
def piece(shape: Shape, s: float) -> int:
    """Index of the piece that contains s."""
    low, high = 0, len(shape.middles) - 1
    while low < high:
        middle = (low + high + 1) // 2
        if shape.breaks[middle] <= s:
            low = middle
        else:
            high = middle - 1
    return low


@borrowing
def next_piece(shape: Shape, s: float, j: int) -> int:
    """As `piece`, from piece j on: for an s that lies in it or nearby."""
    last = len(shape.middles) - 1
    while j < last and shape.breaks[j + 1] <= s:
        j += 1
    while j > 0 and shape.breaks[j] > s:
        j -= 1
    return j


@borrowing
def local(shape: Shape, s: float, j: int) -> tuple[complex, complex, complex]:
    """Position, first and second derivative at s in piece j."""
    # sums of products of real numbers: a complex product has twice as many, half of them with the zero in s + 0i
    x, table = s - shape.middles[j], shape.table
    y, z, dy, dz, ddy, ddz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for n in range(7, -1, -1):
        y, z = fma(y, x, table[j, 0, n].real), fma(z, x, table[j, 0, n].imag)
        dy, dz = fma(dy, x, table[j, 1, n].real), fma(dz, x, table[j, 1, n].imag)
        ddy, ddz = fma(ddy, x, table[j, 2, n].real), fma(ddz, x, table[j, 2, n].imag)
    return complex(y, z), complex(dy, dz), complex(ddy, ddz)


@borrowing
def _squared(z: complex) -> float:
    return z.real * z.real + z.imag * z.imag


@borrowing
def nearest_sample(shape: Shape, q: complex) -> int:
    """Index of the nearest sample: every STRIDE-th first, then all around those that are near enough."""
    sampled, n = shape.sampled, len(shape.sampled)
    best, at = np.inf, 0
    for i in range(0, n, STRIDE):
        d = _squared(sampled[i] - q)
        if d < best:
            best, at = d, i
    bound = (np.sqrt(best) + STRIDE * SPACING) ** 2
    for i in range(0, n, STRIDE):
        if _squared(sampled[i] - q) <= bound:
            for k in range(max(i - STRIDE + 1, 0), min(i + STRIDE, n)):
                d = _squared(sampled[k] - q)
                if d < best:
                    best, at = d, k
    return at


@borrowing
def nearer_sample(shape: Shape, q: complex, at: int) -> int:
    """Index of the nearest sample by descent from sample to sample: for a point next to one with a known index, unless
    the curve is hollow.
    """
    if shape.hollow:
        return nearest_sample(shape, q)
    sampled, n = shape.sampled, len(shape.sampled)
    best = _squared(sampled[at] - q)
    for direction in (-1, 1):
        while 0 <= at + direction < n:
            d = _squared(sampled[at + direction] - q)
            if d >= best:
                break
            best, at = d, at + direction
    return at


@borrowing
def _newton(z: complex, t: complex, k: complex, q: complex) -> tuple[float, float, float]:
    """Point q minus curve along tangent and normal, and Newton's step for the least distance, from `local` values."""
    away = q - z
    along = t.real * away.real + t.imag * away.imag
    # |q - z|^2 / 2 has the slope -along and the second derivative 1 - Re(conj(z'') (q - z))
    second = 1.0 - (k.real * away.real + k.imag * away.imag)
    return along, t.real * away.imag - t.imag * away.real, along / max(second, 1e-3)


@borrowing
def foot(shape: Shape, q: complex, start: float) -> tuple[float, float, bool]:
    """Arc length m, distance m and inside, as in `Closest`, of the closest point to q, from an initial arc length."""
    s, distance, inside, _ = foot_from(shape, q, start, piece(shape, start))
    return s, distance, inside


@borrowing
def foot_from(shape: Shape, q: complex, start: float, j: int) -> tuple[float, float, bool, int]:
    """As `foot`, from an initial arc length in or near piece j; also the piece of the closest point."""
    first, last = shape.breaks[0], shape.breaks[-1]
    s = start
    for _ in range(_FAST):
        j = next_piece(shape, s, j)
        z, t, k = local(shape, s, j)
        _along, across, step = _newton(z, t, k, q)
        s = min(max(s + min(max(step, -SPACING), SPACING), first), last)
        if abs(step) < SMALL_STEP:
            return s, across, True, next_piece(shape, s, j)
    s, across, inside = _held(shape, q, start)
    return s, across, inside, piece(shape, s)


@borrowing
def _held(shape: Shape, q: complex, s: float) -> tuple[float, float, bool]:
    """As `foot`, with steps limited to one smooth piece; the next step is taken on the adjacent piece."""
    top = len(shape.breaks) - 2
    j, stationary = piece(shape, s), False
    along, across = 0.0, 0.0
    for _ in range(_SAFE):
        z, t, k = local(shape, s, j)
        along, across, step = _newton(z, t, k, q)
        low, high = shape.breaks[j], shape.breaks[j + 1]
        new = min(max(s + min(max(step, -SPACING), SPACING), low), high)
        converged = abs(step) < SMALL_STEP or new == s
        if converged and stationary:  # on both sides: a corner or an end
            break
        if new == high:
            j += 1
        if new == low:
            j -= 1
        j = min(max(j, 0), top)
        s, stationary = new, converged
    if abs(along) <= 2 * SMALL_STEP:
        return s, across, True
    inside = shape.breaks[0] < s < shape.breaks[-1]
    return s, np.copysign(np.sqrt(along * along + across * across), across), inside


@unchecked
def closest(shape: Shape, q: Complex, guess: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """`Closest` of points q (n,) m as y + iz, from arc lengths guess (n,) m, or (0,) for the nearest samples."""
    n = len(q)
    s, distance, inside = np.empty(n), np.empty(n), np.empty(n, dtype=np.bool_)
    for i in range(n):
        start = guess[i] if len(guess) else shape.samples[nearest_sample(shape, q[i])]
        s[i], distance[i], inside[i] = foot(shape, q[i], min(max(start, shape.breaks[0]), shape.breaks[-1]))
    return s, distance, inside
