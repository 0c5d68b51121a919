"""Steps of a wear loop that do not grow noise: smoothing by a local filter, and the distance of a step.

A wave of wavenumber k and depth d of a profile changes the pressure by -E* k d / 2 (K. L. Johnson, Contact Mechanics,
eq. 13.2), and the depth of the next explicit step by -L k d with L = D E* / (2 p), D its depth and p the pressure:
waves shorter than pi L grow. With depths F = 1 / (1 + (l k)^2) times the explicit ones, l = L / 2, a step leaves
1 - L k F of a wave, which lies between 0 and 1 for all k. The filter moves material by l, which vanishes with the step.
Cells are those of the worn profile: on the new one even wear would be uneven beside jumps of the curvature.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import solveh_banded
from scipy.optimize import brentq

from wheelrail.support.arrays import Array

# The length falls beside a cell by no more than this slope, also beyond the worn ones. With 1/3 steps of 0.05 and
# 0.1 mm to 0.25 mm err by 6 and 12 % (RMS of the depth), with 1 by 4 and 5 %; with 3/2 twice the waves remain.
TAPER = 1.0
# Of the largest depth by the filter: with 4 four steps to 0.2 mm err by 22 % (RMS of the depth), with 2 by 12 %.
LARGEST_REDUCTION = 2.0
_ANGLES = np.linspace(0.0, np.pi, 401)[1:]  # rad, k times the width of a cell, up to waves of two cells
_BETWEEN = 2e-5  # relative, largest error of a maximum over these angles
LEAST = 0.01  # of the largest depth, below which the pressure of a cell at the edge of a strip is an interpolation


class Step(NamedTuple):
    """Removal of one step.

    Parameters:
        distance: m, or passages, as of the rate.
        depth: (n,) m, smoothed.
        length: (n,) m, l of the filter.
    """

    distance: float
    depth: Array
    length: Array


def smoothing_length(depth: Array, pressure: Array, *, modulus: float, width: ArrayLike) -> Array:
    """Length l (n,) m of the filter in cells: D E* / (4 p), and falling with slope 1 beside larger ones.

    Parameters:
        depth: (n,) m, explicit depth D of the step.
        pressure: (n,) Pa, mean where the depth comes from; positive in cells of 1 % of the largest depth or more.
        modulus: E*, Pa.
        width: of the cells, m, one for all or (n,).

    Raises ValueError.
    """
    if not (np.isfinite(depth).all() and (depth >= 0.0).all()):
        raise ValueError("depths must be finite and not negative")
    worn = (depth > 0.0) & (depth >= LEAST * depth.max())
    if not (pressure[worn] > 0.0).all():
        raise ValueError("cells with wear must have a positive pressure")
    length = np.where(worn, 0.25 * modulus * depth / np.where(worn, pressure, 1.0), 0.0)
    widths = np.broadcast_to(width, len(depth))
    s = TAPER * (np.cumsum(widths) - 0.5 * widths)
    rising = np.maximum.accumulate(length + s) - s  # from the left
    falling = np.maximum.accumulate((length - s)[::-1])[::-1] + s
    return np.asarray(np.maximum(rising, falling))


def smoothed(depth: Array, length: Array, width: ArrayLike) -> Array:
    """Solution (n,) m of d - (l^2 d')' = D without flux at both ends, in cells: never negative, of the same section.

    Parameters:
        depth: (n,) m, D.
        length: (n,) m, l.
        width: of the cells, m, one for all or (n,).
    """
    widths = np.broadcast_to(width, len(depth))
    flux = _ratio(length / widths) * widths
    between = 0.5 * (flux[1:] + flux[:-1])
    bands = np.stack([np.concatenate([[0.0], -between]), widths])
    bands[1, 1:] += between
    bands[1, :-1] += between
    return np.asarray(solveh_banded(bands, widths * depth))


def _ratio(x: Array) -> Array:
    """Square (n,) of length over width in the difference equation, the least with 1 - L k F >= 0 for all waves.

    F is 1 / (1 + 4 ratio sin^2(k width / 2)) there; the ratio is x^2 + 1/12 for wide x, 0 where L k < 1 for all waves.
    """
    wide = np.maximum(x, 1.0)
    worst = (1.0 + 1.0 / (12.0 * wide**2)) / wide  # k width, asymptotically
    angles = np.concatenate([np.broadcast_to(_ANGLES, (len(x), len(_ANGLES))), worst[:, None]], axis=1)
    needed = (2.0 * x[:, None] * angles - 1.0) / (4.0 * np.sin(0.5 * angles) ** 2)
    return np.asarray(np.maximum((1.0 + _BETWEEN) * needed.max(axis=1), 0.0))


def step_factor(depth: float, pressure: float, wavenumber: Array, *, modulus: float, width: float) -> Array:
    """Fraction (n,) of waves k (n,) 1/m that a step of uniform depth m and pressure Pa leaves in cells: 1 - L k F."""
    L = modulus * depth / (2.0 * pressure)
    ratio = _ratio(np.array([0.5 * L / width]))
    return np.asarray(1.0 - L * wavenumber / (1.0 + 4.0 * ratio * np.sin(0.5 * wavenumber * width) ** 2))


def step(
    rate: Array, pressure: Array, *, modulus: float, width: ArrayLike, depth: float, distance: float = np.inf
) -> Step:
    """The step whose largest smoothed depth is given, but for its longest distance.

    Parameters:
        rate: (n,) m of depth per m of distance, or per passage.
        pressure: (n,) Pa, as for `smoothing_length`.
        modulus: E*, Pa.
        width: of the cells, m, one for all or (n,).
        depth: largest of the step, m.
        distance: longest, m or passages.

    No longer than for an explicit depth of twice that. Raises ValueError where nothing wears and distance is
    infinite.
    """

    def removal(x: float) -> Step:
        length = smoothing_length(x * rate, pressure, modulus=modulus, width=width)
        return Step(x, smoothed(x * rate, length, width), length)

    if not (depth > 0.0 and distance > 0.0):
        raise ValueError(f"depth and distance of a step must be positive, not {depth} and {distance}")
    most = float(rate.max())
    shortest = np.inf if most <= 0.0 else depth / most
    longest = min(distance, LARGEST_REDUCTION * shortest)
    if not np.isfinite(longest):
        raise ValueError("nothing wears, and the distance of the step is not limited")
    last = removal(longest)
    if shortest >= longest or last.depth.max() <= depth:
        return last
    found = brentq(lambda x: removal(x).depth.max() - depth, shortest, longest, rtol=1e-6)
    return removal(found)
