"""Derivative of the contact force by pose and velocity, at a solution and its sets of points.

With the points fixed, and the same ones active, sticking and sliding, the laws are linear in small changes: N p' = d0'
+ D q' on the active points, s' = c' + S q' + T p', and F' = 0 of `wheelrail.contact.solvers.tangential`. Fixed are the
points (material points of the wheel in a frame that does not spin), their areas and the compliance between them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.linalg as la

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import MIRROR, RigidMotion, cross
from wheelrail.contact.kinematics.sensitivity import displacement_derivative, rigid_slip, skew
from wheelrail.contact.laws.linearised_friction import LinearisedFriction
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.contact.solvers.tractions import ContactCompliance, Tractions
from wheelrail.support.arrays import Array, Nodes

CHANGES = 12
MIRRORED = np.concatenate([MIRROR, -MIRROR])  # of a vector and an axial one


@dataclass(frozen=True, eq=False)
class TangentProblem:
    """Laws and compliance linearised at a solution, in the frame of the rail.

    Parameters:
        places: contact points.
        origin: (3,) m of the wheel's frame.
        motion: of both bodies; their displacements for speed 0, so that changes count in m and rad.
        operator, rigid, speed: as for `wheelrail.contact.solvers.tractions.solve_tractions`; speed 0 is a tangential
            displacement.
        laws: of the interface.
        found: the solution.

    Cost for a active points with friction: 18 a^3 if it changes the pressure, 5 a^3 if not or if a `ContactCompliance`
    has cached the linearisation; 2 a^3 / 3 without friction.
    """

    places: SurfacePoints
    origin: Array
    motion: RigidMotion
    operator: Array | ContactCompliance
    rigid: Array | None
    speed: float
    laws: ContactLaws
    found: Tractions

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin.

        The columns are the changes of `wheelrail.contact.kinematics.sensitivity`.
        """
        index = np.flatnonzero(self.found.pressure > 0)
        a, axes = len(index), self.places.axes[index]
        # forces and moments (a, 3, 6) of unit tractions are their virtual work
        units = (axes @ displacement_derivative(self.places.point[index]).transpose(1, 2, 0)) * self.places.area[
            index, None, None
        ]
        p, q = self._tractions(index)
        change: Array = -units[:, 2].T @ p
        if q is not None:
            change += units[:, 0].T @ q[:a] + units[:, 1].T @ q[a:]
        if self.places.sensitivity is not None and self.places.sensitivity.moves_with_wheel:
            local = np.column_stack([self.found.tangential[index], -self.found.pressure[index]])
            change[:, :6] += co_moving_load(np.einsum("nk,nkj->j", local, units), self.origin)
        return change

    def _tractions(self, index: Nodes) -> tuple[Array, Array | None]:
        """Derivatives of pressures (a, 12) and of tangential tractions (2 a, 12) at the active points."""
        places, n, a = self.places, len(self.places.area), len(index)
        assert places.sensitivity is not None
        operator = self.operator
        body = operator if isinstance(operator, ContactCompliance) else ContactCompliance(operator, n, self.laws)
        active = self.found.pressure > 0
        factor = body.normal.of(active, IterationCount())
        penetration = places.sensitivity.penetration(places, self.origin)
        deepening = np.zeros((a, CHANGES))
        deepening[:, :6] = penetration[:, index].T
        p = la.lu_solve(factor, deepening, check_finite=False)
        if self.rigid is None:
            return p, None
        rows = np.concatenate([index, n + index])
        rigid_change, speed = rigid_slip(places, self.origin, self.motion, penetration)
        creep = rigid_change[:, rows].T
        creep = (creep - self.rigid[rows, None] * speed) / self.speed if self.speed else creep
        shift = body.shift if a == n else body.shift[np.ix_(rows, index)]
        p0, q0 = self.found.pressure[index], self.found.tangential[index].T
        rho, s0 = self_compliance(np.diag(body.slip)[rows]), self.found.slip[index].T
        law = LinearisedFriction.at(rho, p0, q0, s0, laws=self.laws, speed=self.speed)
        # slip and pressure as functions of the tractions, cached by the last Newton step of
        # `wheelrail.contact.solvers.tangential`
        stored = body.cache.linearised_for(active, active)
        if body.coupling is None or stored is None or not body.normal.piecewise_linear:
            slip, slope = body.slip if a == n else body.slip[np.ix_(rows, rows)], None
            if body.coupling is not None:
                slope = la.lu_solve(factor, body.coupling[np.ix_(index, rows)], check_finite=False)
                slip = slip + shift @ slope
        else:
            _, slip, slope = stored
        jacobian, at = law.slip(slip), np.arange(a)
        for i in range(2):
            for j in range(2):
                jacobian[i * a + at, j * a + at] += law.own[i, j]
            if slope is not None:
                jacobian[i * a : (i + 1) * a] -= law.by_pressure[i][:, None] * slope
        right = law.by_speed.reshape(-1, 1) * speed + law.pressure(p) - law.slip(creep + shift @ p)
        q = solve(jacobian, right)
        return (p if slope is None else p + slope @ q), q


def co_moving_load(load: Array, origin: Array) -> Array:
    """Derivative (6, 6) of a force and its moment (6,) that move and rotate with the wheel's frame."""
    force, arm = skew(load[:3]), skew(origin)
    change = np.zeros((6, 6))
    change[:3, 3:] = change[3:, :3] = -force
    change[3:, 3:] = -arm @ force - skew(load[3:] - arm @ load[:3])
    return change


def solve(matrix: Array, right: Array) -> Array:
    """Solution of a linear system; the matrix is overwritten, as LAPACK factorises its transpose in place."""
    factor = la.lu_factor(matrix.T, overwrite_a=True, check_finite=False)
    return np.asarray(la.lu_solve(factor, right, trans=1, check_finite=False))


def self_compliance(diagonal: Array) -> Array:
    """Diagonal compliance (a,) 1/Pa: slip of points by their own traction, mean of both directions, from (2 a,)."""
    diagonal_mean = diagonal.reshape(2, -1).mean(axis=0)
    return np.asarray(np.maximum(diagonal_mean, 1e-3 * np.abs(diagonal_mean).max()))


class LinearisedForce(Protocol):
    """Linearised contact in the frame of the rail, the moment about its origin."""

    @property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment."""


@dataclass(frozen=True, eq=False)
class ContactTangent:
    """Derivative of a contact force, stored with a result.

    Parameters:
        of: the linearised problem.
        centre: (3,) m in the rail's frame, reference point of the moment.
        mirror: whether the result is the mirror image in y = 0.
    """

    of: LinearisedForce
    centre: Array = field(default_factory=lambda: np.zeros(3))
    mirror: bool = False

    def about(self, centre: Array) -> ContactTangent:
        """The derivative with the moment about another point (3,) m, relative to the present one."""
        return changed(self, centre=self.centre + (MIRROR * centre if self.mirror else centre))

    def mirrored(self) -> ContactTangent:
        """The derivative in the mirror y = 0."""
        return changed(self, mirror=not self.mirror)

    def __call__(self) -> Array:
        """Derivative (6, 12) of force and moment in the present frame.

        The columns are the changes of `wheelrail.contact.kinematics.sensitivity`.
        """
        change = self.of.matrix.copy()
        change[3:] -= cross(self.centre, change[:3].T).T
        return np.asarray(MIRRORED[:, None] * change * np.tile(MIRRORED, 2)) if self.mirror else change


def tangent_of(problem: TangentProblem) -> ContactTangent | None:
    """Tangent for a result; None for points without a `PointSensitivity`."""
    return None if problem.places.sensitivity is None else ContactTangent(problem)
