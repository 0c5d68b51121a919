"""What a contact on strips hands to its result: fields cell by cell, and patches summed up when they are looked at."""

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
from wheelrail.contact.results.resultants import FrictionalWork, summarise
from wheelrail.support.arrays import Array, Nodes

if TYPE_CHECKING:
    from wheelrail.contact.geometry.rigid_surfaces import RigidPair


@dataclass(frozen=True)
class StripContacts:
    """Zones, strips and cells of one solve; points (n, 3) m and axes (n, 3, 3) of the n strips."""

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
        """Cells to a strip."""
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
        """Place (k,) of each contact in the list by falling load."""
        rank = np.empty(len(self.zones.share), dtype=np.int64)
        rank[np.argsort(-self.strips.load * self.zones.share, kind="stable")] = np.arange(len(rank))
        return rank

    def summaries(self) -> tuple[Patch, ...]:
        """Every contact, by falling load."""
        fields, cells, strips = self.fields(), self.cells, self.strips
        on_wheel, on_rail = self.surfaces.profiles(strips.s, self.point)
        places = SurfacePoints(
            point=fields.point,
            axes=fields.axes,
            area=fields.area,
            overlap=fields.penetration,
            wheel_rotation=self.pose.rotation,
            step=fields.step,
            wheel_place=np.repeat(on_wheel, self.count, axis=0),
            rail_place=np.repeat(on_rail, self.count, axis=0),
        )
        local = np.column_stack([cells.traction, -cells.pressure]) * cells.area[:, None]
        forces = (local[:, None, :] @ fields.axes)[:, 0]
        speed = float(cells.speed.mean()) if cells.traction.any() else 0.0
        rubbing = FrictionalWork(places, cells.traction, cells.sticks, self.motion, speed)
        found = []
        for contact in np.argsort(self.rank):
            inside = fields.patch == self.rank[contact]
            own = strips.contact == contact
            patch = summarise(places, inside, forces=forces, pressure=cells.pressure, rubbing=rubbing)
            found.append(replace(patch, max_pressure=float((strips.scale[own] * strips.half[own]).max())))
        return tuple(found)
