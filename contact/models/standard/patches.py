"""Results of a contact on strips: fields by cell, and patches, computed on demand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.bindings._contact import RigidVelocities
from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.left_pair import velocities_of
from wheelrail.contact.models.standard.forces import StripTractions
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.results.patch_sums import PATCH_NUMBERS, PatchPoints, patch_sums, patches_of, store_patch
from wheelrail.contact.results.result import Fields, Patch
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled

LEAST_LENGTH = 0.01  # of the semi-axis along x: shorter strips are no part of a patch

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
        """Patch (k,) of each contact."""
        return patch_numbers(self.strips, self.zones.weight)

    def patches(self) -> tuple[Patch, ...]:
        """All patches, by decreasing load."""
        places, velocities = self.surfaces.profiles(self.strips.s, self.point), velocities_of(self.motion)
        rows = patch_rows(self.zones.weight, self.strips, self.cells, self.axes, places, velocities)
        return patches_of(rows)


@compiled
def patch_numbers(strips: StripPressures, weight: Array) -> Nodes:
    """Number (k,) of the patch of each contact, by decreasing load: contacts whose pressures overlap share one.

    Parameters:
        strips: of k contacts.
        weight: (k,) of the contacts.
    """
    k = len(weight)
    first, last, patch, load = np.full(k, np.inf), np.full(k, -np.inf), np.arange(k), np.zeros(k)
    for i in range(len(strips.s)):
        c = strips.contact[i]
        if strips.half[i] > LEAST_LENGTH * strips.along[c]:
            first[c], last[c] = min(first[c], strips.s[i]), max(last[c], strips.s[i])
    for c in range(k):
        for other in range(c):
            before, after = patch[c], patch[other]
            if first[c] < last[other] and first[other] < last[c] and before != after:
                for each in range(k):
                    patch[each] = after if patch[each] == before else patch[each]
    for c in range(k):
        load[patch[c]] += strips.load[c] * weight[c]
    order, rank = np.argsort(-load, kind="mergesort"), np.empty(k, dtype=np.int64)
    for place in range(k):
        rank[order[place]] = place
    for c in range(k):
        patch[c] = rank[patch[c]]
    return patch


@borrowing
def pressure_at(strips: StripPressures, contact: int, s: float) -> float:
    """Largest pressure Pa of a contact along the line s m, linear between its strips; 0 beyond them."""
    below, above, low, high = -np.inf, np.inf, 0.0, 0.0
    for i in range(len(strips.s)):
        if strips.contact[i] == contact:
            if below < strips.s[i] <= s:
                below, low = strips.s[i], strips.scale[i] * strips.half[i]
            if s <= strips.s[i] < above:
                above, high = strips.s[i], strips.scale[i] * strips.half[i]
    if below == above:
        return low
    return low + (high - low) * (s - below) / (above - below) if np.isfinite(above - below) else 0.0


@borrowing
def joint_pressure(strips: StripPressures, weight: Array, patch: Nodes, i: int) -> float:
    """Largest pressure Pa along strip i: of contacts that are about to merge, and press on the same places, the sum.

    weight (k,) of the contacts, and patch (k,) of each.
    """
    own = strips.contact[i]
    total: float = strips.scale[i] * strips.half[i]
    joint: float = weight[own] * total
    alone = True
    for c in range(len(weight)):
        if c != own and patch[c] == patch[own]:
            joint += weight[c] * pressure_at(strips, c, strips.s[i])
            alone = False
    return total if alone else joint


@compiled
def patch_rows(
    weight: Array,
    strips: StripPressures,
    cells: StripTractions,
    axes: Array,
    places: tuple[Array, Array],
    v: RigidVelocities,
) -> Array:
    """Sums over the cells of every patch, rows (p, 26) of `store_patch` by decreasing load.

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
    patch = patch_numbers(strips, weight)
    count = patch.max() + 1
    for place in range(count):
        inside, peak = np.zeros(n * m, dtype=np.bool_), 0.0
        for i in range(n):
            if patch[strips.contact[i]] == place:
                inside[i * m : (i + 1) * m] = True
                peak = max(peak, joint_pressure(strips, weight, patch, i))
        store_patch(patch_sums(inside, points, v, speed), peak, rows[place])
    return rows[:count]
