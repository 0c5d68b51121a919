"""Two bodies in contact: their surfaces and their compliance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wheelrail.bindings._contact import FiniteBody, HalfSpaces, LatticeStrips, LatticeTables
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence, HalfSpaceInfluence
from wheelrail.contact.geometry.strip_lattice import slenderness
from wheelrail.contact.geometry.strip_surfaces import QuadricStrips, StripSurfaces
from wheelrail.contact.models.lattice.influence.body_correction import OUTWARD, BodyCorrection
from wheelrail.contact.models.lattice.influence.pair_grid import RULE
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class StripOperators:
    """Two bodies invariant along x or in angle, and their surfaces in contact.

    The lower body is aligned with the rolling direction: a yaw of 30 mrad rotates it by as much, which has no effect on
    a half-space.
    """

    surfaces: StripSurfaces
    upper: HalfSpaceInfluence
    lower: HalfSpaceInfluence

    @cached_property
    def corrections(self) -> tuple[BodyCorrection | None, BodyCorrection | None]:
        """Deviations of both bodies from half-spaces; None of a half-space."""
        upper, lower = (
            BodyCorrection(body, outward) if isinstance(body, ElementInfluence) else None
            for body, outward in zip((self.upper, self.lower), OUTWARD, strict=True)
        )
        return upper, lower

    @cached_property
    def bodies(self) -> tuple[FiniteBody | None, FiniteBody | None]:
        """The same for the core."""
        upper, lower = self.corrections
        return None if upper is None else upper.finite_body(False), None if lower is None else lower.finite_body(
            self.moves
        )

    def under(self, surfaces: StripSurfaces) -> StripOperators:
        """The same bodies, with known tables, under other surfaces of the same kind."""
        other = replace(self, surfaces=surfaces)
        other.__dict__.update(corrections=self.corrections, bodies=self.bodies)
        return other

    @property
    def moves(self) -> bool:
        """Whether strips move on the lower body."""
        return not isinstance(self.surfaces, QuadricStrips)

    def strips(self, sides: Array, rolls: bool = True) -> tuple[LatticeStrips, Array, HalfSpaces]:
        """Strips of the upper body, their slenderness (K,), and the half-spaces under both bodies.

        Parameters:
            sides: (K + 1,) m, lateral bounds of the strips on the upper body.
            rolls: whether displacements along x count by their slip, which contains u_r / R.
        """
        middle, bodies = 0.5 * (sides[1:] + sides[:-1]), (self.upper, self.lower)
        tangent = self.upper._tangents(middle)
        strips = LatticeStrips(sides, np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0])), self.surfaces.along(middle))
        radius = self.upper.radius if rolls and self.bodies[0] is not None else None
        spaces = HalfSpaces(
            np.array([body.nu for body in bodies]),
            np.array([body.scale * body.unit for body in bodies]),
            np.array(OUTWARD),
            radius or 0.0,
        )
        return strips, np.ascontiguousarray(slenderness(self.surfaces, middle)), spaces

    def tables(self, sides: Array, rolls: bool = True) -> LatticeTables:
        """Tables of pairs of strips; parameters of `strips`."""
        return LatticeTables(*self.strips(sides, rolls), RULE, *self.bodies, self.moves)
