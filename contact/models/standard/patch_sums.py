"""Resultants of patches on strips as compiled sums over their cells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.standard.forces import (
    RigidVelocities,
    StripTractions,
    relative_rotation,
    relative_velocity,
)
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import compiled


class PatchSums(NamedTuple):
    """Sums over the cells of a patch; see `wheelrail.contact.results.result.Patch` for what they are there.

    Parameters:
        area, stick_area: m2.
        force: (3,) N.
        axes: (3, 3), rows forward, left and upward of the mean contact plane.
        point: (3,) m, centre of pressure.
        wheel, rail: (2,) m, its arc length and lateral position on both profiles.
        bands: (4,) m, smallest and largest lateral position on the wheel, and on the rail.
        semi_axes: (2,) m.
        creepage: (3,).
        power: W.
    """

    area: float
    stick_area: float
    force: Array
    axes: Array
    point: Array
    wheel: Array
    rail: Array
    bands: Array
    semi_axes: Array
    creepage: Array
    power: float


@compiled
def patch_sums(
    inside: Mask,
    cells: StripTractions,
    strip_axes: Array,
    on_wheel: Array,
    on_rail: Array,
    v: RigidVelocities,
    speed: float,
) -> PatchSums:
    """Sums over the cells of some strips.

    Parameters:
        inside: (n,), the strips.
        cells: of all strips.
        strip_axes: (n, 3, 3), axes of the strips.
        on_wheel, on_rail: (n, 2) m, arc length and lateral position of the strips on both profiles.
        v: rigid motion of wheel and rail.
        speed: rolling speed, m/s; 0: no creepage and no power.
    """
    n = len(strip_axes)
    m = len(cells.area) // n
    total, area, stick_area, power = 0.0, 0.0, 0.0, 0.0
    force, axes, point, wheel, rail = np.zeros(3), np.zeros((3, 3)), np.zeros(3), np.zeros(2), np.zeros(2)
    bands = np.array([np.inf, -np.inf, np.inf, -np.inf])
    for i in range(n):
        if not inside[i]:
            continue
        own = strip_axes[i]
        for q in range(i * m, (i + 1) * m):
            size, p, tx, ty = cells.area[q], cells.pressure[q], cells.traction[q, 0], cells.traction[q, 1]
            load = p * size
            total += load
            area += size
            if cells.sticks[q]:
                stick_area += size
            for c in range(3):
                force[c] += size * (tx * own[0, c] + ty * own[1, c]) - load * own[2, c]
                axes[2, c] -= load * own[2, c]
                point[c] += load * cells.point[q, c]
            for c in range(2):
                wheel[c] += load * on_wheel[i, c]
                rail[c] += load * on_rail[i, c]
            # half the width of the surface that belongs to a cell
            half = 0.5 * size / cells.length[q] * abs(own[2, 2])
            bands[0], bands[1] = min(bands[0], on_wheel[i, 1] - half), max(bands[1], on_wheel[i, 1] + half)
            bands[2], bands[3] = min(bands[2], on_rail[i, 1] - half), max(bands[3], on_rail[i, 1] + half)
            if speed > 0.0:
                slip_x, slip_y = (
                    relative_velocity(v, cells.point[q], own[0]),
                    relative_velocity(v, cells.point[q], own[1]),
                )
                power -= size * (tx * slip_x + ty * slip_y)
    for c in range(3):
        point[c] /= total
    for c in range(2):
        wheel[c] /= total
        rail[c] /= total
    axes[2] /= np.sqrt((axes[2] ** 2).sum())
    axes[0, 0] = 1.0
    for c in range(3):
        axes[0, c] -= axes[2, 0] * axes[2, c]
    axes[0] /= np.sqrt((axes[0] ** 2).sum())
    for c in range(3):
        i, j = (c + 1) % 3, (c + 2) % 3
        axes[1, c] = axes[2, i] * axes[0, j] - axes[2, j] * axes[0, i]
    along, across = 0.0, 0.0
    for i in range(n):
        if inside[i]:
            for q in range(i * m, (i + 1) * m):
                load = cells.pressure[q] * cells.area[q]
                along += load * (cells.point[q, 0] - point[0]) ** 2
                across += load * (on_wheel[i, 0] - wheel[0]) ** 2
    semi_axes = np.array([np.sqrt(5.0 * along / total), np.sqrt(5.0 * across / total)])
    creepage = np.zeros(3)
    if speed > 0.0:
        creepage[0], creepage[1] = relative_velocity(v, point, axes[0]), relative_velocity(v, point, axes[1])
        creepage[2] = relative_rotation(v, -axes[2])
        creepage /= speed
    return PatchSums(area, stick_area, force, axes, point, wheel, rail, bands, semi_axes, creepage, power)
