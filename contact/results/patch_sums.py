"""Resultants of patches as compiled sums over their contact points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities, creepages, velocity_along
from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import borrowing, compiled

PATCH_NUMBERS = 26  # of `store_patch`


class PatchPoints(NamedTuple):
    """Loaded contact points.

    Parameters:
        point: (n, 3) m.
        axes: (n, 3, 3), rows longitudinal, lateral, outward from the wheel.
        level: (n, 3), longitudinal axes for the velocity of the rail, see `wheelrail.contact.kinematics.creepage`.
        area: (n,) m2.
        step: (n,) m, length of the point's cell along the rolling direction.
        on_wheel, on_rail: (n, 2) m, arc length and lateral position on the profiles.
        pressure: (n,) Pa.
        traction: (n, 2) Pa, on the wheel.
        sticks: (n,), whether the surfaces stick.
    """

    point: Array
    axes: Array
    level: Array
    area: Array
    step: Array
    on_wheel: Array
    on_rail: Array
    pressure: Array
    traction: Array
    sticks: Mask


class PatchSums(NamedTuple):
    """Sums over the points of a patch; see `wheelrail.contact.results.result.Patch` for what they are there.

    Parameters:
        area, stick_area: m2.
        peak: Pa, the largest pressure.
        force: (3,) N.
        axes: (3, 3), rows forward, left and upward of the mean contact plane.
        slope: of the common surface of the deformed bodies over that plane.
        point: (3,) m, centre of pressure.
        wheel, rail: (2,) m, its arc length and lateral position on both profiles.
        bands: (4,) m, smallest and largest lateral position on the wheel, and on the rail.
        semi_axes: (2,) m.
        creepage: (3,).
        power: W, of the tractions on the rigid slip and of the pressure on the rolling slopes of the penetration. In
            steady rolling it is the frictional heat: tractions and pressure do no work on displacements that pass by
            unchanged, by Betti's theorem, but tractions alone do where they shift the pressure along x, as on a flange.
            Sums of traction times slip converge to the same value, from 7 % below with 12 x 16 cells.
        strips: as of `wheelrail.contact.results.result.Patch`.
    """

    area: float
    stick_area: float
    peak: float
    force: Array
    axes: Array
    slope: float
    point: Array
    wheel: Array
    rail: Array
    bands: Array
    semi_axes: Array
    creepage: tuple[float, float, float]
    power: float
    strips: int


@borrowing
def inclination(axes: Array) -> float:
    """Rotation rad of a contact plane with axes (3, 3) about x."""
    return float(np.arctan2(-axes[2, 1], axes[2, 2]))


@borrowing
def store_patch(sums: PatchSums, peak: float, row: Array) -> None:
    """Fill a row (26,) of numbers for `patches_of`; peak: Pa, in place of that of the sums."""
    forward, left, normal = 0.0, 0.0, 0.0
    for c in range(3):
        forward += sums.axes[0, c] * sums.force[c]
        left += sums.axes[1, c] * sums.force[c]
        normal += sums.axes[2, c] * sums.force[c]
        row[3 + c], row[21 + c] = sums.force[c], sums.creepage[c]
    row[0], row[1], row[2], row[6], row[7] = sums.area, peak, normal, forward, left
    row[8], row[9], row[10] = sums.semi_axes[0], sums.semi_axes[1], inclination(sums.axes) - sums.slope
    row[11], row[12], row[13], row[14] = sums.wheel[0], sums.rail[0], sums.wheel[1], sums.rail[1]
    for c in range(4):
        row[15 + c] = sums.bands[c]
    row[19], row[20], row[24], row[25] = sums.point[0], sums.stick_area, sums.power, sums.strips


def patches_of(rows: Array) -> tuple[Patch, ...]:
    """Patches with the numbers of rows (k, 26) of `store_patch`, their fields in order."""
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


@compiled
def patch_sums(inside: Mask, points: PatchPoints, v: RigidVelocities, speed: float) -> PatchSums:
    """Sums over some points.

    Parameters:
        inside: (n,), the points.
        points: all points.
        v: rigid motion of wheel and rail.
        speed: rolling speed, m/s; 0: no creepage and no power.
    """
    total, area, stick_area, peak, power = 0.0, 0.0, 0.0, 0.0, 0.0
    force, axes, point, wheel, rail = np.zeros(3), np.zeros((3, 3)), np.zeros(3), np.zeros(2), np.zeros(2)
    bands = np.array([np.inf, -np.inf, np.inf, -np.inf])
    for q in range(len(inside)):
        if not inside[q]:
            continue
        size, p, tx, ty = points.area[q], points.pressure[q], points.traction[q, 0], points.traction[q, 1]
        load = p * size
        total += load
        area += size
        peak = max(peak, p)
        if points.sticks[q]:
            stick_area += size
        for c in range(3):
            force[c] += size * (tx * points.axes[q, 0, c] + ty * points.axes[q, 1, c]) - load * points.axes[q, 2, c]
            axes[2, c] -= load * points.axes[q, 2, c]
            point[c] += load * points.point[q, c]
        for c in range(2):
            wheel[c] += load * points.on_wheel[q, c]
            rail[c] += load * points.on_rail[q, c]
        # half the width of the surface that belongs to a point
        half = 0.5 * size / points.step[q] * abs(points.axes[q, 2, 2])
        bands[0], bands[1] = min(bands[0], points.on_wheel[q, 1] - half), max(bands[1], points.on_wheel[q, 1] + half)
        bands[2], bands[3] = min(bands[2], points.on_rail[q, 1] - half), max(bands[3], points.on_rail[q, 1] + half)
        if speed > 0.0:
            at = points.point[q]
            by_x = velocity_along(v.wheel_turn, v.wheel_at, v.wheel, at, points.axes[q, 0])
            by_x -= velocity_along(v.rail_turn, v.rail_at, v.rail, at, points.level[q])
            by_y = velocity_along(v.wheel_turn, v.wheel_at, v.wheel, at, points.axes[q, 1])
            by_y -= velocity_along(v.rail_turn, v.rail_at, v.rail, at, points.axes[q, 1])
            slope = 0.0  # of the penetration along x, whose displacements the pressure follows
            for c in range(3):
                slope += points.level[q, c] * points.axes[q, 2, c]
            power -= size * (tx * by_x + ty * by_y) - load * speed * slope
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
    for q in range(len(inside)):
        if inside[q]:
            load = points.pressure[q] * points.area[q]
            along += load * (points.point[q, 0] - point[0]) ** 2
            across += load * (points.on_wheel[q, 0] - wheel[0]) ** 2
    semi_axes = np.array([np.sqrt(5.0 * along / total), np.sqrt(5.0 * across / total)])
    outward = axes.copy()
    outward[2] = -axes[2]
    creepage = creepages(v, point, outward, speed)
    places = point, wheel, rail, bands
    return PatchSums(area, stick_area, peak, force, axes, 0.0, *places, semi_axes, creepage, power, 0)
