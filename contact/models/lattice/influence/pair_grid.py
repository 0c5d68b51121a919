"""Cells of the tables of pairs of strips along x, and the components that are tabulated."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import CELLS, DEGREE, REACH, CellRule, join_cells
from wheelrail.support.arrays import Array


def lobatto(count: int) -> Array:
    """Chebyshev-Lobatto points (count,) from 0 to 1."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(count) / (count - 1)))


NODES = lobatto(DEGREE + 1)
TO_POWERS = np.linalg.inv(np.vander(NODES, increasing=True))
INTEGRALS = (NODES[:, None] ** np.arange(1, DEGREE + 2) / np.arange(1, DEGREE + 2)) @ TO_POWERS  # from 0 to the nodes


def _slope_changes() -> Array:
    """Coefficients (2, DEGREE + 1), ascending, of polynomials zero at ends and middle nodes, with end slopes (1, 0),
    (0, 1).
    """
    kept = np.poly1d(NODES[[0, 2, 3, 5]], r=True)
    changes = (kept * np.poly1d([-1.0, 1.0]), kept * np.poly1d([1.0, 0.0]))
    return np.array([change.coeffs[::-1] / change.deriv()(end) for end, change in enumerate(changes)])


CHANGES = _slope_changes()
RULE = CellRule(NODES, TO_POWERS, INTEGRALS, CHANGES)  # for the core


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

    @cached_property
    def x(self) -> Array:
        """Distances (n (DEGREE + 1),) m."""
        z = self.lower[:, None] + self.width[:, None] * NODES
        return np.asarray(((z - 1) * self.start).ravel())

    def coefficients(self, samples: Array, *, even: bool) -> Array:
        """Coefficients (n, DEGREE + 1, m) from samples (n (DEGREE + 1), m) at `x` of even or odd functions."""
        by_cell = samples.reshape(len(self.lower), DEGREE + 1, -1)
        values = np.asarray(TO_POWERS @ by_cell / self.width[:, None, None] ** np.arange(DEGREE + 1)[:, None])
        join_cells(values, self.width, values.shape[-1] if even else 0, RULE)
        return values
