"""Interpolation on tensor products of unequally spaced nodes, compiled, for real and for complex arguments.

Along each axis the interpolant is a cubic Hermite polynomial in every interval, with the slopes of parabolas through
three nodes: continuous in value and slope, exact for quadratic functions. Two nodes are joined by a line; one node
stands for a constant. Complex arguments give exact derivatives: f(x + i h) = f(x) + i h f'(x) + O(h^2).
"""

from __future__ import annotations

from functools import partial

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

Stencil = tuple[int, int, int, tuple[complex, complex, complex, complex]]
fast = partial(compiled, error_model="numpy")


@fast
def stencil(nodes: Array, x: complex) -> Stencil:
    """Weights of the values at up to four nodes around an argument.

    Parameters:
        nodes: (n,), increasing; their real parts where they depend on complex arguments.
        x: argument, in the range of the nodes.

    Returns number of the first of four nodes, first and last + 1 of those that exist, counted from it, and weights.
    """
    n, zero = len(nodes), 0.0 * x
    if n == 1:
        return -1, 1, 2, (zero, zero + 1.0, zero, zero)
    i = min(max(int(np.searchsorted(nodes.real, x.real, side="right")) - 1, 0), n - 2)
    h = nodes[i + 1] - nodes[i]
    t = (x - nodes[i]) / h
    left, right = h * t * (1.0 - t) ** 2, h * t * t * (t - 1.0)  # weights of the slopes at both ends
    before, here, after = zero, left + right, zero  # weights of the difference quotients of three intervals
    step_before = nodes[i] - nodes[i - 1] if i > 0 else h
    step_after = nodes[i + 2] - nodes[i + 1] if i < n - 2 else h
    if i > 0:
        part = h / (step_before + h)
        here, before = here - left * part, before + left * part
    elif n > 2:
        part = h / (h + step_after)
        here, after = here + left * part, after - left * part
    if i < n - 2:
        part = h / (h + step_after)
        here, after = here - right * part, after + right * part
    elif n > 2:
        part = h / (step_before + h)
        here, before = here + right * part, before - right * part
    smooth = t * t * (3.0 - 2.0 * t)
    weights = (
        -before / step_before,
        1.0 - smooth + before / step_before - here / h,
        smooth + here / h - after / step_after,
        after / step_after,
    )
    return i - 1, 1 if i == 0 else 0, 3 if i == n - 2 else 4, weights
