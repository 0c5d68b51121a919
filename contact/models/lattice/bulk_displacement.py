"""Displacement of finite bodies beyond that of half-spaces: the part of the penetration that is no contact.

Wheel and rail bend and twist as wholes. On a flange this is most of the penetration, 225 of 260 um at 14 kN, and wide
strips would seem to be many across it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import (
    BulkCompliance,
    bulk_displacements,
    bulk_places,
    hats,
    strip_loads,
    strips_beside_bulk,
)
from wheelrail.contact.models.lattice.derivatives.tangent import LatticeTangent
from wheelrail.contact.models.lattice.influence.body_correction import BodyCorrection
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.solvers.tangent import CHANGES
from wheelrail.support.arrays import Array, Nodes

NONE = np.zeros((2, 1))


@dataclass(frozen=True, eq=False)
class BulkDisplacement:
    """Displacement of both bodies in a solution of their equations.

    Parameters:
        problem: equations.
        solution: their solution.
    """

    problem: LatticeProblem
    solution: LatticeSolution

    @cached_property
    def rows(self) -> Nodes:
        """Strips (R,) that lie on the lines of both bodies."""
        return np.flatnonzero(self.problem.lines.covered)

    @property
    def strips_across(self) -> float:
        """Number of strips across the penetration less this displacement, by its means over the strips."""
        problem, state = self.problem, self.solution.state
        tables = problem.tables
        at = state.values, problem.of(state.strips), problem.lines, tables.lattice, tables.slenderness
        known, across = strips_beside_bulk(*at, tables.bulk)
        if not known:
            self.at(problem.candidates)
            _, across = strips_beside_bulk(*at, tables.bulk)
        return float(across)

    @cached_property
    def lift(self) -> Array:
        """Middles (R,) m of these strips, and by how much the penetration is less there, m: (2, R)."""
        if not len(self.rows):
            return NONE
        return np.stack([self.problem.middle[self.rows], self.at(self.rows)])

    def at(self, strips: Nodes) -> Array:
        """Displacement (R,) m of the middles of some strips; beyond the lines of a body, of the last one."""
        loaded, total = self.solution.state.strips, np.zeros(len(strips))
        width, both = self.problem.width[loaded], np.concatenate([strips, loaded])
        for body, bulk in self._bodies:
            place, _ = self._on_lines(body, bulk, both)
            places, middle = place[: len(strips)], place[len(strips) :]
            total += bulk_displacements(body.body.arc, body.bulk, places, middle, width, self._loads)
        return total

    def changes(self, weight: Array) -> Array:
        """Derivative (12,) by pose and motion of the sum of the lift times weights (R,)."""
        if not len(self.rows):
            return np.zeros(CHANGES)
        problem, state = self.problem, self.solution.state
        by_loads, by_place = np.zeros((len(state.strips), 2)), np.zeros(len(problem.middle))
        for body, bulk in self._bodies:
            both, window = self._on_lines(body, bulk, np.concatenate([self.rows, state.strips]))
            place, loaded = both[: len(self.rows)], both[len(self.rows) :]
            arc, width = body.body.arc[window], problem.width[state.strips]
            spread = np.einsum("k,kmc->mc", weight @ hats(arc, place), body.bulk[window, window])
            by_loads += body.shares(window, loaded, width) @ spread
            if bulk.moves:
                right = np.clip(np.searchsorted(arc, place), 1, len(arc) - 1)
                displaced = bulk_displacements(body.body.arc, body.bulk, arc, loaded, width, self._loads)
                slopes = np.diff(displaced) / np.diff(arc)
                by_place[self.rows] += weight * slopes[right - 1]
                shares = body.share_slopes(window, loaded, width)
                by_place[state.strips] += ((shares @ spread) * self._loads).sum(axis=1)
        tangent = LatticeTangent(problem, self.solution)
        total: Array = tangent.of_sums(self._by_unknowns(by_loads)[None])[0][0]
        moved = np.flatnonzero(by_place)
        if len(moved):
            total[:6] += by_place[moved] @ tangent.touching(moved)[1]
        return total

    @cached_property
    def _loads(self) -> Array:
        """Loads (S, 2) N of the strips."""
        problem, state = self.problem, self.solution.state
        return strip_loads(state.values, problem.of(state.strips).places, problem.basis, problem.rolls)

    def _by_unknowns(self, by_loads: Array) -> Array:
        """Derivative (n,) by the unknowns of the sum of the loads times weights (S, 2)."""
        problem, state = self.problem, self.solution.state
        total = np.zeros_like(state.values)
        area = (problem.width * problem.tables.stretch)[state.strips]
        across, normal = by_loads.T * area
        length, first = np.diff(state.ends)[:, 0], 0
        by_length = 0.25 * np.pi * normal * state.modes[:, 0]
        if problem.rolls:
            share, first = np.diff(problem.basis.marks), 2 * problem.cells
            total[:, problem.cells : first] = across[:, None] * share * length[:, None]
            by_length += across * (state.values[:, problem.cells : first] @ share)
        total[:, first] = 0.25 * np.pi * normal * length
        total[:, -1], total[:, -2] = by_length, -by_length
        return total.ravel()

    @property
    def _bodies(self) -> Iterable[tuple[BodyCorrection, BulkCompliance]]:
        """Finite bodies, each with its compliance for compiled code."""
        tables = self.problem.tables
        return ((body, bulk) for (_, body), bulk in zip(tables.bodies, tables.bulk, strict=True))

    def _on_lines(self, body: BodyCorrection, bulk: BulkCompliance, strips: Nodes) -> tuple[Array, slice]:
        """Arc length (R,) m of the middles of strips on a body, at most on its last lines, and lines around them."""
        problem, bounds = self.problem, bulk.bounds
        width = problem.width[strips]
        place = bulk_places(bulk, problem.middle[strips], width, problem.lines.foot[strips])
        low, high = place.argmin(), place.argmax()
        window = float(place[low] - 0.5 * width[low]), float(place[high] + 0.5 * width[high])
        return place, body.between_lines(max(window[0], bounds[0]), min(window[1], bounds[-1]))[0]
