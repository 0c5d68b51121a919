"""Derivative of force and moment by pose and motion, from the Jacobian of the converged equations with moving ends.

With R(u, g) = 0 the equations and g the twelve changes of `wheelrail.contact.kinematics.sensitivity`, the unknowns
change by u' = -J^-1 dR/dg (implicit function theorem). The set of loaded strips is fixed: a strip comes and goes with
no load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.sensitivity import rotation_derivative
from wheelrail.contact.models.lattice.derivatives import CHANGES, resultant_slopes, rigid_changes, speed_change
from wheelrail.contact.models.lattice.influence.basis import MOMENTS
from wheelrail.contact.models.lattice.influence.operator import antiderivatives, slips_and_moments
from wheelrail.contact.models.lattice.solver.factors import Factors
from wheelrail.contact.models.lattice.solver.newton import LatticeSolution
from wheelrail.contact.models.lattice.system.equations import (
    Linearisation,
    cell_frames,
    force_jumps,
    resultants,
    strip_grid,
)
from wheelrail.contact.models.lattice.system.equations import rigid_slip as rigid_slip_of
from wheelrail.contact.models.lattice.system.partial_width import opening_changes, partial_width_changes
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.surface import GAUSS, crest_changes, frames
from wheelrail.contact.solvers.tangent import co_moving_load
from wheelrail.support.arrays import Array, Nodes

NEGLIGIBLE = 1e-3  # of the largest singular value of their derivatives: 2e-6 of the tangent


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
        total, self.solution.factors = self.of_sums(resultant_slopes(values, data))
        if problem.surface.revolves:  # the strips move with the wheel
            total[:, :6] += co_moving_load(resultants(values, data), problem.pose.origin)
        return total

    def of_sums(self, weights: Array) -> tuple[Array, Factors]:
        """Derivatives (k, 12) by pose and motion of sums of the unknowns with weights (k, n), and the factors."""
        linearisation = self.problem.linearise(self.solution.state)
        factors = Factors.of(linearisation)
        multipliers = factors.solve_transposed(linearisation.jacobian, weights.T)
        return np.asarray(-multipliers.T @ self._by_pose(linearisation)), factors

    def _deepening(self, strips: Nodes, x: Array) -> Array:
        """Derivative (..., 6) by the pose of the penetration at x (...) on strips, whose shape broadcasts to that of x,
        means over their widths.
        """
        problem, total = self.problem, np.zeros((*x.shape, 6))
        for side in (-GAUSS, GAUSS):
            s = np.broadcast_to(problem.middle[strips] + side * problem.width[strips], x.shape)
            total += 0.5 * problem.penetration_changes(s.ravel(), x.ravel()).depth.reshape(total.shape)
        return total

    def _opening(self) -> Array:
        """Derivative (S, 6) by the pose of the gaps of strips that touch on a part of their width."""
        problem, state = self.problem, self.solution.state
        lines, places, load = problem.lines, problem.places(state.strips), state.load
        total, part = np.zeros((len(load), 6)), load < places.whole
        if not part.any():
            return total
        own = state.strips[part]
        near = own[:, None] + np.array([-1, 0, 1])
        change = self._deepening(near, lines.x[near])
        onset, whole = partial_width_changes(
            lines.depth[near], lines.curvature[own], problem.middle[near], problem.width[own], change
        )
        by_onset, by_whole = opening_changes(load[part], places.onset[part], places.whole[part])
        total[part] = by_onset[:, None] * onset + by_whole[:, None] * whole
        return total

    def _by_pose(self, at: Linearisation) -> Array:
        """Derivative (n, CHANGES) of the residual at fixed unknowns."""
        problem, state = self.problem, self.solution.state
        S, block = state.values.shape
        M = problem.cells
        total = np.zeros((S, block, CHANGES))
        x = state.ends[:, :1] + np.diff(state.ends) * problem.basis.stations
        depth = self._deepening(state.strips[:, None], x)
        total[:, -MOMENTS:, :6] = np.einsum("kg,sgj->skj", problem.basis.penetration, depth)
        slips, moments = self._by_compliance()
        total[:, -MOMENTS:, :6] += moments
        total[:, -MOMENTS, :6] += self._opening()
        if problem.rolls:
            shift, speed = self._rigid()
            rigid, _ = rigid_slip_of(state.values, problem.of(state.strips))
            creep = (shift - rigid[..., None] * speed) / problem.speed
            creep[..., :6] += slips
            D = at.slopes
            by_slip = D[:, :, 4:8].reshape(S, M, 2, 2)
            rows = np.einsum("srab,sbrj->sarj", by_slip, creep)
            rows += D[:, :, 8:10].transpose(0, 2, 1)[..., None] * speed
            total[:, : 2 * M] = rows.reshape(S, 2 * M, CHANGES)
        return total.reshape(S * block, CHANGES)

    def _rigid(self) -> tuple[Array, Array]:
        """Derivatives (S, 2, M, CHANGES) of the rigid slip m/s, and (CHANGES,) of the speed."""
        problem, state, moves = self.problem, self.solution.state, self.problem.surface.revolves
        data, M = problem.of(state.strips), problem.cells
        at = cell_frames(state.values, data.places, problem.basis, problem.surface, problem.data)
        level, level_change = np.repeat(data.places.level, M, axis=0), np.repeat(self._level(), M, axis=1)
        shift, _ = rigid_changes(at, level, level_change, problem.data, moves)
        speed = np.zeros(CHANGES)
        if not problem.shifts:
            own = problem.candidates
            place, depth = (problem.middle[own], problem.crest[0][own]), problem.depth[own]
            speed = speed_change(problem.surface, problem.data, *place, depth, problem.width[own], moves)
        return shift.reshape(CHANGES, -1, M, 2).transpose(1, 3, 2, 0), speed

    @cached_property
    def _touching(self) -> tuple[Array, Array]:
        return self.touching(self.solution.state.strips)

    def touching(self, own: Nodes) -> tuple[Array, Array]:
        """Derivatives (S, 6) by the pose of the places of largest penetration along x on strips (S,), and of the
        closest points on the lower body: these move along x with the former, which depend on the normals at the latter.
        """
        problem, data = self.problem, self.problem.data
        foot = problem.lines.foot[own]
        fixed = problem.penetration_changes(problem.middle[own], problem.crest[0][own]).foot
        crest = crest_changes(problem.surface, data.rotation, foot, fixed)
        if not problem.surface.revolves:
            return crest, fixed
        shifted = np.zeros_like(fixed)
        shifted[:, 0] = 1.0
        by_foot = crest_changes(problem.surface, data.rotation, foot, shifted)[:, 0]
        at = frames(problem.surface, data.origin, data.rotation, problem.middle[own], problem.crest[0][own])
        by_crest = (fixed[:, 1:3] * at.forward[:, 1:]).sum(axis=1)
        crest = crest / (1 - by_foot * by_crest)[:, None]
        return crest, fixed + by_crest[:, None] * crest

    def _level(self) -> Array:
        """Derivative (6, S, 3) by the pose of the longitudinal axes where the strips touch."""
        problem, own = self.problem, self.solution.state.strips
        level = problem.lines.level[own]
        if not problem.surface.revolves:
            return np.zeros((6, *level.shape))
        data = problem.data
        turn = frames(problem.surface, data.origin, data.rotation, problem.middle[own], problem.crest[0][own]).turn
        return np.asarray(rotation_derivative(level) + self._touching[0].T[..., None] * np.cross(turn, level))

    def _by_compliance(self) -> tuple[Array, Array]:
        """Derivatives (S, 2, M, 6) of slips and (S, MOMENTS, 6) of moments by the strips' places on the lower body.

        The strips' displacements on the lower body are few principal motions.
        """
        problem, state = self.problem, self.solution.state
        S, M = len(state.strips), problem.cells
        slips, moments = np.zeros((S, 2, M, 6)), np.zeros((S, MOMENTS, 6))
        if not problem.tables.moves:
            return slips, moments
        grid = strip_grid(state.values, problem.of(state.strips).places, problem.basis)
        jumps = force_jumps(state.values, problem.of(state.strips).places, problem.basis, problem.rolls)
        motions, size, amounts = np.linalg.svd(self._touching[1], full_matrices=False)
        principal = np.flatnonzero(size > NEGLIGIBLE * size[0])
        reach = float(np.ptp(grid.x))
        tables = problem.tables.slopes(state.strips, problem.lines.foot, motions[:, principal], reach)
        for k, slope in zip(principal, tables, strict=True):
            _, V = antiderivatives(slope, grid, jumps)
            slip, moment = slips_and_moments(V, grid, problem.basis)
            slips += slip[..., None] * size[k] * amounts[k]
            moments += moment[..., None] * size[k] * amounts[k]
        return slips, moments
