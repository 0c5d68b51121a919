"""Cells of the tables of pairs of strips along x, and the components that are tabulated."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled

CELLS = 8  # an octave
DEGREE = 5
COMPONENTS = 8
XX, TT, NN, TN, TN_TURN, XT, ROLL, XN = range(COMPONENTS)
EVEN = 5  # components that are even functions of x, the first ones; the others are odd
REACH = 0.25  # m, longest distance along x


def lobatto(count: int) -> Array:
    """Chebyshev-Lobatto points (count,) from 0 to 1."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1)))


TO_POWERS = np.linalg.inv(np.vander(lobatto(DEGREE + 1), increasing=True))


def _slope_changes() -> Array:
    """Powers (2, DEGREE + 1) of polynomials that are zero at both ends and at the middle nodes, with slopes 1 and 0 at
    the ends, and 0 and 1.
    """
    nodes = lobatto(DEGREE + 1)
    kept = np.poly1d(nodes[[0, 2, 3, 5]], r=True)
    changes = (kept * np.poly1d([-1.0, 1.0]), kept * np.poly1d([1.0, 0.0]))
    return np.array([change.coeffs[::-1] / change.deriv()(end) for end, change in enumerate(changes)])


CHANGES = _slope_changes()


@compiled
def join_cells(values: Array, width: Array, even: int) -> None:
    """Make polynomials continuously differentiable, in place: at bounds their slopes become the mean of both cells'.

    The errors of both slopes have opposite signs. A jump, 1e-6 of the slope, would be a step of the displacement, on
    which ends of short strips have no place.

    Parameters:
        values: (n, DEGREE + 1, m), of powers of z less the cell's lower bound.
        width: (n,) of the cells.
        even: number of functions, the first ones, whose slope at the first bound is 0.
    """
    n, _, m = values.shape
    slopes = np.empty((2, n, m))  # at the lower and at the upper bound
    for cell in range(n):
        for c in range(m):
            slopes[0, cell, c], slopes[1, cell, c], power = values[cell, 1, c], 0.0, 1.0
            for k in range(1, DEGREE + 1):
                slopes[1, cell, c] += k * power * values[cell, k, c]
                power *= width[cell]
    for cell in range(n):
        for c in range(m):
            low, high = slopes[0, cell, c], slopes[1, cell, c]
            lower = 0.5 * (slopes[1, cell - 1, c] - low) if cell else -low if c < even else 0.0
            upper = 0.5 * (slopes[0, cell + 1, c] - high) if cell < n - 1 else 0.0
            power = width[cell]
            for k in range(DEGREE + 1):
                values[cell, k, c] += power * (lower * CHANGES[0, k] + upper * CHANGES[1, k])
                power /= width[cell]


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

    def coefficients(self, samples: Array, *, even: bool) -> Array:
        """Coefficients (n, DEGREE + 1, m) from samples (n (DEGREE + 1), m) at `x` of even or odd functions."""
        by_cell = samples.reshape(len(self.lower), DEGREE + 1, -1)
        values = np.asarray(TO_POWERS @ by_cell / self.width[:, None, None] ** np.arange(DEGREE + 1)[:, None])
        join_cells(values, self.width, values.shape[-1] if even else 0)
        return values
