"""Strips along the rolling direction, cut into cells that end where the contact ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from contact.pose import Array, Nodes


@dataclass(frozen=True)
class Layout:
    """S strips of M cells.

    sides (S, 2) m, arc length on the wheel's profile; ends (S, 2) m, trailing and leading end along the rolling
    circle; patch (S,) number of the part, of strips
    of one width, to which a strip belongs, in order; marks (M + 1,) from 0 (trailing) to 1, where cells end.
    """

    sides: Array
    ends: Array
    patch: Nodes
    marks: Array

    @cached_property
    def edges(self) -> Array:
        """Ends (S, M + 1) m of the cells."""
        return np.asarray(self.ends[:, :1] + np.diff(self.ends) * self.marks)

    @cached_property
    def middle(self) -> Array:
        """Arc length (S,) m of the strips' middles."""
        return np.asarray(self.sides.mean(axis=1))

    @cached_property
    def width(self) -> Array:
        """Width (S,) m of the strips."""
        return np.asarray(self.sides[:, 1] - self.sides[:, 0])


LEADING = 0.35  # share of the cells' density that favours the leading end alone


def connected(layout: Layout, pressure: Array) -> Nodes:
    """Patch (S,) of every strip, -1 where none of its cells (S, M) presses: neighbours that press side by side."""
    presses = pressure > 0
    found = np.full(len(presses), -1)
    edges = layout.edges
    count = -1
    for i, row in enumerate(presses):
        if not row.any():
            continue
        touches = False
        if i > 0 and found[i - 1] >= 0 and layout.sides[i, 0] - layout.sides[i - 1, 1] <= 1e-9 * layout.width[i]:
            mine, other = edges[i][:-1][row], edges[i - 1][1:][presses[i - 1]]
            touches = bool(mine[0] < other[-1] and edges[i - 1][:-1][presses[i - 1]][0] < edges[i][1:][row][-1])
        count += not touches
        found[i] = count
    return found


def marks(cells: int, *, rolling: bool) -> Array:
    """Ends (cells + 1,) of the cells of a strip, from 0 to 1.

    Equal without rolling. Traction in rolling starts like a square root at the leading end and, where all sticks, rises
    like the inverse of one at the trailing end: cells shrink quadratically towards both, more towards the first.
    """
    t = np.linspace(0.0, 1.0, cells + 1, dtype=np.float64)
    if not rolling:
        return t
    return np.asarray(LEADING * (1 - (1 - t) ** 2) + (1 - LEADING) * 0.5 * (1 - np.cos(np.pi * t)))


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
        """z as part of the strip's length from the mean pressures of the last cells and those before; infinite where
        the last one is larger than any z makes it.
        """
        top, bottom = self.other * last - self.own * before, before * self.own_excess - last * self.other_excess
        return np.asarray(np.where(bottom > 0, top / np.where(bottom > 0, bottom, 1.0), np.copysign(np.inf, top)))


@lru_cache(maxsize=32)
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

    loads (n,) of the strips per width, the last one first: a parabola through the means of the last three, as the load
    of an elliptic contact is 1 - y^2, and where they bend the other way the line through the last two, so that the tip
    moves continuously with the loads. Within -1/2 .. 1/2.
    """
    first, second = loads[0], loads[min(1, len(loads) - 1)]
    bend = min(0.5 * (first - 2 * second + loads[2]), 0.0) if len(loads) > 2 else 0.0
    slope = second - first - 2 * bend  # at the last strip's side
    start = first - 0.5 * slope - bend / 3
    root = slope * slope - 4 * bend * start
    # the smaller root of start + slope t + bend t^2, where the load rises inwards; none: far outwards
    bottom = slope + np.sqrt(max(root, 0.0))
    reach = 2 * start / bottom if bottom > 0 else np.inf if start > 0 else -np.inf
    return float(np.clip(CAUTION * (reach - TIP), -0.5, 0.5))
