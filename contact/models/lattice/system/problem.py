"""Equations of the contact on a lattice at one pose: residual and Jacobian of all unknowns together.

Moments of the gap:  int (d + u_n) T_k / sqrt(1 - xi^2) = 0, d the undeformed penetration and u_n the relative normal
displacement by all tractions. Friction: F(q, s, p) = 0 of `CellFriction` in every cell, s the rigid slip plus the
elastic one over the rolling speed. Ends of strips are unknowns like the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.kinematics.contact_points import OutsideSurface, SurfacePoints
from wheelrail.contact.kinematics.creepage import NotRolling
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.laws.residual_call import ResidualCode
from wheelrail.contact.models.lattice.influence.basis import StripBasis, Tangential
from wheelrail.contact.models.lattice.influence.pair_tables import LatticeTables, PairTables, PoseMeans
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.system.equations import (
    EquationData,
    Evaluation,
    Linearisation,
    StripPlaces,
    evaluate,
    linearised,
)
from wheelrail.contact.models.lattice.system.friction import CellFriction
from wheelrail.contact.models.lattice.system.partial_width import opening
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.models.lattice.system.surface import (
    MARGIN,
    ContactLines,
    Motion,
    Penetration,
    PenetrationChanges,
    SurfaceData,
    contact_lines,
    frames,
    motion_data,
    penetration,
    penetration_changes,
    smallest_gaps,
)
from wheelrail.support.arrays import Array, Mask, Nodes

NO_FRICTION = ResidualCode(0, 0, np.zeros(0), 0.0)
OUTSIDE = "the wheel penetrates the rail beyond the part of its surface that carries contact points"
TOO_DEEP = "the wheel lies inside the rail, too deep for a contact"
INSIDE = 1e-3  # m, below the rail's surface along the vertical: of a wheel inside it, beyond errors of the samples
SAMPLES = 400  # of the rail's profile


@dataclass(frozen=True)
class LatticeProblem:
    """Equations at a pose.

    Parameters:
        surface: of both bodies.
        tables: compliance of pairs of strips, of a lattice.
        basis: cells and modes of a strip.
        law: of friction; None without.
        pose, motion: of the bodies.
        margin: m, largest gap that displacements may close.
    """

    surface: SurfaceData
    tables: LatticeTables
    basis: StripBasis
    law: CellFriction | None
    pose: Pose
    motion: RigidMotion
    margin: float = MARGIN

    @property
    def rolls(self) -> bool:
        """Whether there are tractions."""
        return self.law is not None

    @property
    def shifts(self) -> bool:
        """Whether the motion is a tangential displacement, which counts at a speed of 1 m/s."""
        return self.rolls and self.basis.slip_power == 1

    @property
    def tangential(self) -> Tangential:
        """Kind of the tangential problem."""
        return "shift" if self.shifts else "rolling" if self.rolls else "none"

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
    def lines(self) -> ContactLines:
        """Where the strips touch."""
        return contact_lines(
            self.surface, motion_data(self.pose, self.motion, 1.0), self.middle, self.width, self.margin
        )

    @property
    def depth(self) -> Array:
        """Largest penetration (K,) m of the strips, the mean over their widths."""
        return self.lines.depth

    @property
    def too_deep(self) -> bool:
        """Whether the wheel lies inside the rail, so deep that no closest points are within reach."""
        surfaces, data = self.tables.operators.surfaces, motion_data(self.pose, self.motion, 1.0)
        if not isinstance(surfaces, ProfileStrips):
            return False
        rail = surfaces.rail.point(np.linspace(*surfaces.rail.s_range, SAMPLES))
        rail = rail[np.argsort(rail[:, 0])]
        wheel = frames(self.surface, data.origin, data.rotation, self.middle, self.lines.x).point
        over = (wheel[:, 1] > rail[0, 0]) & (wheel[:, 1] < rail[-1, 0])
        return bool((wheel[over, 2] < np.interp(wheel[over, 1], rail[:, 0], rail[:, 1]) - INSIDE).any())

    @property
    def crest(self) -> tuple[Array, Array]:
        """Place (K,) m along x of the largest penetration, and curvature (K,) 1/m there."""
        return self.lines.x, self.lines.curvature

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
    def near(self) -> Mask:
        """Strips (K,) that displacements may bring into contact: friction on a tread can close the gap of a flange."""
        return self.tables.covers(self.lines.foot) | (self.depth > 0)

    @cached_property
    def probed(self) -> Mask:
        """Strips (K,) to look at first: those that penetrate or lie where the gap is smallest, and the next ones on
        either side.
        """
        return smallest_gaps(self.depth, self.near)

    @cached_property
    def speed(self) -> float:
        """Rolling speed m/s: mean over all strips, weighted by the squared penetration. Raises NotRolling."""
        if not self.rolls:
            return 0.0
        if self.shifts:
            return 1.0
        speed = self.lines.speed
        if not speed > 0:
            raise NotRolling(
                f"friction needs a wheel that rolls forward, but the material flows at {speed:g} m/s; mu = 0 needs none"
            )
        return speed

    @cached_property
    def data(self) -> Motion:
        """Pose and velocities for compiled code."""
        return motion_data(self.pose, self.motion, self.speed)

    def penetration(self, s: Array, x: Array) -> Penetration:
        """Undeformed penetration at points (n,)."""
        data = self.data
        return penetration(self.surface, data.origin, data.rotation, np.ascontiguousarray(s), np.ascontiguousarray(x))

    def penetration_changes(self, s: Array, x: Array) -> PenetrationChanges:
        """Derivatives of `penetration` and of the closest points by the pose."""
        data = self.data
        return penetration_changes(self.surface, data.origin, data.rotation, s, x)

    @cached_property
    def window(self) -> tuple[float, float]:
        """Range m of x in which there may be contact: twice the region of penetration."""
        x, bend = (values[self.probed] for values in self.crest)
        half = np.sqrt(2 * np.maximum(self.depth[self.probed], 0.0) / bend)
        low, high = float((x - half).min()), float((x + half).max())
        return 1.5 * low - 0.5 * high, 1.5 * high - 0.5 * low

    @property
    def reach(self) -> float:
        """Longest distance m along x in the contact."""
        return self.window[1] - self.window[0]

    def places(self, strips: Nodes) -> StripPlaces:
        """Places of some strips (S,)."""
        width, stretch = self.width[strips], self.tables.stretch[strips]
        level, onset = self.lines.level[strips], self.lines.onset[strips]
        whole = self.lines.whole[strips] * self.tables.modulus / stretch
        return StripPlaces(self.middle[strips], width, stretch, level, strips, onset, whole)

    def openings(self, state: LatticeState) -> Array:
        """Mean gaps (S,) m left on the strips of a state, which may touch on a part of their width."""
        places = self.places(state.strips)
        gaps = [opening(*strip)[0] for strip in zip(state.load, places.onset, places.whole, strict=True)]
        return np.array(gaps)

    @cached_property
    def _means(self) -> PoseMeans:
        feet = self.tables.on_lines(self.lines.foot) if self.tables.moves else None
        return self.tables.at(np.flatnonzero(self.near), feet, self.reach)

    def pairs(self, strips: Nodes) -> PairTables:
        """Tables of the pairs of some strips (S,). Raises OutsideSurface."""
        return self.tables.of(strips, self._means)

    def check_loaded(self, strips: Nodes) -> None:
        """Raise OutsideSurface where loaded strips (S,) lie beyond the lower body's lines, as unloaded ones may."""
        if self.tables.moves:
            self.tables.check_on_lines(strips, self.lines.foot)

    def of(self, strips: Nodes) -> EquationData:
        """Data of the equations of some strips (S,), stored. Raises OutsideSurface."""
        key = strips.tobytes()
        if key not in self._stored:
            law = NO_FRICTION if self.law is None else self.law.code
            data = self.surface, self.data, self.places(strips), self.basis, law, self.rho
            self._stored[key] = EquationData(self.pairs(strips), *data)
        return self._stored[key]

    @cached_property
    def _stored(self) -> dict[bytes, EquationData]:
        return {}

    @cached_property
    def rho(self) -> Array:
        """Slips (M,) 1/Pa of cells by traction on them in plane strain, those of a displacement for the deepest strip.

        In a cell where the law of friction divides stick from slip, the traction varies with the slip by these.
        """
        size = 1.0
        if self.shifts:
            deepest = np.argmax(self.depth)
            size = float(np.sqrt(8 * self.depth[deepest] / self.crest[1][deepest]))
        return np.asarray(2 * size / (np.pi * self.tables.modulus) * self.basis.own_slip)

    def evaluate(self, state: LatticeState) -> Evaluation:
        """Residual of a state. Raises OutsideSurface."""
        evaluation = evaluate(state.values, self.of(state.strips))
        if not evaluation.inside:
            raise OutsideSurface(TOO_LONG)
        return evaluation

    def linearise(self, state: LatticeState) -> Linearisation:
        """Linearisation at a state. Raises OutsideSurface."""
        linearisation = linearised(state.values, self.of(state.strips))
        if not linearisation.evaluation.inside:
            raise OutsideSurface(TOO_LONG)
        return linearisation

    def layout(self, state: LatticeState) -> StripLayout:
        """Strips and cells of a state."""
        sides = self.tables.sides
        bounds = np.column_stack([sides[state.strips], sides[state.strips + 1]])
        return StripLayout(bounds, state.ends, np.zeros(len(bounds), dtype=int), self.basis.marks)

    def cell_places(self, state: LatticeState) -> SurfacePoints:
        """Middles of the cells of a state, strip by strip from the trailing end."""
        return self.tables.operators.surfaces.places(self.pose, self.layout(state))

    @cached_property
    def cell_middles(self) -> Array:
        """Middles (M,) of the cells, from 0 to 1."""
        return np.asarray(0.5 * (self.basis.marks[1:] + self.basis.marks[:-1]))
