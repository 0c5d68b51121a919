"""Compliance gathered on fitted cells, kept for copies of them that are moved and scaled as a whole.

A half-space knows no length: if all lengths grow by a factor, the displacement by the same tractions does, and slip,
its derivative, stays. Bodies of elements differ from half-spaces by what changes slowly over the surface, so that a
copy may only be a little LARGER or ASIDE.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from wheelrail.contact.geometry.strip_layout import StripLayout
from wheelrail.contact.geometry.strip_surfaces import PenetrationProfile
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.fitted.friction_penetration import FrictionPenetration
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.contact.solvers.active_set import CachedFactors
from wheelrail.contact.solvers.tractions import ContactCompliance
from wheelrail.support.arrays import Array

LARGEST_SCALING = 1e-2  # of all lengths
LARGEST_OFFSET = 0.5  # strips


class CellCompliance:
    """Compliance on the cells of a layout in a pose: along the normals, or of all components; computed on demand."""

    def __init__(
        self,
        operators: StripOperators,
        pose: Pose,
        layout: StripLayout,
        laws: ContactLaws,
        normal: CachedFactors | None = None,
    ) -> None:
        self.layout = layout
        self._operators, self._pose, self._laws, self._normal = operators, pose, laws, normal

    @cached_property
    def normal(self) -> CachedFactors:
        """Along the normals alone (n, n) m/Pa; that of the free-boundary iteration where it is passed in."""
        return self._normal or CachedFactors(self._operators.normal(self._pose, self.layout))

    @cached_property
    def displacement(self) -> Array:
        """Relative displacement (3 n, 3 n) m/Pa."""
        return self._all[0]

    @cached_property
    def operator(self) -> Array:
        """Slip and penetration (3 n, 3 n), rows as `wheelrail.contact.solvers.tractions.solve_tractions` takes them."""
        return np.vstack([self._all[1], self.displacement[-self.displacement.shape[0] // 3 :]])

    @cached_property
    def frictionless(self) -> ContactCompliance:
        """Compliance along the normals, with the solvers' cache."""
        body = ContactCompliance(self.normal.compliance, len(self.normal.compliance), self._laws)
        body.normal = self.normal  # with its factors: fitted cells have no penalty
        return body

    @cached_property
    def rolling(self) -> ContactCompliance:
        """The operator, with the solvers' cache."""
        return ContactCompliance(self.operator, len(self.operator) // 3, self._laws)

    @cached_property
    def shifting(self) -> ContactCompliance:
        """The same with displacement in place of slip: one step of tangential loading from none (Cattaneo, Mindlin)."""
        return ContactCompliance(self.displacement, len(self.displacement) // 3, self._laws)

    @cached_property
    def _all(self) -> tuple[Array, Array]:
        places = self._operators.surfaces.places(self._pose, self.layout)
        return self._operators.all(self._pose, self.layout, places)


@dataclass(frozen=True)
class FittedState:
    """State of a solve on fitted cells, the initial guess of the next one.

    Parameters:
        layout: cells.
        penetration: due to friction, to which the cells were fitted; None without.
        gathered: compliance, assembled on cells of which the present ones are a translated copy, scaled by scale.
        scale: of all lengths, over those of the compliance's cells.
        traction: tangential (2 n,) Pa.
        remainder: unconverged part of the penetration due to friction, over the approach; None if converged.
    """

    layout: StripLayout
    penetration: FrictionPenetration | None
    gathered: CellCompliance
    scale: float
    traction: Array
    remainder: FrictionPenetration | None = None

    def covers(self, ridge: PenetrationProfile) -> bool:
        """Whether all local maxima of the penetration lie on the cells, or next to them."""
        low, high = self.layout.sides.T
        at = ridge.s[ridge.maxima][:, None]
        return bool(((at > low - self.layout.width) & (at < high + self.layout.width)).any(axis=1).all())

    def copied(self, moves: Array, tips: Array) -> FittedState:
        """The cells translated and scaled as a whole, the closest approximation to given steps of the ends.

        moves (S, 2) over the strips' lengths and tips (parts, 2) over their widths, outwards.
        """
        old = self.layout
        new_part = np.diff(old.patch, prepend=old.patch[0] - 1) != 0
        first, part = np.flatnonzero(new_part), np.cumsum(new_part) - 1
        count, length = np.bincount(part), np.diff(old.ends)[:, 0]
        step = moves * length[:, None] * [-1.0, 1.0]
        longer = np.bincount(part, step[:, 1] - step[:, 0]) / np.bincount(part, length)
        growth = 0.5 * float(np.mean(longer + tips.sum(axis=1) / count))
        along = np.bincount(part, step.mean(axis=1)) / count
        across = 0.5 * (tips[:, 1] - tips[:, 0]) * old.width[first]

        def moved(places: Array, offset: Array) -> Array:
            middle = np.bincount(part, places.mean(axis=1)) / count
            return np.asarray((middle + offset)[part, None] + (1 + growth) * (places - middle[part, None]))

        new = replace(old, sides=moved(old.sides, across), ends=moved(old.ends, along))
        return replace(self, layout=new, scale=self.scale * (1 + growth))

    @property
    def far(self) -> bool:
        """Whether the cells differ too much from those on which the compliance was assembled."""
        original = self.gathered.layout
        away = np.abs(self.layout.middle - original.middle).max() / original.width.min()
        return bool(abs(self.scale - 1) > LARGEST_SCALING or away > LARGEST_OFFSET)
