"""Area of a patch from the lengths of its strips, to second order in their widths."""

from __future__ import annotations

import numpy as np
from scipy.special import roots_legendre

from wheelrail.support.arrays import Array

PLACE, WEIGHT = roots_legendre(12)  # Gauss rule on -1 to 1


def patch_area(length: Array, bounds: Array) -> float:
    """Area m2 of S adjacent strips.

    Parameters:
        length: (S,) m.
        bounds: (S + 1,) m, lateral bounds of the strips.

    The square of the length is a parabola for an ellipse, and that of a strip its mean over the width, beyond the
    lateral end of the contact too. It is interpolated by parabolas with these means; the contact ends at their root in
    an outer strip, or in the unloaded one next to it.
    """
    S = len(length)
    if S < 3:
        return float(length @ np.diff(bounds))
    integral = np.concatenate([[0.0], np.cumsum(length**2 * np.diff(bounds))])
    total = 0.0
    for i in range(S):
        first, middle = min(max(i - 1, 0), S - 3), 0.5 * (bounds[i] + bounds[i + 1])
        near = slice(first, first + 4)
        parabola = np.polyder(np.polyfit(bounds[near] - middle, integral[near], 3))
        low, high = bounds[i] - middle, bounds[i + 1] - middle
        if i == 0:
            low = -_end(parabola * [1.0, -1.0, 1.0], high)
        if i == S - 1:
            high = _end(parabola, high)
        total += _integral_of_root(parabola, low, high)
    return total


def _end(parabola: Array, side: float) -> float:
    """First root of a parabola on the outer half of a strip with the sides -side and side, or beyond; else the side."""
    roots = np.roots(parabola)
    real = roots[np.abs(roots.imag) == 0].real
    outside = real[(real > -side) & (real < 3 * side)]
    return float(outside.min()) if len(outside) else side


def _integral_of_root(parabola: Array, low: float, high: float) -> float:
    """Integral of the root of a parabola from low to high, where it may vanish at either."""
    angle = 0.5 * np.pi * (PLACE + 1)
    y = low + 0.5 * (high - low) * (1 - np.cos(angle))
    height = np.sqrt(np.maximum(np.polyval(parabola, y), 0.0))
    return float(0.25 * np.pi * (high - low) * (WEIGHT * np.sin(angle)) @ height)
