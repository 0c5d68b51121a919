"""Compiled: linear interpolation between the lines of a surface, at points and in the mean over strips."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


@compiled
def _cell(arc: Array, s: float) -> tuple[int, float]:
    """Line before an arc length and the weight of the next one, clipped to the ends."""
    near = min(max(int(np.searchsorted(arc, s)) - 1, 0), len(arc) - 2)
    return near, min(max((s - arc[near]) / (arc[near + 1] - arc[near]), 0.0), 1.0)


@compiled
def between_lines(arc: Array, values: Array, s: Array) -> Array:
    """Values (n, k) at arc lengths s (n,) m, linear between values (ns, k) at lines of arc length (ns,) m."""
    interpolated = np.empty((len(s), values.shape[1]))
    for i in range(len(s)):
        near, part = _cell(arc, s[i])
        for k in range(values.shape[1]):
            interpolated[i, k] = (1.0 - part) * values[near, k] + part * values[near + 1, k]
    return interpolated


@compiled
def shares(arc: Array, sides: Array, place: Array, weight: Array) -> Array:
    """Weights (S, ns) of lines in the means over strips of functions linear between lines.

    Parameters:
        arc: (ns,) m, arc length of the lines.
        sides: (S, 2) m, of the strips.
        place, weight: points and weights (m,) of a quadrature rule on -1 to 1.
    """
    mean_weights = np.zeros((len(sides), len(arc)))
    for i in range(len(sides)):
        for k in range(len(place)):
            s = 0.5 * (sides[i, 0] + sides[i, 1]) + 0.5 * (sides[i, 1] - sides[i, 0]) * place[k]
            near, part = _cell(arc, s)
            mean_weights[i, near] += 0.5 * weight[k] * (1.0 - part)
            mean_weights[i, near + 1] += 0.5 * weight[k] * part
    return mean_weights
