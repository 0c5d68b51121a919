"""Compiled: area of a patch from the lengths of its strips, to second order in their widths."""

from __future__ import annotations

import numpy as np
from scipy.special import roots_legendre

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

PLACE, WEIGHT = roots_legendre(12)  # Gauss rule on -1 to 1
RISE = 1 - np.cos(0.5 * np.pi * (PLACE + 1))  # from one end, of 2
LEAST_STRIPS = 3  # for a parabola across; of fewer, the area is that of whole strips
SHARE = 0.25 * np.pi * WEIGHT * np.sin(0.5 * np.pi * (PLACE + 1))


@compiled
def patch_area(square: Array, bounds: Array) -> float:
    """Area m2 of S adjacent strips.

    Parameters:
        square: (S,) m2, of their lengths.
        bounds: (S + 1,) m, lateral bounds of the strips.

    The square of the length is a parabola for an ellipse, and that of a strip its mean over the width, continued beyond
    the lateral end of the contact, where it is negative. It is interpolated by parabolas with these means; the contact
    ends at their root in an outer strip, or in the unloaded one next to it.
    """
    S, total = len(square), 0.0
    if S < LEAST_STRIPS:
        for i in range(S):
            total += np.sqrt(max(square[i], 0.0)) * (bounds[i + 1] - bounds[i])
        return total
    for i in range(S):
        a, b, c = _within(square, bounds, i)
        half = 0.5 * (bounds[i + 1] - bounds[i])
        low = -_end(a, -b, c, half) if i == 0 else -half
        high = _end(a, b, c, half) if i == S - 1 else half
        for k in range(len(RISE)):  # the parabola may vanish at either end
            y = low + 0.5 * (high - low) * RISE[k]
            total += (high - low) * SHARE[k] * np.sqrt(max((a * y + b) * y + c, 0.0))
    return total


@compiled
def lateral_ends(square: Array, bounds: Array) -> tuple[float, float]:
    """Lateral ends m of the contact, which moves over the outer strips and does not end with them; parameters as for
    `patch_area`.
    """
    S = len(square)
    if S < LEAST_STRIPS:
        return bounds[0], bounds[S]
    a, b, c = _within(square, bounds, 0)
    low = 0.5 * (bounds[0] + bounds[1]) - _end(a, -b, c, 0.5 * (bounds[1] - bounds[0]))
    a, b, c = _within(square, bounds, S - 1)
    return low, 0.5 * (bounds[S - 1] + bounds[S]) + _end(a, b, c, 0.5 * (bounds[S] - bounds[S - 1]))


@borrowing
def _within(square: Array, bounds: Array, i: int) -> tuple[float, float, float]:
    """Coefficients of the parabola in a strip, from its middle, by the means over it and the nearest two."""
    first = min(max(i - 1, 0), len(square) - 3)
    return _parabola(square[first : first + 3], bounds[first : first + 4], 0.5 * (bounds[i] + bounds[i + 1]))


@borrowing
def _parabola(square: Array, bounds: Array, origin: float) -> tuple[float, float, float]:
    """Coefficients of y^2, y, 1 of the parabola whose means over three strips are squares (3,) m2, between bounds
    (4,) m; y is the distance from an origin. Its integral interpolates sums: divided differences.
    """
    s0, s1, s2, s3 = bounds[0] - origin, bounds[1] - origin, bounds[2] - origin, bounds[3] - origin
    first = square[0]
    rise = (square[1] - first) / (s2 - s0)
    bend = ((square[2] - square[1]) / (s3 - s1) - rise) / (s3 - s0)
    slope = 2.0 * (rise - bend * (s0 + s1 + s2))
    return 3.0 * bend, slope, first - rise * (s0 + s1) + bend * (s0 * s1 + s0 * s2 + s1 * s2)


@compiled
def _end(a: float, b: float, c: float, side: float) -> float:
    """First root of a parabola on the outer half of a strip with the sides -side and side, or beyond; else the side."""
    under = b * b - 4.0 * a * c
    if under < 0.0 or (a == 0.0 and b == 0.0):
        return side
    far, nearest = -0.5 * (b + np.copysign(np.sqrt(under), b)), np.inf  # without cancellation
    for top, base in ((far, a), (c, far)):
        if base != 0.0 and -side < top / base < 3.0 * side:
            nearest = min(nearest, top / base)
    return nearest if np.isfinite(nearest) else side
