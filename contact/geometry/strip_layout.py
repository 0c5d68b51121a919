"""Strips along the rolling direction, cut into cells that end where the contact ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True)
class StripLayout:
    """S strips of M cells.

    Parameters:
        sides: (S, 2) m, lateral bounds, arc length on the wheel's profile.
        ends: (S, 2) m, trailing and leading end along the rolling circle.
        patch: (S,) number of the part, of strips of one width, to which a strip belongs, in order.
        marks: (M + 1,) cell boundaries from 0 (trailing) to 1 (leading).
    """

    sides: Array
    ends: Array
    patch: Nodes
    marks: Array

    @cached_property
    def edges(self) -> Array:
        """Cell boundaries (S, M + 1) m along the rolling circle."""
        return np.asarray(self.ends[:, :1] + np.diff(self.ends) * self.marks)

    @cached_property
    def middle(self) -> Array:
        """Arc length (S,) m of the strips' middles."""
        return np.asarray(self.sides.mean(axis=1))

    @cached_property
    def width(self) -> Array:
        """Width (S,) m of the strips."""
        return np.asarray(self.sides[:, 1] - self.sides[:, 0])


LEADING = 0.35  # fraction of the cells' grading towards the leading end alone


def connected(layout: StripLayout, pressure: Array) -> Nodes:
    """Patch (S,) of every strip, -1 where it has no positive pressure (S, M): adjacent loaded cells share a patch."""
    presses = pressure > 0
    patch = np.full(len(presses), -1)
    edges = layout.edges
    count = -1
    for i, row in enumerate(presses):
        if not row.any():
            continue
        touches = False
        if i > 0 and patch[i - 1] >= 0 and layout.sides[i, 0] - layout.sides[i - 1, 1] <= 1e-9 * layout.width[i]:
            starts, previous_stops = edges[i][:-1][row], edges[i - 1][1:][presses[i - 1]]
            touches = bool(
                starts[0] < previous_stops[-1] and edges[i - 1][:-1][presses[i - 1]][0] < edges[i][1:][row][-1]
            )
        count += not touches
        patch[i] = count
    return patch


def marks(cells: int, *, rolling: bool) -> Array:
    """Cell boundaries (cells + 1,) of a strip, from 0 to 1.

    Uniform without rolling. In rolling the traction grows as a square root from the leading end and, under full stick,
    as an inverse square root towards the trailing end: cells shrink quadratically towards both, more towards the first.
    """
    t = np.linspace(0.0, 1.0, cells + 1, dtype=np.float64)
    if not rolling:
        return t
    return np.asarray(LEADING * (1 - (1 - t) ** 2) + (1 - LEADING) * 0.5 * (1 - np.cos(np.pi * t)))
