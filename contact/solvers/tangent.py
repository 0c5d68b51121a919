"""Change of the contact force with pose and velocity, from the tractions found and the sets that they left.

With the points frozen, and the same ones active, sticking and sliding, the laws are linear in small changes:
N p' = d0' + D q' on the active points, s' = c' + S q' + T p', and F' = 0 of `wheelrail.contact.solvers.tangential`.
What is held: the points, material places of the wheel in a frame that does not spin, with their areas, and the
compliance between them. Fitted cells are held likewise: where they end pressure vanishes, and to first order nothing is
lost or gained there. But material that rolls in where they begin starts its traction there, which rises like the
pressure: as that end moves, which the pressure's change tells, q / p stays next to it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.linalg as la

from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import MIRROR, RigidMotion
from wheelrail.contact.kinematics.sensitivity import SHIFT, TURN, carried, rigid_slip, skew
from wheelrail.contact.laws.coulomb import LinearisedFriction
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.solvers.options import IterationCount
from wheelrail.contact.solvers.tractions import ContactCompliance, Tractions
from wheelrail.support.arrays import Array, Mask, Nodes

CHANGES = 12
ENTRY = 2  # first cells on the way in, whose slip looks ahead of the contact
MIRRORED = np.concatenate([MIRROR, -MIRROR])  # of a vector and an axial one


@dataclass(frozen=True, eq=False)
class TangentProblem:
    """Laws and compliance around the tractions found, in the frame of the rail.

    operator, rigid and speed as given to `wheelrail.contact.solvers.tractions.solve_tractions`; speed 0: a shift, whose
    motion are displacements, so that changes count by m and rad. origin (3,) m of the wheel's frame; strip: cells of
    each of the fitted strips, from the trailing end (0: points of a grid, which begin with no pressure); scale, by
    which displacements, a shift's among them, are larger than the operator's while slip is the same. Cost for a active
    points with friction: 18 a^3 where it changes the pressure, 5 a^3 where not or an `ContactCompliance` remembers; 2
    a^3 / 3 without.
    """

    places: SurfacePoints
    origin: Array
    motion: RigidMotion
    operator: Array | ContactCompliance
    rigid: Array | None
    speed: float
    laws: ContactLaws
    found: Tractions
    strip: int = 0
    scale: float = 1.0

    @cached_property
    def matrix(self) -> Array:
        """Change (6, 12) of force and moment about the rail's origin; `wheelrail.contact.kinematics.sensitivity` names
        the changes.
        """
        index = np.flatnonzero(self.found.pressure > 0)
        a, axes = len(index), self.places.axes[index]
        # forces and moments (a, 3, 6) of unit tractions are their virtual work
        units = (axes @ carried(self.places.point[index]).transpose(1, 2, 0)) * self.places.area[index, None, None]
        p, q = self._tractions(index)
        change: Array = -units[:, 2].T @ p
        if q is not None:
            change += units[:, 0].T @ q[:a] + units[:, 1].T @ q[a:]
        if self.places.follows is not None and self.places.follows.rides:
            local = np.column_stack([self.found.tangential[index], -self.found.pressure[index]])
            change[:, :6] += following(np.einsum("nk,nkj->j", local, units), self.origin)
        return change

    def _tractions(self, index: Nodes) -> tuple[Array, Array | None]:
        """Change of pressures (a, 12) and of tangential tractions (2 a, 12) at the active points."""
        places, n, a = self.places, len(self.places.area), len(index)
        assert places.follows is not None
        operator = self.operator
        body = operator if isinstance(operator, ContactCompliance) else ContactCompliance(operator, n, self.laws)
        active = self.found.pressure > 0
        factor = body.normal.of(active, IterationCount())
        overlap = places.follows.overlap(places, self.origin)
        deeper = np.zeros((a, CHANGES))
        deeper[:, :6] = overlap[:, index].T / self.scale
        p = la.lu_solve(factor, deeper, check_finite=False)
        if self.rigid is None:
            return p, None
        both = np.concatenate([index, n + index])
        moved, speed = rigid_slip(places, self.origin, self.motion, overlap)
        creep = moved[:, both].T
        creep = (creep - self.rigid[both, None] * speed) / self.speed if self.speed else creep / self.scale
        shift = body.shift if a == n else body.shift[np.ix_(both, index)]
        p0, q0 = self.found.pressure[index], self.found.tangential[index].T
        rho, s0 = own_compliance(np.diag(body.slip)[both]), self.found.slip[index].T
        law = LinearisedFriction.at(rho, p0, q0, s0, laws=self.laws, speed=self.speed)
        # a Newton step of `wheelrail.contact.solvers.tangential` from here left slip and pressure as functions of the
        # tractions
        stored = body.cache.linearised_for(active, active)
        if body.coupling is None or stored is None:
            slip, slope = body.slip if a == n else body.slip[np.ix_(both, both)], None
            if body.coupling is not None:
                slope = la.lu_solve(factor, body.coupling[np.ix_(index, both)], check_finite=False)
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
        first = self._entering(index) & ~law.slides
        begins = np.flatnonzero(np.tile(first, 2))
        units = np.zeros((2 * a, len(begins)))
        units[begins, np.arange(len(begins))] = 1.0
        found = solve(jacobian, np.hstack([right, units]))
        q, begun = found[:, :CHANGES], found[:, CHANGES:]
        if first.any():
            rise = (p if slope is None else p + slope @ q)[first]
            kept = (q0 / p0 - law.by_pressure)[:, first, None] * rise
            q = q + begun @ np.linalg.solve(begun[begins], kept.reshape(-1, CHANGES))
        return (p if slope is None else p + slope @ q), q

    def _entering(self, index: Nodes) -> Mask:
        """Which active points lie where material rolls into a fitted strip."""
        rolls = self.strip and self.speed
        return np.asarray(index % self.strip >= self.strip - ENTRY) if rolls else np.zeros(len(index), dtype=bool)


def following(load: Array, origin: Array) -> Array:
    """Change (6, 6) of a force and its moment (6,) that move and turn with the wheel's frame."""
    force = load[:3]
    turned = TURN @ force
    about = SHIFT @ skew(force) + turned @ skew(origin).T + TURN @ (load[3:] - skew(origin) @ force)
    return np.asarray(np.hstack([turned, about]).T)


