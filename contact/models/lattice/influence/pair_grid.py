"""Cells of the tables of pairs of strips along x, and the components that are tabulated."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.support.arrays import Array

CELLS = 8  # an octave
DEGREE = 5
COMPONENTS = 8
XX, TT, NN, TN, TN_TURN, XT, ROLL, XN = range(COMPONENTS)
REACH = 0.25  # m, longest distance along x


def lobatto(count: int) -> Array:
    """Chebyshev-Lobatto points (count,) from 0 to 1."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1)))


TO_POWERS = np.linalg.inv(np.vander(lobatto(DEGREE + 1), increasing=True))


@dataclass(frozen=True)
class PairGrid:
    """Distances along x at which a pair is sampled: cells (n,) from z = lower with given widths, start m."""

    start: float
    lower: Array
    width: Array

    @classmethod
    def over(cls, start: float) -> PairGrid:
        """Cells from 0 to `REACH`."""
        octaves = int(np.ceil(np.log2(1 + REACH / start)))
        octave, k = np.divmod(np.arange(octaves * CELLS), CELLS)
        return cls(start, 2.0**octave * (1 + k / CELLS), 2.0**octave / CELLS)

    def cells_up_to(self, x: float) -> int:
        """Number of cells up to a distance m."""
        return min(int(np.searchsorted(self.lower, x / self.start + 1)) + 1, len(self.lower))

    @cached_property
    def x(self) -> Array:
        """Distances (n (DEGREE + 1),) m."""
        z = self.lower[:, None] + self.width[:, None] * lobatto(DEGREE + 1)
        return np.asarray(((z - 1) * self.start).ravel())

    def coefficients(self, samples: Array) -> Array:
        """Coefficients (.., n, DEGREE + 1, m) from samples (.., n (DEGREE + 1), m) at `x`."""
        by_cell = samples.reshape(*samples.shape[:-2], len(self.lower), DEGREE + 1, -1)
        return np.asarray(TO_POWERS @ by_cell / self.width[:, None, None] ** np.arange(DEGREE + 1)[:, None])
