"""Results of a contact on strips: fields by cell, and patches, computed on demand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities
from wheelrail.contact.models.standard.forces import StripTractions
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.results.patch_sums import PATCH_NUMBERS, PatchPoints, patch_sums, patches_of, store_patch
from wheelrail.contact.results.result import Fields, Patch
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled

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
        places, velocities = self.surfaces.profiles(self.strips.s, self.point), RigidVelocities.of(self.motion)
        rows = patch_rows(self.zones.weight, self.strips, self.cells, self.axes, places, velocities)
        return patches_of(rows)


@compiled
def patch_rows(
    weight: Array,
    strips: StripPressures,
    cells: StripTractions,
    axes: Array,
    places: tuple[Array, Array],
    v: RigidVelocities,
) -> Array:
    """Sums over the cells of every contact, rows (k, 26) of `store_patch` by decreasing load.

    Parameters:
        weight: (k,) of the contacts.
        strips, cells: n strips of the contacts, and their cells.
        axes: (n, 3, 3) of the strips.
        places: arc lengths and lateral positions (n, 2) m of the strips on both profiles.
        v: rigid motion of wheel and rail.
    """
    k, n = len(weight), len(axes)
    rows, of_cells, m = np.empty((k, PATCH_NUMBERS)), np.arange(n).repeat(len(cells.area) // n), len(cells.area) // n
    all_axes, on_wheel, on_rail = axes[of_cells], places[0][of_cells], places[1][of_cells]
    level = all_axes[:, 0].copy()
    points = PatchPoints(
        cells.point,
        all_axes,
        level,
        cells.area,
        cells.length,
        on_wheel,
        on_rail,
        cells.pressure,
        cells.traction,
        cells.sticks,
    )
    speed = cells.speed.mean() if cells.traction.any() else 0.0
    order = np.argsort(-strips.load * weight, kind="mergesort")
    for place in range(k):
        inside, peak = np.zeros(n * m, dtype=np.bool_), 0.0
        for i in range(n):
            if strips.contact[i] == order[place]:
                inside[i * m : (i + 1) * m] = True
                peak = max(peak, strips.scale[i] * strips.half[i])
        store_patch(patch_sums(inside, points, v, speed), peak, rows[place])
    return rows
