"""Results of a contact on strips: fields by cell, and patches, computed on demand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.contact_points import SurfacePoints
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.standard.forces import StripTractions
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.results.result import Fields, Patch
from wheelrail.contact.results.resultants import FrictionalWork, patch_resultants
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
        fields, cells, strips = self.fields(), self.cells, self.strips
        on_wheel, on_rail = self.surfaces.profiles(strips.s, self.point)
        points = SurfacePoints(
            point=fields.point,
            axes=fields.axes,
            area=fields.area,
            penetration=fields.penetration,
            wheel_rotation=self.pose.rotation,
            step=fields.step,
            wheel_place=np.repeat(on_wheel, self.count, axis=0),
            rail_place=np.repeat(on_rail, self.count, axis=0),
        )
        local = np.column_stack([cells.traction, -cells.pressure]) * cells.area[:, None]
        forces = (local[:, None, :] @ fields.axes)[:, 0]
        speed = float(cells.speed.mean()) if cells.traction.any() else 0.0
        work = FrictionalWork(points, cells.traction, cells.sticks, self.motion, speed)
        patches = []
        for contact in np.argsort(self.rank):
            inside = fields.patch == self.rank[contact]
            own = strips.contact == contact
            patch = patch_resultants(work, inside, forces=forces, pressure=cells.pressure)
            patches.append(replace(patch, max_pressure=float((strips.scale[own] * strips.half[own]).max())))
        return tuple(patches)
