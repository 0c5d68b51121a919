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
from wheelrail.contact.models.fitted.operators import TOO_LONG
from wheelrail.contact.models.fitted.surfaces import PenetrationProfile
from wheelrail.contact.models.lattice.basis import MODES, MOMENTS, StripBasis
from wheelrail.contact.models.lattice.compliance import StripGrid, antiderivatives, operator, slips_and_moments
from wheelrail.contact.models.lattice.friction import FrictionLaw, residual, slopes
from wheelrail.contact.models.lattice.pair_tables import LatticeTables, PairTables
from wheelrail.contact.models.lattice.penetration import (
    Penetration,
    forward_flow,
    frames,
    penetration,
    rigid_shift,
)
from wheelrail.contact.models.lattice.state import LatticeState
from wheelrail.support.arrays import Array, Mask, Nodes
from wheelrail.support.compiled import compiled

GAUSS = 0.5 / np.sqrt(3.0)  # of a strip's width, from its middle
OUTSIDE = "the wheel penetrates the rail beyond the part of its surface that carries contact points"


@compiled
def friction_residual(
    law: FrictionLaw, q: Array, s: Array, p: Array, rho: Array, speed: float
) -> Array:
    """F (S, 2, M) Pa of tractions q and slips s (S, 2, M), pressures p and rho (S, M)."""
    F = np.empty_like(q)
    for i in range(q.shape[0]):
        for r in range(q.shape[2]):
            F[i, 0, r], F[i, 1, r] = residual(
                law, (q[i, 0, r], q[i, 1, r]), (s[i, 0, r], s[i, 1, r]), p[i, r], rho[i, r], speed
            )
    return F


@compiled
def friction_slopes(
    law: FrictionLaw, q: Array, s: Array, p: Array, rho: Array, speed: float
) -> tuple[Array, Mask]:
    """Derivatives (S, M, 12) of F by q (4), s (4), p (2) and speed (2), and sliding cells (S, M)."""
    D, slides = np.empty((*p.shape, 12)), np.empty(p.shape, dtype=np.bool_)
    for i in range(q.shape[0]):
        for r in range(q.shape[2]):
            t = slopes(law, (q[i, 0, r], q[i, 1, r]), (s[i, 0, r], s[i, 1, r]), p[i, r], rho[i, r], speed)
            d = D[i, r]
            d[0], d[1], d[2], d[3] = t.by_q
            d[4], d[5], d[6], d[7] = t.by_s
            d[8], d[9] = t.by_p
            d[10], d[11] = t.by_speed
            slides[i, r] = t.slides
    return D, slides


@compiled
def into_friction(A: Array, D: Array, mean: Array) -> None:
    """Replace the slip rows of an operator A (S block, S block) by those of the friction residual, in place."""
    S, M = D.shape[0], D.shape[1]
    block = A.shape[0] // S
    for i in range(S):
        for r in range(M):
            x, y = i * block + r, i * block + M + r
            d = D[i, r]
            for c in range(A.shape[1]):
                along, across = A[x, c], A[y, c]
                A[x, c] = d[4] * along + d[5] * across
                A[y, c] = d[6] * along + d[7] * across
            A[x, x] += d[0]
            A[x, y] += d[1]
            A[y, x] += d[2]
            A[y, y] += d[3]
            for m in range(mean.shape[1]):
                A[x, i * block + 2 * M + m] += d[8] * mean[r, m]
                A[y, i * block + 2 * M + m] += d[9] * mean[r, m]


