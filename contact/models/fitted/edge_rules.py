"""Rules for the free boundary: where the pressure of a strip vanishes, and where the patch ends across."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class EdgeRule:
    """Distance by which a strip's contact extends beyond its cells, from the pressures of the last two of them.

    Near an end that is short by z the pressure is proportional to (xi + z) / sqrt(xi), xi the distance from the end
    (Johnson 1985, ch. 5). own and other: means of sqrt(xi) in the last cell and the one before; excess: those of
    1 / sqrt(xi); lengths over the strip's. The ratio of own and other is that of the discrete solution.
    """

    own: float
    other: float
    own_excess: float
    other_excess: float

    def beyond(self, last: Array, before: Array) -> Array:
        """z over the strip's length from the mean pressures of the last cells and those before; infinite where no z
        gives so large a last pressure.
        """
        top, bottom = self.other * last - self.own * before, before * self.own_excess - last * self.other_excess
        return np.asarray(np.where(bottom > 0, top / np.where(bottom > 0, bottom, 1.0), np.copysign(np.inf, top)))


@lru_cache(maxsize=32)
def edge_rules(cells: tuple[float, ...]) -> tuple[EdgeRule, EdgeRule]:
    """Rules for the trailing and the leading end, exact for the line contact of two cylinders on such cells.

    cells: boundaries of the cells, 0 to 1. The ratio of own and other follows from the discrete pressures of a line
    contact with known ends.
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
    """Mean pressures of cells with edges (m + 1,), -1 to 1, in the line contact of unit load with these ends:
    p = 2/pi sqrt(1 - x^2), and -2 int ln|x - x'| p dx' = const - x^2 ... in the mean over every cell.
    """
    low, high = edges[:-1], edges[1:]
    length = high - low

    def kernel(x: Array) -> Array:  # second antiderivative of -ln|x|
        return np.where(x == 0, 0.0, 0.75 * x * x - 0.5 * x * x * np.log(np.maximum(np.abs(x), 1e-300)))

    away = kernel(edges[:, None] - edges)
    # means over cells by loads of unit traction; the constant only changes the approach, and keeps the matrix regular
    matrix = -np.diff(np.diff(away, axis=0), axis=1) / length[:, None] + 3 * length
    gap = (low * low + low * high + high * high) / 3
    rigid, bent = np.linalg.solve(matrix, np.column_stack([np.ones(len(gap)), gap])).T
    approach = (1 + length @ bent) / (length @ rigid)
    return np.asarray(approach * rigid - bent)


# Root of the parabola for strips that end with the contact: -0.111 to -0.128 for elliptic contacts of a/b = 0.5 to 2
# on 6 to 16 strips of half-spaces
TIP = -0.123
CAUTION = 1.1  # relaxation factor of the tips' steps


def tip(loads: Array) -> float:
    """Lateral end of the contact next to strips of equal width, in widths outwards of the last strip's side.

    loads (n,) of the strips per width, the last one first: root of a parabola through the means of the last three, as
    the load of an elliptic contact is 1 - y^2; where their curvature has the opposite sign, of the line through the
    last two, so that the tip is a continuous function of the loads. Within -1/2 .. 1/2.
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
