"""Derivative of force and moment by pose and motion, from the Jacobian of the converged equations with moving ends.

With R(u, g) = 0 the equations and g the twelve changes of `wheelrail.contact.kinematics.sensitivity`, the unknowns
change by u' = -J^-1 dR/dg (implicit function theorem). The set of loaded strips is fixed: a strip comes and goes with
no load.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.kinematics.sensitivity import displacement_derivative, rigid_slip, rotation_derivative, skew
from wheelrail.contact.models.lattice.equations import Evaluation, force_jumps, strip_grid
from wheelrail.contact.models.lattice.equations import rigid_slip as rigid_slip_of
from wheelrail.contact.models.lattice.factors import Factors
from wheelrail.contact.models.lattice.influence.basis import MODES, MOMENTS
from wheelrail.contact.models.lattice.influence.operator import antiderivatives, slips_and_moments
from wheelrail.contact.models.lattice.newton import LatticeSolution
from wheelrail.contact.models.lattice.problem import LatticeProblem
from wheelrail.contact.models.lattice.surface import GAUSS, SurfaceFrames, crest_changes, frames
from wheelrail.contact.solvers.tangent import CHANGES, co_moving_load
from wheelrail.support.arrays import Array

DIFFERENCE = 1e-5  # m, of the places on the lower body
NEGLIGIBLE = 1e-4  # of the largest singular value of their derivatives


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
    def places(self) -> SurfacePoints:
        """Cells of the solution."""
        return self.problem.cell_places(self.solution.state)

    @cached_property
    def _linearised(self) -> tuple[Evaluation, Array, Array]:
        """Evaluation, Jacobian and rho of the solution."""
        return self.problem.linearise(self.solution.state)

    @property
    def evaluation(self) -> Evaluation:
        """Evaluation of the solution."""
        return self._linearised[0]

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        _, jacobian, rho = self._linearised
        self.solution.factors = Factors.of(jacobian, rho)
        change = -self.solution.factors.solve(self._by_pose())
        displacements = displacement_derivative(self.places.point).transpose(1, 2, 0)
        units = (self.places.axes @ displacements) * self.places.area[:, None, None]
        total = self._by_unknowns(units) @ change
        assert self.places.sensitivity is not None
        if self.places.sensitivity.moves_with_wheel:
            local = self._local().reshape(-1, 3)
            total[:, :6] += co_moving_load(np.einsum("nk,nkj->j", local, units), self.problem.pose.origin)
        return np.asarray(total)

    def _local(self) -> Array:
        """Tractions (S, M, 3) Pa along, across and outward."""
        evaluation, state = self.evaluation, self.solution.state
        local = np.zeros((*evaluation.pressure.shape, 3))
        if self.problem.rolls:
            local[..., :2] = state.tractions.transpose(0, 2, 1)
        local[..., 2] = -evaluation.pressure
        return local

    def _by_unknowns(self, units: Array) -> Array:
        """Derivative (6, n) of force and moment by the unknowns; units (cells, 3, 6) of unit tractions."""
        problem, state = self.problem, self.solution.state
        S, block = state.values.shape
        M = problem.cells
        own = units.reshape(S, M, 3, 6)
        total = np.zeros((S, block, 6))
        if problem.rolls:
            total[:, : 2 * M] = own[:, :, :2].transpose(0, 2, 1, 3).reshape(S, 2 * M, 6)
        total[:, -2 - MODES : -2] = -np.einsum("srj,rm->smj", own[:, :, 2], problem.basis.mean)
        local = self._local()
        loads = np.einsum("srk,srkj->srj", local, own)
        moved = self._moved(loads.reshape(-1, 6)).reshape(S, M, 6)
        longer = loads.sum(axis=1) / np.diff(state.ends)
        share = problem.cell_middles[:, None]
        total[:, -2] = -longer + (moved * (1 - share)).sum(axis=1)
        total[:, -1] = longer + (moved * share).sum(axis=1)
        return total.reshape(S * block, 6).T

    def _frames(self, pose: Pose, s: Array, x: Array) -> SurfaceFrames:
        """Points and axes of the wheel in a pose."""
        return frames(self.problem.surface, pose.origin, np.ascontiguousarray(pose.rotation), s, x)

    def _deepening(self) -> Array:
        """Derivative (S, STATIONS, 6) of the penetration at the stations by the pose."""
        problem, state = self.problem, self.solution.state
        x = state.ends[:, :1] + np.diff(state.ends) * problem.basis.stations
        total = np.zeros((*x.shape, 6))
        for side in (-GAUSS, GAUSS):
            s = problem.middle[state.strips] + side * problem.width[state.strips]
            at = problem.penetration(np.repeat(s, x.shape[1]), x.ravel())
            total += 0.5 * at.pose.reshape(total.shape)
        return total

    def _moved(self, loads: Array) -> Array:
        """Change (cells, 6) of the loads of the cells as these move along x."""
        problem, state = self.problem, self.solution.state
        x = state.ends[:, :1] + np.diff(state.ends) * problem.cell_middles
        s = np.repeat(problem.middle[state.strips], problem.cells)
        at = self._frames(problem.pose, s, x.ravel())
        force = np.cross(at.turn, loads[:, :3])
        moment = np.cross(at.forward, loads[:, :3]) + np.cross(at.point, force)
        return np.hstack([force, moment])

    def _by_pose(self) -> Array:
        """Derivative (n, 12) of the residual at fixed unknowns."""
        problem, evaluation, state = self.problem, self.evaluation, self.solution.state
        S, block = state.values.shape
        M = problem.cells
        total = np.zeros((S, block, CHANGES))
        depth = self._deepening()
        total[:, -MOMENTS:, :6] = np.einsum("kg,sgj->skj", problem.basis.penetration, depth)
        slips, moments = self._by_compliance()
        total[:, -MOMENTS:, :6] += moments
        if problem.rolls:
            speed = np.zeros(CHANGES) if problem.shifts else self._speed()
            rigid, _ = rigid_slip_of(state.values, problem.of(state.strips))
            shift, _ = rigid_slip(self.places, problem.pose.origin, problem.motion, np.zeros((6, S * M)))
            if problem.surface.revolves:
                shift[:6, : S * M] -= self._level()
            shift = shift.reshape(CHANGES, 2, S, M).transpose(2, 1, 3, 0)
            creep = (shift - rigid[..., None] * speed) / problem.speed
            D = problem.friction_slopes(state, evaluation, self._linearised[2])
            by_slip = D[:, :, 4:8].reshape(S, M, 2, 2)
            creep[..., :6] += slips
            rows = np.einsum("srab,sbrj->sarj", by_slip, creep)
            rows += D[:, :, 10:].transpose(0, 2, 1)[..., None] * speed
            total[:, : 2 * M] = rows.reshape(S, 2 * M, CHANGES)
        return total.reshape(S * block, CHANGES)

    def _by_compliance(self) -> tuple[Array, Array]:
        """Derivatives (S, 2, M, 6) of slips and (S, MOMENTS, 6) of moments by the strips' places on the lower body.

        The deviation of the lower body from a half-space varies slowly: differences over the principal directions of
        the strips' displacements on it.
        """
        problem, state = self.problem, self.solution.state
        S, M = len(state.strips), problem.cells
        slips, moments = np.zeros((S, 2, M, 6)), np.zeros((S, MOMENTS, 6))
        if not problem.tables.moves:
            return slips, moments
        strips = problem.of(state.strips).places
        grid = strip_grid(state.values, strips, problem.basis)
        jumps = force_jumps(state.values, strips, problem.basis, problem.rolls)
        at = problem.lines
        before = slips_and_moments(self.evaluation.V, grid, problem.basis)
        shapes, size, amounts = np.linalg.svd(at.foot_pose[state.strips], full_matrices=False)
        for k in np.flatnonzero(size > NEGLIGIBLE * size[0]):
            feet = at.foot.copy()
            feet[state.strips] += DIFFERENCE * shapes[:, k]
            _, V = antiderivatives(problem.tables.of(state.strips, feet, problem.reach), grid, jumps)
            slip, moment = slips_and_moments(V, grid, problem.basis)
            amount = size[k] * amounts[k] / DIFFERENCE
            slips += (slip - before[0])[..., None] * amount
            moments += (moment - before[1])[..., None] * amount
        return slips, moments

    def _level(self) -> Array:
        """Derivative (6, S M) by the pose of the rail's velocity along the level axes, less that along the circle."""
        problem, state = self.problem, self.solution.state
        strips, rail = problem.of(state.strips).places, problem.motion.rail
        at, M = problem.lines, problem.cells
        velocity = rail.at(self.places.point)
        level = np.repeat(strips.level, M, axis=0)
        moved = displacement_derivative(self.places.point - problem.pose.origin) @ skew(rail.rotation).T
        change = np.zeros((6, len(level)))
        for sign, axes in ((1.0, level), (-1.0, self.places.axes[:, 0])):
            change += sign * ((rotation_derivative(axes) * velocity).sum(axis=2) + (moved * axes).sum(axis=2))
        own = state.strips
        crest = crest_changes(problem.surface, problem.data.rotation, at.foot[own], at.foot_pose[own])
        along = self._frames(problem.pose, problem.middle[own], problem.crest[0][own]).turn
        rise = (np.cross(along, level) * velocity).sum(axis=1)
        return np.asarray(change + np.repeat(crest, M, axis=0).T * rise)

    def _speed(self) -> Array:
        """Derivative (12,) of `LatticeProblem.speed`."""
        problem = self.problem
        own = problem.candidates
        s, x = problem.middle[own], problem.crest[0][own]
        deepening = np.zeros((6, len(own)))
        for side in (-GAUSS, GAUSS):
            deepening += 0.5 * problem.penetration(s + side * problem.width[own], x).pose.T
        at_crest = self._frames(problem.pose, s, x)
        depth = problem.depth[own]
        places = SurfacePoints(
            point=at_crest.point,
            axes=at_crest.axes,
            area=depth * problem.width[own],
            penetration=depth,
            wheel_rotation=problem.pose.rotation,
            step=problem.width[own],
            wheel_place=np.zeros((len(own), 2)),
            rail_place=np.zeros((len(own), 2)),
            sensitivity=self.places.sensitivity,
        )
        return rigid_slip(places, problem.pose.origin, problem.motion, 2 * deepening)[1]
