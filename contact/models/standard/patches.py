"""Results of a contact on strips: fields by cell, and patches, computed on demand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.bindings._contact import (
    PenetrationRegions,
    StripFrames,
    StripPressures,
    StripTractions,
    patch_numbers,
    patch_rows,
)
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.left_pair import velocities_of
from wheelrail.contact.results.patch_sums import patches_of
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
        on_wheel, on_rail = self.surfaces.profiles(self.strips.s, self.point)
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
            wheel_s=np.repeat(on_wheel[:, 0], self.count),
            rail_s=np.repeat(on_rail[:, 0], self.count),
        )

    @cached_property
    def rank(self) -> Nodes:
        """Patch (k,) of each contact."""
        return patch_numbers(self.strips, self.zones.weight)

    def patches(self) -> tuple[Patch, ...]:
        """All patches, by decreasing load."""
        on_wheel, on_rail = self.surfaces.profiles(self.strips.s, self.point)
        middles, velocities = StripFrames(self.point, self.axes), velocities_of(self.motion)
        rows = patch_rows(self.zones.weight, self.strips, self.cells, middles, on_wheel, on_rail, velocities)
        return patches_of(rows)
