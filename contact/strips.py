"""Strips along the rolling direction, cut into cells that end where the contact ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from contact.pose import Array, Nodes


@dataclass(frozen=True)
class Layout:
    """S strips of M cells.

    sides (S, 2) m, arc length on the wheel's profile; ends (S, 2) m, trailing and leading end along the rolling
    circle; patch (S,) to which a strip belongs, in order; marks (M + 1,) from 0 (trailing) to 1, where cells end.
    """

    sides: Array
    ends: Array
    patch: Nodes
    marks: Array

    @property
    def edges(self) -> Array:
        """Ends (S, M + 1) m of the cells."""
        return np.asarray(self.ends[:, :1] + np.diff(self.ends) * self.marks)

    @property
    def middle(self) -> Array:
        """Arc length (S,) m of the strips' middles."""
        return np.asarray(self.sides.mean(axis=1))

    @property
    def width(self) -> Array:
        """Width (S,) m of the strips."""
        return np.asarray(self.sides[:, 1] - self.sides[:, 0])


def marks(cells: int, *, rolling: bool) -> Array:
    """Ends (cells + 1,) of the cells of a strip, from 0 to 1: quadratically denser towards the leading end of a rolling
    contact, where traction starts like a square root; equal without friction.
    """
    t = np.linspace(0.0, 1.0, cells + 1)
    return np.asarray(1 - (1 - t) ** 2 if rolling else t)


@dataclass(frozen=True)
class EdgeRule:
    """How far a strip's contact reaches beyond the end of its cells, from the pressures of the last two.

    Near an end that is short by z the pressure goes like (xi + z) / sqrt(xi), xi the distance from the end, Johnson
    1985, ch. 5. own and other: means of sqrt(xi) in the last cell and the one before; excess those of 1 / sqrt(xi),
    with the lengths of the cells as parts of the strip. The ratio of the first two is that of the discrete solution.
    """

    own: float
    other: float
    own_excess: float
    other_excess: float

    def beyond(self, last: Array, before: Array) -> Array:
        """z as part of the strip's length from the mean pressures of the last cells and those before."""
        bottom = before * self.own_excess - last * self.other_excess
        return np.asarray((self.other * last - self.own * before) / np.where(bottom == 0, np.inf, bottom))


@lru_cache
def edge_rules(cells: tuple[float, ...]) -> tuple[EdgeRule, EdgeRule]:
    """Rules for the trailing and the leading end, exact for the line contact of two cylinders on such cells.

    cells: the marks. The discrete pressures of a line contact whose ends are known fix the ratio of own and other.
    """
    t = np.array(cells, dtype=float)
    pressure = line_contact(2.0 * t - 1.0)
    rules = []
    for edge, p in ((t, pressure), (1 - t[::-1], pressure[::-1])):
        first, both = edge[1], edge[2]
        root = np.sqrt(first)
        own = 2 / 3 * root
        rules.append(EdgeRule(own, own * p[1] / p[0], 2 / root, 2 / (np.sqrt(both) + root)))
    return rules[0], rules[1]


def line_contact(edges: Array) -> Array:
    """Mean pressures of cells that end at edges (m + 1,), -1 to 1, in the line contact of unit load of which these are
    the true ends: p = 2/pi sqrt(1 - x^2), and -2 int ln|x - x'| p dx' = const - x^2 ... in the mean over every cell.
    """
    low, high = edges[:-1], edges[1:]
    length = high - low

    def kernel(x: Array) -> Array:  # second antiderivative of -ln|x|
        return np.where(x == 0, 0.0, 0.75 * x * x - 0.5 * x * x * np.log(np.maximum(np.abs(x), 1e-300)))

    away = kernel(edges[:, None] - edges)
    # means over cells by loads of unit traction; a constant changes nothing but the approach, and keeps it regular
    matrix = -np.diff(np.diff(away, axis=0), axis=1) / length[:, None] + 3 * length
    gap = (low * low + low * high + high * high) / 3
    rigid, bent = np.linalg.solve(matrix, np.column_stack([np.ones(len(gap)), gap])).T
    approach = (1 + length @ bent) / (length @ rigid)
    return np.asarray(approach * rigid - bent)


TIP = -0.123  # where the parabola ends for strips that end where the contact does: -0.111 to -0.128 for elliptic
# contacts of a/b = 0.5 to 2 on 6 to 16 strips of half-spaces
CAUTION = 1.1  # of a step of the tips


def tip(loads: Array) -> float:
    """Where the contact ends beside a run of strips of equal width, in widths outwards of the last strip's side.

    loads (n,) of the strips per width, the last one first: a parabola through the means of the last three (a line for
    two), as the load of an elliptic contact is 1 - y^2. Within -1/2 .. 1/2.
    """
    n = min(len(loads), 3)
    j = np.arange(n)
    means = np.column_stack([np.ones(n), j + 0.5, j * j + j + 1 / 3])[:, :n]
    c = np.linalg.solve(means, loads[:n])
    roots = np.roots(c[::-1]) if np.abs(c[1:]).max(initial=0.0) > 0 else np.array([])
    real = roots[np.abs(roots.imag) < 1e-9 * (1 + np.abs(roots))].real
    if not len(real):
        return 0.5 if loads[0] > 0 else -0.5
    return float(np.clip(CAUTION * (-real[np.argmin(np.abs(real))] - TIP), -0.5, 0.5))
