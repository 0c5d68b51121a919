"""Closest points of a curve: fine samples to start from, Newton's method on the curve itself, all compiled."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array, Complex
from wheelrail.support.compiled import compiled

SPACING = 1e-4  # m, of the samples, and the longest step
STRIDE = 8  # samples that the first look goes over
SMALL_STEP = 3e-8  # m; what one more step leaves is quadratic in it, below 1e-12 m
_FAST, _SAFE = 4, 1000


class Closest(NamedTuple):
    """Foot of each of n points: arc length s m, distance m, and whether the foot lies inside the curve.

    distance is positive on the outward side; inside is False where the foot is an end of the curve and the point lies
    beyond it.
    """

    s: Array
    distance: Array
    inside: NDArray[np.bool_]


class Shape(NamedTuple):
    """A curve for compiled code: breaks (m + 1,) and middles (m,) of its pieces m, table (m, 3, 8) of coefficients of
    y + iz and its two derivatives, samples (n,) m of arc length and the points (n,) there.
    """

    breaks: Array
    middles: Array
    table: Complex
    samples: Array
    sampled: Complex


@compiled
def piece(shape: Shape, s: float) -> int:
    """The piece that s lies in."""
    return int(np.searchsorted(shape.breaks[1:-1], s, side="right"))


@compiled
def local(shape: Shape, s: float, j: int) -> tuple[complex, complex, complex]:
    """Position, first and second derivative at s in piece j."""
    x = s - shape.middles[j]
    z, t, k = shape.table[j, 0, 7], shape.table[j, 1, 7], shape.table[j, 2, 7]
    for n in range(6, -1, -1):
        z, t, k = z * x + shape.table[j, 0, n], t * x + shape.table[j, 1, n], k * x + shape.table[j, 2, n]
    return z, t, k


@compiled
def _squared(z: complex) -> float:
    return z.real * z.real + z.imag * z.imag


@compiled
def nearest_sample(shape: Shape, q: complex) -> int:
    """The nearest sample: every so many first, then all around those that may hide a nearer one."""
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


@compiled
def nearer_sample(shape: Shape, q: complex, at: int) -> int:
    """From sample to sample as long as they come nearer: the nearest for a point beside one whose own is known."""
    sampled, n = shape.sampled, len(shape.sampled)
    best = _squared(sampled[at] - q)
    for way in (-1, 1):
        while 0 <= at + way < n:
            d = _squared(sampled[at + way] - q)
            if d >= best:
                break
            best, at = d, at + way
    return at


@compiled
def _newton(shape: Shape, q: complex, s: float, j: int) -> tuple[float, float, float]:
    """Point minus curve along tangent and normal, and Newton's step for the least distance."""
    z, t, k = local(shape, s, j)
    away = q - z
    along = t.real * away.real + t.imag * away.imag
    # |q - z|^2 / 2 has the slope -along and the second derivative 1 - Re(conj(z'') (q - z))
    bend = 1.0 - (k.real * away.real + k.imag * away.imag)
    return along, t.real * away.imag - t.imag * away.real, along / max(bend, 1e-3)


@compiled
def foot(shape: Shape, q: complex, start: float) -> tuple[float, float, bool]:
    """Arc length m, distance m and inside of the closest point from a start."""
    first, last = shape.breaks[0], shape.breaks[-1]
    s = start
    for _ in range(_FAST):
        _along, across, step = _newton(shape, q, s, piece(shape, s))
        s = min(max(s + min(max(step, -SPACING), SPACING), first), last)
        if abs(step) < SMALL_STEP:
            return s, across, True
    return _held(shape, q, start)


@compiled
def _held(shape: Shape, q: complex, s: float) -> tuple[float, float, bool]:
    """The same with steps that stop at the end of a smooth piece, where the next one decides next time."""
    top = len(shape.breaks) - 2
    j, quiet = piece(shape, s), False
    along, across = 0.0, 0.0
    for _ in range(_SAFE):
        along, across, step = _newton(shape, q, s, j)
        low, high = shape.breaks[j], shape.breaks[j + 1]
        new = min(max(s + min(max(step, -SPACING), SPACING), low), high)
        settled = abs(step) < SMALL_STEP or new == s
        if settled and quiet:  # idle on both sides: a corner or an end
            break
        if new == high:
            j += 1
        if new == low:
            j -= 1
        j = min(max(j, 0), top)
        s, quiet = new, settled
    if abs(along) <= 2 * SMALL_STEP:
        return s, across, True
    inside = shape.breaks[0] < s < shape.breaks[-1]
    return s, np.copysign(np.sqrt(along * along + across * across), across), inside


@compiled
def closest(shape: Shape, q: Complex, guess: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Feet of points q (n,), from guesses (n,), or from the nearest samples for none."""
    n = len(q)
    s, distance, inside = np.empty(n), np.empty(n), np.empty(n, dtype=np.bool_)
    for i in range(n):
        start = guess[i] if len(guess) else shape.samples[nearest_sample(shape, q[i])]
        s[i], distance[i], inside[i] = foot(shape, q[i], min(max(start, shape.breaks[0]), shape.breaks[-1]))
    return s, distance, inside
