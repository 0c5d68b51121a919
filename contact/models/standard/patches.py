"""Results of a contact on strips: fields by cell, and patches, computed on demand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities
from wheelrail.contact.models.standard.forces import StripTractions
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.results.patch_sums import PatchPoints, patch_sums
from wheelrail.contact.results.result import Fields, Patch
from wheelrail.support.arrays import Array, Nodes

if TYPE_CHECKING:
    from wheelrail.contact.geometry.rigid_surfaces import RigidPair


@dataclass(frozen=True)
class StripContacts:
    """Interpenetration regions, strips and cells of one solve; points (n, 3) m and axes (n, 3, 3) of the n strips."""

    zones: PenetrationRegions
    strips: StripPressures
    cells: StripTractions
    point: Array
    axes: Array
    pose: Pose
    motion: RigidMotion
    surfaces: RigidPair

    @property
    def count(self) -> int:
        """Number of cells along a strip."""
        return len(self.cells.area) // len(self.point)

    def fields(self) -> Fields:
        cells, n = self.cells, len(self.cells.area)
        return Fields(
            node=np.arange(n),
            patch=np.repeat(self.rank[self.strips.contact], self.count),
            point=cells.point,
            axes=np.repeat(self.axes, self.count, axis=0),
            area=cells.area,
            step=cells.length,
            penetration=np.full(n, np.nan),
            pressure=cells.pressure,
            traction=cells.traction,
            slip=cells.slip,
            displacement=np.zeros((n, 3)),
            sticks=cells.sticks,
        )

    @cached_property
    def rank(self) -> Nodes:
        """Index (k,) of each contact in the list by decreasing load."""
        rank = np.empty(len(self.zones.weight), dtype=np.int64)
        rank[np.argsort(-self.strips.load * self.zones.weight, kind="stable")] = np.arange(len(rank))
        return rank

    def patches(self) -> tuple[Patch, ...]:
        """All patches, by decreasing load."""
        cells, m = self.cells, self.count
        axes = np.repeat(self.axes, m, axis=0)
        on_wheel, on_rail = (np.repeat(place, m, axis=0) for place in self.surfaces.profiles(self.strips.s, self.point))
        level = np.ascontiguousarray(axes[:, 0])
        points = PatchPoints(
            cells.point,
            axes,
            level,
            cells.area,
            cells.length,
            on_wheel,
            on_rail,
            cells.pressure,
            cells.traction,
            cells.sticks,
        )
        speed = float(cells.speed.mean()) if cells.traction.any() else 0.0
        velocities, patches = RigidVelocities.of(self.motion), []
        for contact in np.argsort(self.rank):
            own = self.strips.contact == contact
            peak = float((self.strips.scale[own] * self.strips.half[own]).max())
            sums = patch_sums(np.repeat(own, m), points, velocities, speed)
            patches.append(replace(sums.patch, max_pressure=peak))
        return tuple(patches)
