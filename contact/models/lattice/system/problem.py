"""Equations of the contact on a lattice at one pose: residual and Jacobian of all unknowns together.

Moments of the gap:  int (d + u_n) T_k / sqrt(1 - xi^2) = 0, d the undeformed penetration and u_n the relative normal
displacement by all tractions. Friction: F(q, s, p) = 0 of `CellFriction` in every cell, s the rigid slip plus the
elastic one over the rolling speed. Ends of strips are unknowns like the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import (
    BodyTables,
    ContactLines,
    EquationData,
    Evaluation,
    Motion,
    PairTables,
    Penetration,
    PoseMeans,
    ResidualCode,
    StripBasis,
    StripPlaces,
    SurfaceData,
    contact_lines,
    evaluate,
    frames,
    opening,
    penetration,
)
from wheelrail.contact.elasticity.waveguide.influence import BEYOND
from wheelrail.contact.geometry.interpenetration import TOO_DEEP, UNSOLVED, overlap_text
from wheelrail.contact.geometry.strip_surfaces import ProfileStrips
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.kinematics.creepage import NotRolling
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.lattice.influence.basis import Tangential
from wheelrail.contact.models.lattice.influence.pair_tables import LatticeTables
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.system.friction import CellFriction
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.models.lattice.system.surface import motion_data
from wheelrail.support.arrays import Array, Nodes

NO_FRICTION = ResidualCode(None, np.zeros(0), 0.0)
MARGIN = 3e-4  # m, largest gap that displacements may close, also between two strips: ordinary ones
INSIDE = 1e-3  # m, below the rail's surface along the vertical: of a wheel inside it, beyond errors of the samples
MISSED = 1e-4  # m, largest overlap that strips may miss: as means over their widths, they have a few um less
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
        apart: strips between those at which the penetration is estimated first.
    """

    surface: SurfaceData
    tables: LatticeTables
    basis: StripBasis
    law: CellFriction | None
    pose: Pose
    motion: RigidMotion
    margin: float = MARGIN
    apart: int = 1

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
        return contact_lines(self.surface, self._motion, self.tables.lattice, self.margin, self.apart)

    @cached_property
    def _motion(self) -> Motion:
        """Pose and velocities for compiled code, at a speed of 1 m/s."""
        return motion_data(self.pose, self.motion, 1.0)

    @property
    def depth(self) -> Array:
        """Largest penetration (K,) m of the strips, the mean over their widths."""
        return self.lines.depth

    @property
    def overlap(self) -> str:
        """Text on an overlap although no strip penetrates; empty without."""
        surfaces, data = self.tables.operators.surfaces, self._motion
        if not isinstance(surfaces, ProfileStrips):
            return ""
        place, depth, _ = self._nearest
        if depth > MISSED:
            return overlap_text(depth, surfaces.wheel.point(place), UNSOLVED)
        rail = surfaces.rail.point(np.linspace(*surfaces.rail.s_range, SAMPLES))
        rail = rail[np.argsort(rail[:, 0])]
        wheel = frames(self.surface, data.origin, data.rotation, self.middle, self.lines.x).point
        over = (wheel[:, 1] > rail[0, 0]) & (wheel[:, 1] < rail[-1, 0])
        inside = (wheel[over, 2] < np.interp(wheel[over, 1], rail[:, 0], rail[:, 1]) - INSIDE).any()
        return TOO_DEEP if inside else ""

    @property
    def crest(self) -> tuple[Array, Array]:
        """Place (K,) m along x of the largest penetration, and curvature (K,) 1/m there."""
        return self.lines.x, self.lines.curvature

    @property
    def approach(self) -> float:
        """Largest penetration m of a strip; without any, minus the gap of the undeformed surfaces."""
        return self.lines.approach if self.lines.approach > 0.0 else min(self._nearest[1], 0.0)

    @cached_property
    def _nearest(self) -> tuple[float, float, float]:
        return self.tables.operators.surfaces.nearest(self.pose)

    @cached_property
    def candidates(self) -> Nodes:
        """Strips with positive penetration."""
        return np.flatnonzero(self.depth > 0)

    def check_inside(self) -> None:
        """Raise OutsideSurface where the penetration reaches an end of a profile, or of the upper body's lines."""
        depth, k, last = self.depth, self.candidates, len(self.depth) - 1
        before, after = depth[np.maximum(k - 1, 0)], depth[np.minimum(k + 1, last)]
        ended = (k == 0) | (k == last)
        ended |= (before == -np.inf) & (2.0 * depth[k] > after)
        ended |= (after == -np.inf) & (2.0 * depth[k] > before)
        beyond = ended | ~self.tables.lattice.carried[k]
        if beyond.any():
            i = int(np.where(beyond, depth[k], -np.inf).argmax())
            raise OutsideSurface(self._overlap(k[i], "where a profile ends" if ended[i] else UNSOLVED))

    def _overlap(self, strip: int, reason: str) -> str:
        """Text on a strip that penetrates where it is not solved."""
        surfaces = self.tables.operators.surfaces
        if not isinstance(surfaces, ProfileStrips):
            return BEYOND
        return overlap_text(self.depth[strip], surfaces.wheel.point(self.middle[strip]), reason)

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
        return self._motion._replace(speed=self.speed)

    def penetration(self, s: Array, x: Array) -> Penetration:
        """Undeformed penetration at points (n,)."""
        data = self.data
        return penetration(self.surface, data.origin, data.rotation, np.ascontiguousarray(s), np.ascontiguousarray(x))

    @property
    def reach(self) -> float:
        """Longest distance m along x in the contact."""
        low, high = self.lines.window
        return high - low

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

    def tensile(self, state: LatticeState) -> bool:
        """Whether the mean pressure over a cell is negative, as with few cells along a strip it may be at an end."""
        return bool((state.modes @ self.basis.mean.T).min() < 0.0)

    @cached_property
    def _means(self) -> PoseMeans:
        return self.tables.at(self.lines.near, self.lines.foot, self.reach)

    def pairs(self, strips: Nodes) -> PairTables:
        """Tables of the pairs of some strips (S,). Raises OutsideSurface."""
        return self.tables.of(strips, self._means)

    def add_pairs(self, strips: Nodes) -> None:
        """Complete the tables by those of the pairs of some strips (S,)."""
        self.tables.complete(strips)

    def bodies(self, strips: Nodes) -> BodyTables:
        """Tables of each body of some loaded strips (S,)."""
        return self.tables.body_tables(strips, self._means, self.reach)

    def check_loaded(self, strips: Nodes) -> None:
        """Raise OutsideSurface where loaded strips (S,) lie beyond the lower body's lines, as unloaded ones may."""
        outside = strips[~self.lines.covered[strips]]
        if self.tables.moves and len(outside):
            raise OutsideSurface(self._overlap(outside[self.depth[outside].argmax()], UNSOLVED))

    def of(self, strips: Nodes) -> EquationData:
        """Data of the equations of some strips (S,), stored, with the tables of all pairs that have been added. Raises
        OutsideSurface.
        """
        key = strips.tobytes()
        stored = self._stored.get(key)
        if stored is None:
            law = NO_FRICTION if self.law is None else self.law.code
            data = self.surface, self.data, self.places(strips), self.basis, law, self.rho
            stored = self._stored[key] = EquationData(self.pairs(strips), *data)
        elif not self.tables.holds(stored.tables):
            stored = self._stored[key] = stored._replace(tables=self.pairs(strips))
        return stored

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

    @cached_property
    def cell_middles(self) -> Array:
        """Middles (M,) of the cells, from 0 to 1."""
        return np.asarray(0.5 * (self.basis.marks[1:] + self.basis.marks[:-1]))
