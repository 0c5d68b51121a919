"""Resultants of patches as sums over their contact points, by the core."""

from __future__ import annotations

from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array


def patches_of(rows: Array) -> tuple[Patch, ...]:
    """Patches with the numbers of rows (k, 26) of the core's `store_patch`, their fields in order."""
    return tuple(_patch(row) for row in rows)


def _patch(row: Array) -> Patch:
    numbers = row.tolist()
    return Patch(
        area=numbers[0],
        max_pressure=numbers[1],
        normal_force=numbers[2],
        force=row[3:6].copy(),
        tangential_force=(numbers[6], numbers[7]),
        semi_axes=(numbers[8], numbers[9]),
        contact_angle=numbers[10],
        wheel_s=numbers[11],
        rail_s=numbers[12],
        wheel_y=numbers[13],
        rail_y=numbers[14],
        wheel_band=(numbers[15], numbers[16]),
        rail_band=(numbers[17], numbers[18]),
        x=numbers[19],
        stick_area=numbers[20],
        creepage=(numbers[21], numbers[22], numbers[23]),
        frictional_power=numbers[24],
        strips=int(numbers[25]),
    )
