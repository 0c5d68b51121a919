"""Compiled: displacement of strips by loads on others that finite bodies have beyond half-spaces.

It varies little along a contact: its compliance is the mean over the first cell of the tables, 5 mm, with weights that
fall linearly with the distance, 2 (G(l) - G(0)) / l^2 of G'' = C.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.influence.pair_grid import DEGREE, NN, TN, TN_TURN
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled


def bulk_compliance(coefficients: Array, width: float, length: float) -> Array:
    """Normal displacement (.., 2) m/N, apart from each other, by lateral loads and by pressure, from coefficients
    (.., DEGREE + 1, COMPONENTS) of the first cell.

    Parameters:
        width: of the cell, in its variable.
        length: m, of the cell.
    """
    rise = np.tensordot(coefficients[..., 1:, :], width ** np.arange(1, DEGREE + 1), axes=(-2, 0))
    mean = 2.0 * rise / length**2
    return np.stack([mean[..., TN_TURN] - mean[..., TN], mean[..., NN]], axis=-1)


@compiled
def bulk_displacements(arc: Array, compliance: Array, place: Array, middle: Array, width: Array, loads: Array) -> Array:
    """Displacement (R,) m of a body at some places, linear between its lines, by loads on strips.

    Parameters:
        arc: (ns,) m, of the lines.
        compliance: (ns, ns, 2) m/N of pairs of lines.
        place: (R,) m.
        middle, width: (S,) m, of the strips.
        loads: (S, 2) N.
    """
    last, on_lines = len(arc) - 1, np.zeros((len(arc), 2))
    first, end = last, 0
    for j in range(len(middle)):
        low, high = middle[j] - 0.5 * width[j], middle[j] + 0.5 * width[j]
        m = max(np.searchsorted(arc, low) - 1, 0)
        first = min(first, m)
        while m <= last:
            share = (hat_integral(arc, m, high) - hat_integral(arc, m, low)) / width[j]
            on_lines[m, 0] += share * loads[j, 0]
            on_lines[m, 1] += share * loads[j, 1]
            m += 1
            if arc[m - 1] >= high:
                break
        end = max(end, m)
    total = np.zeros(len(place))
    for i in range(len(place)):
        k = min(max(np.searchsorted(arc, place[i]), 1), last)
        t = min(max((place[i] - arc[k - 1]) / (arc[k] - arc[k - 1]), 0.0), 1.0)
        for m in range(first, end):
            for c in range(2):
                at = (1.0 - t) * compliance[k - 1, m, c] + t * compliance[k, m, c]
                total[i] += on_lines[m, c] * at
    return total


@borrowing
def hat_integral(arc: Array, k: int, s: float) -> float:
    """Integral up to s m of the function that is 1 at line k and 0 at the others, linear in between."""
    total = 0.0
    if k > 0 and s > arc[k - 1]:
        t = min(s, arc[k]) - arc[k - 1]
        total += 0.5 * t * t / (arc[k] - arc[k - 1])
    if k < len(arc) - 1 and s > arc[k]:
        wide = arc[k + 1] - arc[k]
        t = min(s - arc[k], wide)
        total += t - 0.5 * t * t / wide
    return total
