"""Derivative of force and moment by pose and motion, from the Jacobian of the converged equations with moving ends.

With R(u, g) = 0 the equations and g the twelve changes of `wheelrail.contact.kinematics.sensitivity`, the unknowns
change by u' = -J^-1 dR/dg (implicit function theorem). The set of loaded strips is fixed: a strip comes and goes with
no load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import (
    Factors,
    TangentPlaces,
    TangentSums,
    derivatives_of_resultants,
    derivatives_of_sums,
    touching_changes,
)
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.solver.factors import SINGULAR, lapack
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.solvers.options import NotConverged
from wheelrail.contact.solvers.tangent import co_moving_load
from wheelrail.support.arrays import Array, Nodes


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
        load, found = derivatives_of_resultants(state.values, problem.of(state.strips), self._places, lapack())
        total, self.solution.factors = _checked(found)
        if problem.surface.revolves:  # the strips move with the wheel
            total[:, :6] += co_moving_load(load, problem.pose.origin)
        return total

    def of_sums(self, weights: Array) -> tuple[Array, Factors]:
        """Derivatives (k, 12) by pose and motion of sums of the unknowns with weights (k, n), and the factors."""
        state, weights = self.solution.state, np.ascontiguousarray(weights)
        return _checked(
            derivatives_of_sums(state.values, self.problem.of(state.strips), self._places, lapack(), weights)
        )

    def touching(self, own: Nodes) -> tuple[Array, Array]:
        """Derivatives (S, 6) by the pose of the places of largest penetration along x on strips (S,), and of the
        closest points on the lower body.
        """
        problem = self.problem
        places = problem.middle[own], problem.crest[0][own], problem.lines.foot[own]
        return touching_changes(problem.surface, problem.data, *places)

    @property
    def _places(self) -> TangentPlaces:
        return TangentPlaces(self.problem.lines, self.problem.tables.lattice, self.problem.tables.lines)


def _checked(found: TangentSums) -> tuple[Array, Factors]:
    """Derivatives and factors. Raises OutsideSurface and NotConverged."""
    if not found.inside:
        raise OutsideSurface(TOO_LONG)
    if not found.regular:
        raise NotConverged(SINGULAR)
    return found.changes, found.factors