@dataclass(frozen=True)
class Evaluation:
    """Residual of a state and what belongs to it.

    Parameters:
        residual: (S, block): friction Pa along and across, moments of the gap m.
        grid: cells.
        V: (S, M + 3, 3), see `wheelrail.contact.models.lattice.compliance`.
        pressure: (S, M) Pa, means over the cells.
        slip: (S, 2, M) over the speed; rigid_slope: (S, 2, M) 1/m, change of the rigid part along x.
        depth: penetration at the stations.
    """

    residual: Array
    grid: StripGrid
    V: Array
    pressure: Array
    slip: Array
    rigid_slope: Array
    depth: Penetration


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
    law: FrictionLaw | None
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
    def at_crests(self) -> Penetration:
        """Penetration (K,) at the strips' middles, where that of their profile is largest."""
        return penetration(self.tables.operators.surfaces, self.pose, self.middle, self.crest[0])

    @cached_property
    def reach(self) -> float:
        """Longest distance m along x in the contact: twice the region of penetration."""
        x, bend = (values[self.candidates] for values in self.crest)
        half = np.sqrt(2 * self.depth[self.candidates] / bend)
        return float(2 * ((x + half).max() - (x - half).min()))

    def pairs(self, strips: Nodes) -> PairTables:
        """Tables of the pairs i <= j of some strips (S,). Raises OutsideSurface."""
        key = strips.tobytes()
        if key not in self._stored:
            feet = self.at_crests.foot if self.tables.moves else None
            self._stored[key] = self.tables.of(*triangle(strips), feet, self.reach)
        return self._stored[key]

    @cached_property
    def _stored(self) -> dict[bytes, PairTables]:
        return {}

    @cached_property
    def lines(self) -> PenetrationProfile:
        """Penetration profile at both Gauss lines of every strip, (2 K,)."""
        s = self.middle[:, None] + self.width[:, None] * [-GAUSS, GAUSS]
        return self.tables.operators.surfaces.ridge(self.pose, s.ravel())

    @cached_property
    def depth(self) -> Array:
        """Largest penetration (K,) m of the strips, the mean over their widths."""
        return np.asarray(self.lines.overlap.reshape(-1, 2).mean(axis=1))

    @cached_property
    def crest(self) -> tuple[Array, Array]:
        """Place (K,) m along x of the largest penetration, and curvature (K,) 1/m there."""
        x, bend = self.lines.x.reshape(-1, 2).mean(axis=1), self.lines.bend.reshape(-1, 2).mean(axis=1)
        return x, bend

    @cached_property
    def approach(self) -> float:
        """Largest penetration m."""
        return float(self.lines.overlap.max())

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
        weight = np.maximum(self.depth, 0.0) ** 2 * self.width
        own = self.candidates
        places = frames(self.tables.operators.surfaces, self.pose, self.middle[own], self.crest[0][own])
        flow = forward_flow(places, self.motion)
        speed = -float(weight[own] @ flow / weight[own].sum())
        if not speed > 0:
            raise NotRolling(
                f"friction needs a wheel that rolls forward, but the material flows at {speed:g} m/s; mu = 0 needs none"
            )
        return speed

    def grid(self, state: LatticeState) -> StripGrid:
        """Cells of a state."""
        stretch = self.tables.operators.surfaces.along(self.middle[state.strips])
        length = np.diff(state.ends)
        x = stretch[:, None] * (state.ends[:, :1] + length * self.basis.row_marks)
        return StripGrid(x, stretch * length[:, 0], self.width[state.strips], stretch)

    def stations(self, state: LatticeState) -> Penetration:
        """Penetration at the stations of both Gauss lines of every strip, (S 2 STATIONS,)."""
        x = state.ends[:, :1] + np.diff(state.ends) * self.basis.stations
        s = self.middle[state.strips, None] + self.width[state.strips, None] * [-GAUSS, GAUSS]
        across, along = np.broadcast_arrays(s[:, :, None], x[:, None, :])
        surfaces = self.tables.operators.surfaces
        places = penetration(surfaces, self.pose, np.ravel(across), np.ravel(along))
        if not np.isfinite(places.depth).all():
            raise OutsideSurface(OUTSIDE)
        return places

    def line_mean(self, values: Array, state: LatticeState) -> Array:
        """Mean (S, STATIONS, ..) over both Gauss lines of values (S 2 STATIONS, ..) at the stations."""
        shape = (len(state.strips), 2, len(self.basis.stations), *values.shape[1:])
        return np.asarray(values.reshape(shape).mean(axis=1))

    def jumps(self, state: LatticeState) -> Array:
        """Jumps (S, M + 1, 3) N/m of tractions times width at the cell boundaries."""
        S, M = len(state.strips), self.cells
        force = np.zeros((S, M + 2, 3))
        if self.rolls:
            force[:, 1:-1, :2] = state.tractions.transpose(0, 2, 1)
        force[:, 1:-1, 2] = -state.modes @ self.basis.loads.T
        return np.asarray(np.diff(force, axis=1) * self.width[state.strips, None, None])

    def evaluate(self, state: LatticeState, rho: Array) -> Evaluation:
        """Residual of a state; rho (S, M) 1/Pa. Raises OutsideSurface."""
        tables, grid, jumps = self.pairs(state.strips), self.grid(state), self.jumps(state)
        inside, V = antiderivatives(tables, grid, jumps)
        if not inside:
            raise OutsideSurface(TOO_LONG)
        return self._assembled(state, grid, V, rho)

    def _assembled(self, state: LatticeState, grid: StripGrid, V: Array, rho: Array) -> Evaluation:
        slip, moments = slips_and_moments(V, grid, self.basis)
        places = self.stations(state)
        moments += self.line_mean(places.depth, state) @ self.basis.penetration.T
        pressure = state.modes @ self.basis.mean.T
        if self.law is None:
            return Evaluation(moments, grid, V, pressure, slip, np.zeros_like(slip), places)
        rigid, slope = self.rigid(state)
        slip += rigid
        F = friction_residual(self.law, np.ascontiguousarray(state.tractions), slip, pressure, rho, self.speed)
        residuals = np.hstack([F.reshape(len(F), -1), moments])
        return Evaluation(residuals, grid, V, pressure, slip, slope, places)

    def rigid(self, state: LatticeState) -> tuple[Array, Array]:
        """Rigid slip (S, 2, M) over the speed at the cells, and its derivative 1/m along x."""
        S, M = len(state.strips), self.cells
        x = state.ends[:, :1] + np.diff(state.ends) * self.cell_middles
        s = np.repeat(self.middle[state.strips], M)
        places = frames(self.tables.operators.surfaces, self.pose, s, x.ravel())
        level = np.repeat(self.level_axes(state.strips), M, axis=0)
        shift, slope = rigid_shift(places, level, self.motion)
        rigid, change = ((v / self.speed).reshape(S, M, 2).transpose(0, 2, 1) for v in (shift, slope))
        return np.ascontiguousarray(rigid), change

    def level_axes(self, strips: Nodes) -> Array:
        """Longitudinal axes (S, 3) of strips where their penetration is largest."""
        surfaces = self.tables.operators.surfaces
        return frames(surfaces, self.pose, self.middle[strips], self.crest[0][strips]).axes[:, 0]

    @cached_property
    def cell_middles(self) -> Array:
        """Middles (M,) of the cells, from 0 to 1."""
        return np.asarray(0.5 * (self.basis.marks[1:] + self.basis.marks[:-1]))

    def linearise(self, state: LatticeState, rho: Array | None = None) -> tuple[Evaluation, Array, Array]:
        """Evaluation, Jacobian (n, n) and rho (S, M) 1/Pa of a state; rho None is chosen. Raises OutsideSurface."""
        tables, grid, jumps = self.pairs(state.strips), self.grid(state), self.jumps(state)
        inside, A, V = operator(tables, grid, jumps, self.basis, self.rolls)
        if not inside:
            raise OutsideSurface(TOO_LONG)
        S, M = len(state.strips), self.cells
        block = A.shape[0] // S
        if rho is None:
            rho = self_compliance(A, S, M) if self.rolls else np.zeros((S, M))
        evaluation = self._assembled(state, grid, V, rho)
        slope = self.line_mean(evaluation.depth.slope, state)
        for end, share in ((-2, 1 - self.basis.stations), (-1, self.basis.stations)):
            change = (slope * share) @ self.basis.penetration.T
            middle = 1 - self.cell_middles if end == -2 else self.cell_middles
            for i in range(S):
                A[(i + 1) * block - MOMENTS : (i + 1) * block, (i + 1) * block + end] += change[i]
                if self.rolls:
                    rigid = evaluation.rigid_slope[i] * middle
                    A[i * block : i * block + 2 * M, (i + 1) * block + end] += rigid.ravel()
        if self.law is not None:
            into_friction(A, self.friction_slopes(state, evaluation, rho)[0], self.basis.mean)
        return evaluation, A, rho

    def friction_slopes(self, state: LatticeState, evaluation: Evaluation, rho: Array) -> tuple[Array, Mask]:
        """Derivatives (S, M, 12) of the friction residual and sliding cells (S, M)."""
        assert self.law is not None
        q = np.ascontiguousarray(state.tractions)
        return friction_slopes(self.law, q, evaluation.slip, evaluation.pressure, rho, self.speed)


def triangle(strips: Nodes) -> tuple[Nodes, Nodes]:
    """Strips of all pairs i <= j, row by row."""
    i, j = np.triu_indices(len(strips))
    return strips[i], strips[j]


def self_compliance(A: Array, strips: int, cells: int) -> Array:
    """Slip (S, M) 1/Pa of cells by their own traction, the mean of both directions, from the operator."""
    block = A.shape[0] // strips
    diagonal = np.diag(A).reshape(strips, block)[:, : 2 * cells].reshape(strips, 2, cells).mean(axis=1)
    return np.asarray(np.maximum(diagonal, 1e-3 * np.abs(diagonal).max()))


__all__ = ["MODES", "Evaluation", "LatticeProblem", "friction_residual", "self_compliance"]
