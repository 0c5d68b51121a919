"""Equations of the contact on a lattice at one pose: residual and Jacobian of all unknowns together.

Moments of the gap:  int (d + u_n) T_k / sqrt(1 - xi^2) = 0, d the undeformed penetration and u_n the relative normal
displacement by all tractions. Friction: F(q, s, p) = 0 of `wheelrail.contact.models.lattice.friction` in every cell, s
the rigid slip plus the elastic one over the rolling speed. Ends of strips are unknowns like the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.creepage import NotRolling
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.lattice.equations import (
    GAUSS,
    EquationData,
    Evaluation,
    StripPlaces,
    evaluate,
    friction_rows,
    linearise,
)
from wheelrail.contact.models.lattice.friction import CellFriction
from wheelrail.contact.models.lattice.influence.basis import StripBasis
from wheelrail.contact.models.lattice.influence.pair_tables import LatticeTables, PairTables
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.state import LatticeState
from wheelrail.contact.models.lattice.surface import (
    Motion,
    Penetration,
    SurfaceData,
    crests,
    frames,
    motion_data,
    penetration,
    rigid_shift,
    surface_data,
)
from wheelrail.support.arrays import Array, Nodes

OUTSIDE = "the wheel penetrates the rail beyond the part of its surface that carries contact points"
BETWEEN = 4  # strips between those at which the penetration is estimated first
MARGIN = 3e-4  # m, by which it may be larger in between


@dataclass(frozen=True)
class LatticeProblem:
    """Equations at a pose.

    Parameters:
        tables: compliance of pairs of strips, of a lattice.
        basis: cells and modes of a strip.
        law: of friction; None without.
        pose, motion: of the bodies.
    """

    tables: LatticeTables
    basis: StripBasis
    law: CellFriction | None
    pose: Pose
    motion: RigidMotion

    @property
    def rolls(self) -> bool:
        """Whether there are tractions."""
        return self.law is not None

    @property
    def cells(self) -> int:
        return len(self.basis.marks) - 1

    @property
    def middle(self) -> Array:
        """Arc length (K,) m of the middles of all strips."""
        return self.tables.middle

    @property
    def width(self) -> Array:
        """Width (K,) m of all strips."""
        return self.tables.width

    @cached_property
    def surface(self) -> SurfaceData:
        """Surfaces of both bodies."""
        return surface_data(self.tables.operators.surfaces)

    @cached_property
    def _profile(self) -> tuple[Array, Array, Array]:
        """Of all strips (K,): largest penetration m, the mean over their widths, its place m along x and its curvature
        1/m there; -inf where the bodies are far apart.
        """
        K = len(self.middle)
        some = np.unique(np.append(np.arange(0, K, BETWEEN), K - 1))
        near = np.flatnonzero(crests(self.surface, *self._frame, self.middle[some])[0] > -MARGIN)
        depth, x, bend = np.full(K, -np.inf), np.zeros(K), np.ones(K)
        own = np.zeros(K, dtype=bool)
        for k in near:
            own[max(some[k] - BETWEEN, 0) : some[k] + BETWEEN + 1] = True
        s = self.middle[own, None] + self.width[own, None] * [-GAUSS, GAUSS]
        lines = crests(self.surface, *self._frame, s.ravel())
        depth[own], x[own], bend[own] = (values.reshape(-1, 2).mean(axis=1) for values in lines)
        return depth, x, bend

    @property
    def depth(self) -> Array:
        """Largest penetration (K,) m of the strips, the mean over their widths."""
        return self._profile[0]

    @property
    def crest(self) -> tuple[Array, Array]:
        """Place (K,) m along x of the largest penetration, and curvature (K,) 1/m there."""
        return self._profile[1:]

    @cached_property
    def approach(self) -> float:
        """Largest penetration m of a strip."""
        return float(self.depth.max())

    @cached_property
    def candidates(self) -> Nodes:
        """Strips with positive penetration. Raises OutsideSurface where they reach the end of the lattice."""
        inside = np.flatnonzero(self.depth > 0)
        if len(inside) and (inside[0] == 0 or inside[-1] == len(self.depth) - 1):
            raise OutsideSurface(OUTSIDE)
        return inside

    @cached_property
    def speed(self) -> float:
        """Rolling speed m/s: mean over all strips, weighted by the squared penetration. Raises NotRolling."""
        if not self.rolls:
            return 0.0
        own = self.candidates
        weight = self.depth[own] ** 2 * self.width[own]
        places = frames(self.surface, *self._frame, self.middle[own], self.crest[0][own])
        motion = motion_data(self.pose, self.motion, 1.0)
        flow = rigid_shift(places, np.ascontiguousarray(places.axes[:, 0]), motion)[2]
        speed = -float(weight @ flow / weight.sum())
        if not speed > 0:
            raise NotRolling(
                f"friction needs a wheel that rolls forward, but the material flows at {speed:g} m/s; mu = 0 needs none"
            )
        return speed

    @cached_property
    def data(self) -> Motion:
        """Pose and velocities for compiled code."""
        return motion_data(self.pose, self.motion, self.speed)

    @property
    def _frame(self) -> tuple[Array, Array]:
        return np.asarray(self.pose.origin, dtype=float), np.ascontiguousarray(self.pose.rotation)

    def penetration(self, s: Array, x: Array) -> Penetration:
        """Undeformed penetration at points (n,)."""
        return penetration(self.surface, *self._frame, np.ascontiguousarray(s), np.ascontiguousarray(x))

    @cached_property
    def at_crests(self) -> Penetration:
        """Penetration (K,) at the strips' middles, where that of their profile is largest."""
        return self.penetration(self.middle, self.crest[0])

    @cached_property
    def reach(self) -> float:
        """Longest distance m along x in the contact: twice the region of penetration."""
        x, bend = (values[self.candidates] for values in self.crest)
        half = np.sqrt(2 * self.depth[self.candidates] / bend)
        return float(2 * ((x + half).max() - (x - half).min()))

    def places(self, strips: Nodes) -> StripPlaces:
        """Places of some strips (S,)."""
        level = frames(self.surface, *self._frame, self.middle[strips], self.crest[0][strips]).axes[:, 0]
        width, stretch = self.width[strips], self.tables.stretch[strips]
        return StripPlaces(self.middle[strips], width, stretch, np.ascontiguousarray(level))

    def pairs(self, strips: Nodes) -> PairTables:
        """Tables of the pairs i <= j of some strips (S,). Raises OutsideSurface."""
        feet = self.at_crests.foot if self.tables.moves else None
        return self.tables.of(*triangle(strips), feet, self.reach)

    def of(self, strips: Nodes) -> EquationData:
        """Data of the equations of some strips (S,), stored. Raises OutsideSurface."""
        key = strips.tobytes()
        if key not in self._stored:
            places, tables = self.places(strips), self.pairs(strips)
            self._stored[key] = EquationData(tables, self.surface, self.data, places, self.basis)
        return self._stored[key]

    @cached_property
    def _stored(self) -> dict[bytes, EquationData]:
        return {}

    def evaluate(self, state: LatticeState, rho: Array) -> Evaluation:
        """Residual of a state; rho (S, M) 1/Pa. Raises OutsideSurface."""
        evaluation = evaluate(state.values, self.of(state.strips))
        if not evaluation.inside:
            raise OutsideSurface(TOO_LONG)
        self._add_friction(state, evaluation, rho)
        return evaluation

    def linearise(self, state: LatticeState) -> tuple[Evaluation, Array, Array]:
        """Evaluation, Jacobian (n, n) and rho (S, M) 1/Pa of a state. Raises OutsideSurface."""
        evaluation, jacobian, rho = linearise(state.values, self.of(state.strips))
        if not evaluation.inside:
            raise OutsideSurface(TOO_LONG)
        self._add_friction(state, evaluation, rho)
        if self.law is not None:
            friction_rows(jacobian, self.friction_slopes(state, evaluation, rho), self.basis.mean)
        return evaluation, jacobian, rho

    def _add_friction(self, state: LatticeState, evaluation: Evaluation, rho: Array) -> None:
        """Complete the residual of an evaluation in place."""
        if self.law is not None:
            F = self.law.residual(state.tractions, evaluation.slip, evaluation.pressure, rho, self.speed)
            evaluation.residual[:, : 2 * self.cells] = F.reshape(len(F), -1)

    def friction_slopes(self, state: LatticeState, evaluation: Evaluation, rho: Array) -> Array:
        """Slopes (S, M, 12) of the friction residual, see `CellFriction.slopes`."""
        assert self.law is not None
        return self.law.slopes(state.tractions, evaluation.slip, evaluation.pressure, rho, self.speed)

    @cached_property
    def cell_middles(self) -> Array:
        """Middles (M,) of the cells, from 0 to 1."""
        return np.asarray(0.5 * (self.basis.marks[1:] + self.basis.marks[:-1]))


def triangle(strips: Nodes) -> tuple[Nodes, Nodes]:
    """Strips of all pairs i <= j, row by row."""
    i, j = np.triu_indices(len(strips))
    return strips[i], strips[j]
