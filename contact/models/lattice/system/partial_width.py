"""Compiled: strips that touch on a part of their width, and the gap that is left on the rest.

At a lateral end of a contact the surfaces separate like y^(3/2), with the distance y, and the load per width rises like
y (Johnson, Contact Mechanics, 1985, sec. 4.2). Over a strip of width w that touches on the part c of it the load is
c^2 of that at c = 1, and the mean gap (1 - c)^(5/2) of that at c = 0, its onset. Both follow from the undeformed
penetration, as those of an ellipse with its end in the strip.
"""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

ONSET = 4.0 * np.sqrt(2.0) / 15.0  # mean over w of (2 sqrt(2) / 3) y^(3/2) at a unit curvature and distance to the end
SLENDER = 2.0 / np.pi  # exponent of the ratio of curvatures in that of the semi-axes: Hamrock, Brewe 1983
LEAST = 1e-10  # touching part in the derivative of the gap, which is infinite at none
OPENING = 2.5  # exponent of the gap


@compiled
def partial_widths(depth: Array, curvature: Array, middle: Array, width: Array) -> tuple[Array, Array]:
    """Onset (K,) m of strips, their mean gap when they begin to touch at one edge, and the depth (K,) m of the parabola
    along them when they touch on their whole width; both zero where the penetration does not vary across.

    Parameters:
        depth: (K,) m, undeformed penetration; -inf far from contact.
        curvature: (K,) 1/m, relative curvature along x.
        middle, width: (K,) m.

    With the variation v = w dd/ds of the penetration d the end of a circle is 2 w d / v away. Across a maximum or a
    saddle v is the width of a uniform distribution with the variance of a parabola.
    """
    K = len(depth)
    onset, whole = np.zeros(K), np.zeros(K)
    for k in range(1, K - 1):
        before, after = middle[k] - middle[k - 1], middle[k + 1] - middle[k]
        first, second = (depth[k] - depth[k - 1]) / before, (depth[k + 1] - depth[k]) / after
        if not np.isfinite(first) or not np.isfinite(second):
            continue
        slope = (first * after + second * before) / (before + after)
        bend = 2.0 * (second - first) / (before + after)
        square = (slope * width[k]) ** 2 + (bend * width[k] ** 2) ** 2 / 60.0
        if square > 0.0:
            variation, distance = np.sqrt(square), np.sqrt(square + 4.0 * depth[k] ** 2)
            ratio = curvature[k] * width[k] ** 2 * distance / square
            short = ratio / np.sqrt(1.0 + ratio * ratio)  # beyond a sharp end the gap is not larger than at a circle's
            onset[k] = ONSET * variation * np.sqrt(variation / distance) * short ** (1.0 - SLENDER)
            whole[k] = 0.5 * variation * ratio ** (1.0 - 2.0 * SLENDER)
    return onset, whole


def partial_width_changes(
    depth: Array, curvature: Array, middle: Array, width: Array, change: Array
) -> tuple[Array, Array]:
    """Relative derivatives (S, n) of onset and depth on the whole width of `partial_widths`.

    Parameters:
        depth, middle: (S, 3) m, of the strips and the next ones on either side.
        curvature, width: (S,) 1/m and m.
        change: (S, 3, n) derivatives of the penetration.
    """
    slope, bend = _parabola(depth, middle)
    slopes, bends = _parabola(change.transpose(2, 0, 1), middle)
    square = (slope * width) ** 2 + (bend * width**2) ** 2 / 60
    own = depth[:, 1]
    variation = (slope * width**2 * slopes + bend * width**4 / 60 * bends) / square
    distance = (square * variation + 4 * own * change[:, 1].T) / (square + 4 * own**2)
    ratio = curvature * width**2 * np.sqrt(square + 4 * own**2) / square
    ratios = distance - 2 * variation
    onset = 1.5 * variation - 0.5 * distance + (1 - SLENDER) / (1 + ratio**2) * ratios
    return onset.T, (variation + (1 - 2 * SLENDER) * ratios).T


def _parabola(values: Array, place: Array) -> tuple[Array, Array]:
    """Slope and second derivative (..., S) at the middle one of three places (S, 3) from values (..., S, 3) there."""
    steps = np.diff(place)
    first, second = np.moveaxis(np.diff(values) / steps, -1, 0)
    before, after = steps.T
    length = before + after
    return (first * after + second * before) / length, 2 * (second - first) / length


@borrowing
def opening(load: float, onset: float, whole: float) -> tuple[float, float]:
    """Mean gap m left on a strip, and its derivative by the load; continued to negative loads of trial states.

    Parameters:
        load: amplitude times half length, Pa m.
        onset: m.
        whole: load Pa m on the whole width.
    """
    if load >= whole or whole == 0.0:
        return 0.0, 0.0
    part = np.copysign(max(np.sqrt(abs(load) / whole), LEAST), load)
    rest = onset * (1.0 - part) ** (OPENING - 1.0)
    return rest * (1.0 - part), -0.5 * OPENING * rest / (abs(part) * whole)


def opening_changes(load: Array, onset: Array, whole: Array) -> tuple[Array, Array]:
    """Derivatives (S,) m of `opening` by relative changes of onset and whole, for loads (S,) below the latter."""
    part = np.sqrt(load / whole)
    return onset * (1 - part) ** OPENING, 0.5 * OPENING * onset * (1 - part) ** (OPENING - 1) * part


def pressed(depth: Array, compliance: Array, onset: Array) -> Array:
    """Touching parts (S,) of the width, or roots of the load over that on the whole width where this is larger.

    Parameters:
        depth: (S,) m, penetration without load, measured where the strips begin to touch.
        compliance: (S,) m, displacement under the load on the whole width.
        onset: (S,) m.

    The root of depth - onset - compliance c^2 + onset (1 - c)^(5/2), which falls with c, by bisection.
    """
    low, high = np.zeros(len(depth)), np.ones(len(depth))
    for _ in range(20):
        c = 0.5 * (low + high)
        beyond = depth - onset - compliance * c**2 + onset * (1 - c) ** OPENING < 0
        low, high = np.where(beyond, low, c), np.where(beyond, c, high)
    excess = depth - onset
    return np.where(excess < compliance, high, np.sqrt(np.maximum(excess, 0.0) / compliance))
