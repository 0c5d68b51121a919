"""Area of a patch from the lengths of its strips, to second order in their widths."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import roots_legendre

from wheelrail.support.arrays import Array

PLACE, WEIGHT = roots_legendre(12)  # Gauss rule on -1 to 1
RISE, RATE = 1 - np.cos(0.5 * np.pi * (PLACE + 1)), np.sin(0.5 * np.pi * (PLACE + 1))


def patch_area(length: Array, bounds: Array) -> float:
    """Area m2 of S adjacent strips.

    Parameters:
        length: (S,) m.
        bounds: (S + 1,) m, lateral bounds of the strips.

    The square of the length is a parabola for an ellipse, and that of a strip its mean over the width, beyond the
    lateral end of the contact too. It is interpolated by parabolas with these means; the contact ends at their root in
    an outer strip, or in the unloaded one next to it.
    """
    S, width = len(length), np.diff(bounds)
    if S < 3:
        return float(length @ width)
    first = np.clip(np.arange(S) - 1, 0, S - 3)
    middle = 0.5 * (bounds[:-1] + bounds[1:])
    side = np.stack([bounds[first + k] - middle for k in range(4)], axis=1)  # of three strips, from the middle of one
    # means over the three strips of 1, y and y^2
    means = np.stack([(side[:, 1:] ** k - side[:, :-1] ** k) / (k * np.diff(side)) for k in (1, 2, 3)], axis=-1)
    squares = np.stack([length[first + k] ** 2 for k in range(3)], axis=1)
    parabola = np.linalg.solve(means, squares[..., None])[..., 0][:, ::-1]  # of y^2, y, 1
    low, high = -0.5 * width, 0.5 * width
    low[0] = -_end(parabola[0] * [1.0, -1.0, 1.0], high[0])
    high[-1] = _end(parabola[-1], high[-1])
    return float(_integrals_of_roots(parabola, low, high).sum())


def _end(parabola: Array, side: float) -> float:
    """First root of a parabola on the outer half of a strip with the sides -side and side, or beyond; else the side."""
    a, b, c = parabola.tolist()
    under = b * b - 4 * a * c
    if under < 0 or a == b == 0:
        return side
    far = -0.5 * (b + math.copysign(math.sqrt(under), b))  # without cancellation
    outside = [top / base for top, base in ((far, a), (c, far)) if base != 0 and -side < top / base < 3 * side]
    return min(outside, default=side)


def _integrals_of_roots(parabola: Array, low: Array, high: Array) -> Array:
    """Integrals (S,) of the roots of parabolas (S, 3) from low to high (S,), where they may vanish at either."""
    y = low[:, None] + 0.5 * (high - low)[:, None] * RISE
    height = np.sqrt(np.maximum((parabola[:, :1] * y + parabola[:, 1:2]) * y + parabola[:, 2:], 0.0))
    return np.asarray(0.25 * np.pi * (high - low) * (height @ (WEIGHT * RATE)))
