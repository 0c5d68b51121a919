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
BISECTIONS = 20


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
        slope, bend = _parabola(depth[k - 1 : k + 2], before, after)
        if not np.isfinite(slope) or not np.isfinite(bend):
            continue
        square = (slope * width[k]) ** 2 + (bend * width[k] ** 2) ** 2 / 60.0
        if square > 0.0:
            variation, distance = np.sqrt(square), np.sqrt(square + 4.0 * depth[k] ** 2)
            ratio = curvature[k] * width[k] ** 2 * distance / square
            short = ratio / np.sqrt(1.0 + ratio * ratio)  # beyond a sharp end the gap is not larger than at a circle's
            onset[k] = ONSET * variation * np.sqrt(variation / distance) * short ** (1.0 - SLENDER)
            whole[k] = 0.5 * variation * ratio ** (1.0 - 2.0 * SLENDER)
    return onset, whole


@compiled
def partial_width_changes(
    depth: Array, curvature: Array, middle: Array, width: Array, change: Array
) -> tuple[Array, Array]:
    """Relative derivatives (S, n) of onset and depth on the whole width of `partial_widths`.

    Parameters:
        depth, middle: (S, 3) m, of the strips and the next ones on either side.
        curvature, width: (S,) 1/m and m.
        change: (S, 3, n) derivatives of the penetration.
    """
    S, _, n = change.shape
    onset, whole = np.empty((S, n)), np.empty((S, n))
    for i in range(S):
        before, after = middle[i, 1] - middle[i, 0], middle[i, 2] - middle[i, 1]
        slope, bend = _parabola(depth[i], before, after)
        square = (slope * width[i]) ** 2 + (bend * width[i] ** 2) ** 2 / 60.0
        sum_of_squares = square + 4.0 * depth[i, 1] ** 2
        ratio = curvature[i] * width[i] ** 2 * np.sqrt(sum_of_squares) / square
        for k in range(n):
            slopes, bends = _parabola(change[i, :, k], before, after)
            variation = (slope * width[i] ** 2 * slopes + bend * width[i] ** 4 / 60.0 * bends) / square
            distance = (square * variation + 4.0 * depth[i, 1] * change[i, 1, k]) / sum_of_squares
            ratios = distance - 2.0 * variation
            onset[i, k] = 1.5 * variation - 0.5 * distance + (1.0 - SLENDER) / (1.0 + ratio**2) * ratios
            whole[i, k] = variation + (1.0 - 2.0 * SLENDER) * ratios
    return onset, whole


@borrowing
def _parabola(values: Array, before: float, after: float) -> tuple[float, float]:
    """Slope and second derivative at the middle one of three places at distances before and after it, from values (3,)
    there.
    """
    first, second = (values[1] - values[0]) / before, (values[2] - values[1]) / after
    return (first * after + second * before) / (before + after), 2.0 * (second - first) / (before + after)


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


@compiled
def opening_changes(load: Array, onset: Array, whole: Array) -> tuple[Array, Array]:
    """Derivatives (S,) m of `opening` by relative changes of onset and whole, for loads (S,) below the latter."""
    part = np.sqrt(load / whole)
    return onset * (1 - part) ** OPENING, 0.5 * OPENING * onset * (1 - part) ** (OPENING - 1) * part


@compiled
def pressed(depth: Array, compliance: Array, onset: Array) -> Array:
    """Touching parts (S,) of the width, or roots of the load over that on the whole width where this is larger.

    Parameters:
        depth: (S,) m, penetration without load, measured where the strips begin to touch.
        compliance: (S,) m, displacement under the load on the whole width.
        onset: (S,) m.

    The root of depth - onset - compliance c^2 + onset (1 - c)^(5/2), which falls with c, by bisection.
    """
    roots = np.empty(len(depth))
    for i in range(len(depth)):
        excess = depth[i] - onset[i]
        if excess >= compliance[i]:
            roots[i] = np.sqrt(max(excess, 0.0) / compliance[i])
            continue
        low, high = 0.0, 1.0
        for _ in range(BISECTIONS):
            c = 0.5 * (low + high)
            if excess - compliance[i] * c * c + onset[i] * (1.0 - c) ** OPENING < 0.0:
                high = c
            else:
                low = c
        roots[i] = high
    return roots
