"""Solutions of a lattice contact by name, for inspection of the core's results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from wheelrail.bindings._contact import MODES, LatticeSolution, LatticeStart
from wheelrail.support.arrays import Array, Mask, Nodes


@dataclass(frozen=True)
class LatticeState:
    """S loaded strips.

    Parameters:
        strips: (S,) their numbers on the lattice, ascending.
        values: (S, 2 M + MODES + 2), strip by strip: tractions Pa of the cells along and across (none without
            friction), amplitudes Pa of the pressure modes, and ends m.
    """

    strips: Nodes
    values: Array

    @classmethod
    def of(cls, solution: LatticeSolution) -> LatticeState:
        """That of a solution."""
        return cls(solution.strips, solution.values)

    @property
    def ends(self) -> Array:
        """Trailing and leading ends (S, 2) m along the rolling circle."""
        return self.values[:, -2:]

    @property
    def modes(self) -> Array:
        """Amplitudes (S, MODES) Pa."""
        return self.values[:, -2 - MODES : -2]

    @property
    def tractions(self) -> Array:
        """Tractions (S, 2, M) Pa; M = 0 without friction."""
        return self.values[:, : -2 - MODES].reshape(len(self.strips), 2, -1)

    @property
    def half(self) -> Array:
        """Half lengths (S,) m."""
        return np.asarray(0.5 * (self.values[:, -1] - self.values[:, -2]))

    @property
    def load(self) -> Array:
        """Amplitude times half length (S,) Pa m, proportional to the load per width."""
        return np.asarray(self.half * self.modes[:, 0])

    def at(self, chosen: Mask) -> LatticeState:
        """State of the strips in a mask (S,)."""
        return LatticeState(self.strips[chosen], self.values[chosen])


def states_of(warm_start: object) -> Mapping[int, LatticeState]:
    """States by level, for levels whose forces count, from the warm start in a lattice result."""
    if not isinstance(warm_start, LatticeStart):
        return {}
    levels = zip(warm_start.levels, warm_start.solutions, strict=True)
    return {level: LatticeState.of(solution) for level, solution in levels if solution is not None}
