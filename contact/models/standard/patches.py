"""Results of a contact on strips: fields by cell, and patches, computed on demand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.standard.forces import RigidVelocities, StripTractions
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.models.standard.patch_sums import patch_sums
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
        on_wheel, on_rail = self.surfaces.profiles(self.strips.s, self.point)
        speed = float(self.cells.speed.mean()) if self.cells.traction.any() else 0.0
        velocities, patches = RigidVelocities.of(self.motion), []
        for contact in np.argsort(self.rank):
            own = self.strips.contact == contact
            sums = patch_sums(own, self.cells, self.axes, on_wheel, on_rail, velocities, speed)
            forward, left, normal = (sums.axes @ sums.force).tolist()
            semi_axes, bands, creepage = sums.semi_axes.tolist(), sums.bands.tolist(), sums.creepage.tolist()
            (wheel_s, wheel_y), (rail_s, rail_y) = sums.wheel.tolist(), sums.rail.tolist()
            patch = Patch(
                area=sums.area,
                max_pressure=float((self.strips.scale[own] * self.strips.half[own]).max()),
                normal_force=normal,
                force=sums.force,
                tangential_force=(forward, left),
                semi_axes=(semi_axes[0], semi_axes[1]),
                contact_angle=float(np.arctan2(-sums.axes[2, 1], sums.axes[2, 2])),
                wheel_s=wheel_s,
                rail_s=rail_s,
                wheel_y=wheel_y,
                rail_y=rail_y,
                wheel_band=(bands[0], bands[1]),
                rail_band=(bands[2], bands[3]),
                x=float(sums.point[0]),
                stick_area=sums.stick_area,
                creepage=(creepage[0], creepage[1], creepage[2]),
                frictional_power=sums.power,
            )
            patches.append(patch)
        return tuple(patches)
