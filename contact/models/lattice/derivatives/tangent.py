"""Derivative of force and moment by pose and motion, from the Jacobian of the converged equations with moving ends.

With R(u, g) = 0 the equations and g the twelve changes of `wheelrail.contact.kinematics.sensitivity`, the unknowns
change by u' = -J^-1 dR/dg (implicit function theorem). The set of loaded strips is fixed: a strip comes and goes with
no load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.lattice.derivatives.residual import residual_changes
from wheelrail.contact.models.lattice.derivatives.resultants import CHANGES, resultant_slopes
from wheelrail.contact.models.lattice.influence.pair_tables import Lattice
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.solver.factors import (
    SINGULAR,
    Factors,
    Lapack,
    factorised,
    lapack,
    solve_transposed,
)
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.contact_lines import ContactLines
from wheelrail.contact.models.lattice.system.equations import EquationData, linearised
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.surface import touching_changes
from wheelrail.contact.solvers.options import NotConverged
from wheelrail.contact.solvers.tangent import co_moving_load
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled, inlined

Places = tuple[ContactLines, Lattice, Array]  # `residual_changes`


@dataclass(frozen=True, eq=False)
class LatticeTangent:
    """Linearisation of a solution.

    Parameters:
        problem: equations.
        solution: their solution.
    """

    problem: LatticeProblem
    solution: LatticeSolution

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        problem, state = self.problem, self.solution.state
        load, outcome = _of_resultants(state.values, problem.of(state.strips), self._places, lapack())
        total, self.solution.factors = _checked(*outcome)
        if problem.surface.revolves:  # the strips move with the wheel
            total[:, :6] += co_moving_load(load, problem.pose.origin)
        return total

    def of_sums(self, weights: Array) -> tuple[Array, Factors]:
        """Derivatives (k, 12) by pose and motion of sums of the unknowns with weights (k, n), and the factors."""
        state, weights = self.solution.state, np.ascontiguousarray(weights)
        return _checked(*_of_sums(state.values, self.problem.of(state.strips), self._places, lapack(), weights))

    def touching(self, own: Nodes) -> tuple[Array, Array]:
        """Derivatives (S, 6) by the pose of the places of largest penetration along x on strips (S,), and of the
        closest points on the lower body.
        """
        problem = self.problem
        places = problem.middle[own], problem.crest[0][own], problem.lines.foot[own]
        return touching_changes(problem.surface, problem.data, *places)

    @property
    def _places(self) -> Places:
        return self.problem.lines, self.problem.tables.lattice, self.problem.tables.lines


def _checked(inside: bool, regular: bool, changes: Array, factors: Factors) -> tuple[Array, Factors]:
    """Outcome of `_sums`. Raises OutsideSurface and NotConverged."""
    if not inside:
        raise OutsideSurface(TOO_LONG)
    if not regular:
        raise NotConverged(SINGULAR)
    return changes, factors


@compiled
def _of_resultants(
    values: Array, data: EquationData, places: Places, solver: Lapack
) -> tuple[Array, tuple[bool, bool, Array, Factors]]:
    """Force and moment (6,) about the origin, and `_sums` of these."""
    load, slopes = resultant_slopes(values, data)
    return load, _sums(values, data, places, solver, slopes)


@compiled
def _of_sums(
    values: Array, data: EquationData, places: Places, solver: Lapack, weights: Array
) -> tuple[bool, bool, Array, Factors]:
    """`_sums` of some sums."""
    return _sums(values, data, places, solver, weights)


@inlined
def _sums(
    values: Array, data: EquationData, places: Places, solver: Lapack, weights: Array
) -> tuple[bool, bool, Array, Factors]:
    """Whether all distances lie in the tables and the Jacobian is regular, derivatives (k, CHANGES) of sums of the
    unknowns (S, block) with weights (k, S block), and the factors.
    """
    at, changes = linearised(values, data), np.zeros((len(weights), CHANGES))
    regular, factors = factorised(at, solver)
    if at.evaluation.inside and regular:
        multipliers = solve_transposed(factors, solver, at.jacobian, weights)
        changes -= np.dot(multipliers, residual_changes(values, data, *places, at.slopes))
    return at.evaluation.inside, regular, changes, factors
