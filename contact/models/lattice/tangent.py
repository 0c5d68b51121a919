"""Derivative of force and moment by pose and motion, from the Jacobian of the converged equations with moving ends.

With R(u, g) = 0 the equations and g the twelve changes of `wheelrail.contact.kinematics.sensitivity`, the unknowns
change by u' = -J^-1 dR/dg (implicit function theorem). The set of loaded strips is fixed: a strip comes and goes with
no load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.models.lattice.derivatives import resultant_slopes
from wheelrail.contact.models.lattice.pose_derivatives import residual_changes
from wheelrail.contact.models.lattice.solver.factors import Factors
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.surface import touching_changes
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
        problem, values = self.problem, self.solution.state.values
        data = problem.of(self.solution.state.strips)
        load, slopes = resultant_slopes(values, data)
        total, self.solution.factors = self.of_sums(slopes)
        if problem.surface.revolves:  # the strips move with the wheel
            total[:, :6] += co_moving_load(load, problem.pose.origin)
        return total

    def of_sums(self, weights: Array) -> tuple[Array, Factors]:
        """Derivatives (k, 12) by pose and motion of sums of the unknowns with weights (k, n), and the factors."""
        problem, state = self.problem, self.solution.state
        linearisation = problem.linearise(state)
        factors = Factors.of(linearisation)
        multipliers = factors.solve_transposed(linearisation.jacobian, weights.T)
        lattice = problem.lines, (problem.middle, problem.width)
        data = problem.of(state.strips)
        by_pose = residual_changes(state.values, data, *lattice, linearisation.slopes, problem.tables.lines)
        return np.asarray(-multipliers.T @ by_pose), factors

    def touching(self, own: Nodes) -> tuple[Array, Array]:
        """Derivatives (S, 6) by the pose of the places of largest penetration along x on strips (S,), and of the
        closest points on the lower body.
        """
        problem = self.problem
        places = problem.middle[own], problem.crest[0][own], problem.lines.foot[own]
        return touching_changes(problem.surface, problem.data, *places)
