"""Compiled: displacement of strips by loads on others that finite bodies have beyond half-spaces.

It varies little along a contact: its compliance is the mean over the first cell of the tables, 5 mm, with weights that
fall linearly with the distance, 2 (G(l) - G(0)) / l^2 of G'' = C.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.influence.pair_grid import DEGREE, NN, TN, TN_TURN
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import borrowing, compiled

TILE = 16  # lines: granularity of the parts of the surface whose correction is assembled


class BulkCompliance(NamedTuple):
    """Compliance of a body between its lines.

    Parameters:
        arc: (ns,) m, of the lines.
        values: (ns, ns, 2) m/N of pairs of lines, see `bulk_compliance`.
        filled: (T, T) pairs of tiles of lines between which there are values.
        moves: whether strips move on the body.
        bounds: (2,) m, ends of its lines.
    """

    arc: Array
    values: Array
    filled: Mask
    moves: bool
    bounds: Array


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


@compiled
def bulk_places(body: BulkCompliance, middle: Array, width: Array, foot: Array) -> Array:
    """Arc length (n,) m on a body of the middles of strips with widths (n,) m, at most on its last lines.

    middle, foot: (n,) m, on the upper and on the lower body.
    """
    places = np.empty(len(middle))
    for i in range(len(middle)):
        half, place = 0.5 * width[i], foot[i] if body.moves else middle[i]
        places[i] = min(max(place, body.bounds[0] + half), body.bounds[1] - half)
    return places


@borrowing
def bulk_known(body: BulkCompliance, first: tuple[Array, Array], second: tuple[Array, Array]) -> bool:
    """Whether there are values between all lines around two sets of strips with middles and widths (n,) m."""
    low, high, last = np.inf, -np.inf, len(body.arc) - 1
    for places, width in (first, second):
        for i in range(len(places)):
            low, high = min(low, places[i] - 0.5 * width[i]), max(high, places[i] + 0.5 * width[i])
    start = max(int(np.searchsorted(body.arc, low)) - 1, 0) // TILE
    for i in range(start, min(int(np.searchsorted(body.arc, high)), last) // TILE + 1):
        for j in range(start, i + 1):
            if not body.filled[i, j]:
                return False
    return True


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