def solve(matrix: Array, right: Array) -> Array:
    """Solution of a linear system whose matrix is lost: LAPACK factors its transpose in place, without a copy."""
    factor = la.lu_factor(matrix.T, overwrite_a=True, check_finite=False)
    return np.asarray(la.lu_solve(factor, right, trans=1, check_finite=False))


def own_compliance(diagonal: Array) -> Array:
    """Slip (a,) of points by their own traction, 1/Pa, the mean of both directions, from the diagonal (2 a,)."""
    own = diagonal.reshape(2, -1).mean(axis=0)
    return np.asarray(np.maximum(own, 1e-3 * np.abs(own).max()))


@dataclass(frozen=True, eq=False)
class ContactTangent:
    """A linearisation as a result carries it: about a centre (3,) m in the rail's frame, then in a mirror or not."""

    of: TangentProblem
    centre: Array = field(default_factory=lambda: np.zeros(3))
    mirror: bool = False

    def about(self, centre: Array) -> ContactTangent:
        """With the moment about another point (3,) m of the frame it is seen in, from the point it is about now."""
        return replace(self, centre=self.centre + (MIRROR * centre if self.mirror else centre))

    def mirrored(self) -> ContactTangent:
        return replace(self, mirror=not self.mirror)

    def __call__(self) -> Array:
        """Change (6, 12) of force and moment by the changes of `wheelrail.contact.kinematics.sensitivity`, all in the
        frame it is seen in.
        """
        change = self.of.matrix.copy()
        change[3:] -= skew(self.centre) @ change[:3]
        return np.asarray(MIRRORED[:, None] * change * np.tile(MIRRORED, 2)) if self.mirror else change


def tangent_of(around: TangentProblem) -> ContactTangent | None:
    """What a model hands to its result; None for points of which it is not known how they follow the wheel."""
    return None if around.places.follows is None else ContactTangent(around)
