"""Resultants of patches as compiled sums over their contact points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities, creepages, velocity_along
from wheelrail.contact.results.result import Patch
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import compiled

PATCH_NUMBERS = 32  # of `store_sums`


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
        point: (3,) m, centre of pressure.
        wheel, rail: (2,) m, its arc length and lateral position on both profiles.
        bands: (4,) m, smallest and largest lateral position on the wheel, and on the rail.
        semi_axes: (2,) m.
        creepage: (3,).
        power: W, of the tractions on the rigid slip. In steady rolling it is the frictional heat, as the power of the
            elastic slip sums to zero; sums of traction times slip converge to the same value, from 7 % below with
            12 x 16 cells.
    """

    area: float
    stick_area: float
    peak: float
    force: Array
    axes: Array
    point: Array
    wheel: Array
    rail: Array
    bands: Array
    semi_axes: Array
    creepage: tuple[float, float, float]
    power: float

    @classmethod
    def of(cls, row: Array) -> PatchSums:
        """Sums of a row (32,) of `store_sums`."""
        area, stick_area, peak, power, *creepage = row[25:].tolist()
        return cls(
            area,
            stick_area,
            peak,
            row[:3],
            row[3:12].reshape(3, 3),
            row[12:15],
            row[15:17],
            row[17:19],
            row[19:23],
            row[23:25],
            (creepage[0], creepage[1], creepage[2]),
            power,
        )

    @property
    def patch(self) -> Patch:
        """The patch with these resultants."""
        forward, left, normal = (self.axes @ self.force).tolist()
        semi_axes, bands = self.semi_axes.tolist(), self.bands.tolist()
        (wheel_s, wheel_y), (rail_s, rail_y) = self.wheel.tolist(), self.rail.tolist()
        return Patch(
            area=self.area,
            max_pressure=self.peak,
            normal_force=normal,
            force=self.force,
            tangential_force=(forward, left),
            semi_axes=(semi_axes[0], semi_axes[1]),
            contact_angle=float(np.arctan2(-self.axes[2, 1], self.axes[2, 2])),
            wheel_s=wheel_s,
            rail_s=rail_s,
            wheel_y=wheel_y,
            rail_y=rail_y,
            wheel_band=(bands[0], bands[1]),
            rail_band=(bands[2], bands[3]),
            x=float(self.point[0]),
            stick_area=self.stick_area,
            creepage=self.creepage,
            frictional_power=self.power,
        )


@compiled
def store_sums(sums: PatchSums, peak: float, row: Array) -> None:
    """Fill a row (32,) with sums, for compiled code that returns several; peak: Pa, in place of theirs."""
    row[:3], row[3:12], row[12:15], row[15:17] = sums.force, sums.axes.ravel(), sums.point, sums.wheel
    row[17:19], row[19:23], row[23:25] = sums.rail, sums.bands, sums.semi_axes
    row[25], row[26], row[27], row[28] = sums.area, sums.stick_area, peak, sums.power
    row[29], row[30], row[31] = sums.creepage


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
            power -= size * (tx * by_x + ty * by_y)
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
    return PatchSums(area, stick_area, peak, force, axes, point, wheel, rail, bands, semi_axes, creepage, power)
