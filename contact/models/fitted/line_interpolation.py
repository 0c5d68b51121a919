"""Compiled: what is known at the lines of a surface, between them and in the mean over strips."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


@compiled
def _cell(arc: Array, s: float) -> tuple[int, float]:
    """Line before a place and the share of the next one, held to the ends."""
    near = min(max(int(np.searchsorted(arc, s)) - 1, 0), len(arc) - 2)
    return near, min(max((s - arc[near]) / (arc[near + 1] - arc[near]), 0.0), 1.0)


@compiled
def between_lines(arc: Array, values: Array, s: Array) -> Array:
    """Values (ns, k) at lines of arc length (ns,) at places s (n,), linear between lines: (n, k)."""
    found = np.empty((len(s), values.shape[1]))
    for i in range(len(s)):
        near, part = _cell(arc, s[i])
        for k in range(values.shape[1]):
            found[i, k] = (1.0 - part) * values[near, k] + part * values[near + 1, k]
    return found


@compiled
def shares(arc: Array, sides: Array, place: Array, weight: Array) -> Array:
    """Shares (S, ns) of lines in the means over strips with sides (S, 2), of what is linear from line to line, by a
    rule with places and weights on -1 to 1.
    """
    found = np.zeros((len(sides), len(arc)))
    for i in range(len(sides)):
        for k in range(len(place)):
            s = 0.5 * (sides[i, 0] + sides[i, 1]) + 0.5 * (sides[i, 1] - sides[i, 0]) * place[k]
            near, part = _cell(arc, s)
            found[i, near] += 0.5 * weight[k] * (1.0 - part)
            found[i, near + 1] += 0.5 * weight[k] * part
    return found
