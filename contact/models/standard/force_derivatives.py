"""Derivative of the contact force of a wheel on a rail by pose and motion, in closed form.

Every strip has three resultants of its tractions, see `wheelrail.contact.models.standard.strip_resultant`, which depend
on its creepages and on the load and the shape of its patch. Derivatives are carried along in twelve directions, those
of `wheelrail.contact.results.result.ContactResult.tangent`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities, rolling_speed
from wheelrail.contact.models.standard.creep_coefficients import PairElasticity, coefficients
from wheelrail.contact.models.standard.fastsim import foundation
from wheelrail.contact.models.standard.forces import PARABOLA, StripFrames, mean_creepages, parabola_means
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.models.standard.pressure_derivatives import PressureDerivatives
from wheelrail.contact.models.standard.region_derivatives import MOTIONS, RegionDerivatives, rigid_motions
from wheelrail.contact.models.standard.strip_resultant import END, INCREMENTS, strip_increments, strip_slopes
from wheelrail.meshes.curves.closest_point import Shape, local, piece
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, unchecked

CHANGES = 12


@borrowing
def surface_derivatives(
    wheel: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    place: tuple[float, float],
    by_place: Array,
    frame: tuple[Array, Array],
    by_point: Array,
    by_axes: Array,
) -> None:
    """Fill derivatives (3, 6) of a point on the wheel and (3, 3, 6) of its axes by the six rigid motions.

    Parameters:
        wheel: shape of the profile.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        place: arc length on the profile and x, m.
        by_place: (2, 6), derivatives of the place by the six rigid motions.
        frame: the point (3,) m and its axes (3, 3).
        by_point, by_axes: filled.
    """
    (s, x), (point, axes) = place, frame
    inside = wheel.breaks[0] < s < wheel.breaks[-1]
    s = min(max(s, wheel.breaks[0]), wheel.breaks[-1])
    z, t, k = local(wheel, s, piece(wheel, s))
    r, sine, cosine = z.imag + radius, np.sin(x / radius), np.cos(x / radius)
    rigid_motions(point[0] - origin[0], point[1] - origin[1], point[2] - origin[2], False, by_point)
    for a in (0, 2):
        rigid_motions(axes[a, 0], axes[a, 1], axes[a, 2], True, by_axes[a])
    for c in range(3):
        forward, axle, up = rotation[c, 0], rotation[c, 1], rotation[c, 2]
        point_s = forward * (t.imag * sine) + axle * t.real - up * (t.imag * cosine)
        point_x = (forward * (r * cosine) + up * (r * sine)) / radius
        outward_s = forward * (k.real * sine) - axle * k.imag - up * (k.real * cosine)
        outward_x = (forward * (t.real * cosine) + up * (t.real * sine)) / radius
        forward_x = (-forward * sine + up * cosine) / radius
        for q in range(MOTIONS):
            by_s, by_x = by_place[0, q] if inside else 0.0, by_place[1, q]
            by_point[c, q] += point_s * by_s + point_x * by_x
            by_axes[2, c, q] += outward_s * by_s + outward_x * by_x
            by_axes[0, c, q] += forward_x * by_x
    for c in range(3):
        after, last = (c + 1) % 3, (c + 2) % 3
        for q in range(MOTIONS):
            by_axes[1, c, q] = (
                by_axes[0, after, q] * axes[2, last]
                + axes[0, after] * by_axes[2, last, q]
                - by_axes[0, last, q] * axes[2, after]
                - axes[0, last] * by_axes[2, after, q]
            )


@borrowing
def component_derivatives(
    v: RigidVelocities,
    parts: tuple[float, float],
    reference: Array,
    point: Array,
    by_point: Array,
    axis: Array,
    by_axis: Array,
    column: Array,
) -> None:
    """Fill derivatives (12,) of the component along an axis of a sum of the velocities of wheel and rail at a point.

    Parameters:
        v: rigid motion of both bodies; the wheel's reference point moves with its frame.
        parts: factors of both velocities.
        reference: (3, 6), derivatives of that point.
        point, by_point: (3,) m and (3, 6).
        axis, by_axis: (3,) and (3, 6).
        column: filled.

    With the angular velocity w, w x p changes along the axis a by dp . (a x w).
    """
    (part, other), (ax, ay, az) = parts, (axis[0], axis[1], axis[2])
    x, y, z = point[0] - v.wheel_at[0], point[1] - v.wheel_at[1], point[2] - v.wheel_at[2]
    wx, wy, wz = part * v.wheel_turn[0], part * v.wheel_turn[1], part * v.wheel_turn[2]
    a, b, c = point[0] - v.rail_at[0], point[1] - v.rail_at[1], point[2] - v.rail_at[2]
    rx, ry, rz = other * v.rail_turn[0], other * v.rail_turn[1], other * v.rail_turn[2]
    vx = part * v.wheel[0] + wy * z - wz * y + other * v.rail[0] + ry * c - rz * b
    vy = part * v.wheel[1] + wz * x - wx * z + other * v.rail[1] + rz * a - rx * c
    vz = part * v.wheel[2] + wx * y - wy * x + other * v.rail[2] + rx * b - ry * a
    hx, hy, hz = ay * wz - az * wy, az * wx - ax * wz, ax * wy - ay * wx
    gx, gy, gz = hx + ay * rz - az * ry, hy + az * rx - ax * rz, hz + ax * ry - ay * rx
    for q in range(MOTIONS):
        moved = gx * by_point[0, q] + gy * by_point[1, q] + gz * by_point[2, q]
        turned = vx * by_axis[0, q] + vy * by_axis[1, q] + vz * by_axis[2, q]
        column[q] = moved + turned - (hx * reference[0, q] + hy * reference[1, q] + hz * reference[2, q])
    column[6], column[7], column[8] = part * ax, part * ay, part * az
    column[9], column[10] = part * (y * az - z * ay), part * (z * ax - x * az)
    column[11] = part * (x * ay - y * ax)


@borrowing
def creepage_derivatives(
    v: RigidVelocities,
    reference: Array,
    point: Array,
    by_point: Array,
    axes: Array,
    by_axes: Array,
    speed: tuple[float, Array],
    creepage: tuple[float, float, float],
    columns: Array,
) -> None:
    """Fill derivatives (3, 12) of longitudinal and lateral creepage and of spin.

    Parameters:
        v, reference, point, by_point: as for `component_derivatives`.
        axes, by_axes: (3, 3) and (3, 3, 6).
        speed: rolling speed m/s and its derivatives (12,).
        creepage: the values.
        columns: filled.
    """
    V, by_V = speed
    wx, wy, wz = v.wheel_turn[0] - v.rail_turn[0], v.wheel_turn[1] - v.rail_turn[1], v.wheel_turn[2] - v.rail_turn[2]
    for k in range(2):
        component_derivatives(v, (1.0, -1.0), reference, point, by_point, axes[k], by_axes[k], columns[k])
    for q in range(MOTIONS):
        columns[2, q] = -(wx * by_axes[2, 0, q] + wy * by_axes[2, 1, q] + wz * by_axes[2, 2, q])
    for k in range(3):
        columns[2, 6 + k], columns[2, 9 + k] = 0.0, -axes[2, k]
    for k in range(3):
        for q in range(CHANGES):
            columns[k, q] = (columns[k, q] - creepage[k] * by_V[q]) / V


@borrowing
def coefficient_slopes(table: Array, ratio: float) -> tuple[float, float, float]:
    """Derivatives of `wheelrail.contact.models.standard.creep_coefficients.coefficients` by the ratio of semi-axes."""
    side, shorter = (1 if ratio > 1.0 else 0), min(ratio, 1.0 / ratio)
    if shorter <= 0.1:
        return 0.0, 0.0, 0.0
    i = min(int(10.0 * shorter - 1.0), 8)
    slope = 10.0 * (-shorter * shorter if ratio > 1.0 else 1.0)
    low, high = table[side, i], table[side, i + 1]
    return slope * (high[0] - low[0]), slope * (high[1] - low[1]), slope * (high[2] - low[2])


class Derivation(NamedTuple):
    """Arrays that are filled on the way to the derivatives.

    Parameters:
        increments, resultants, slopes: (n, 5), (n, 3), zero, and (n, 3, 5), zero, of the strips.
        lanes: (END,), of FASTSIM.
        bounds: (m,) of the traction on the cells of a strip, over the largest one.
        creepage, by_creepage: (n, 3) and (n, 3, 12), of the strips.
        by_points, by_frames: (n + 1, 3, 6) and (n + 1, 3, 3, 6), of the strips, and of the maximum of a penetration.
        reference: (3, 6).
        by_speed: (12,), of the rolling speed.
        by_patch: (2, 12), of the longitudinal and lateral creepage of a patch.
        of_patch, by_strip, by_force: (6, 12), (3, 12) and (4, 12), zero.
        changes: (3,), of the resultants of a strip.
    """

    increments: Array
    resultants: Array
    slopes: Array
    lanes: Array
    bounds: Array
    creepage: Array
    by_creepage: Array
    by_points: Array
    by_frames: Array
    reference: Array
    by_speed: Array
    by_patch: Array
    of_patch: Array
    by_strip: Array
    by_force: Array
    changes: Array


@unchecked
def force_derivatives(
    wheel: Shape,
    radius: float,
    pose: tuple[Array, Array],
    zones: PenetrationRegions,
    strips: StripPressures,
    frames: tuple[StripFrames, StripFrames],
    v: RigidVelocities,
    elastic: PairElasticity,
    mu: float,
    cells: int,
    by_zones: RegionDerivatives,
    by_strips: PressureDerivatives,
) -> Array:
    """Derivative (6, 12) of force and moment about the rail's origin, for pressures on the curved surface and FASTSIM.

    Parameters:
        wheel: shape of the profile.
        radius: nominal rolling radius, m.
        pose: origin (3,) m and rotation (3, 3) of the wheel.
        zones, strips: interpenetration regions and their pressures.
        frames: at the strips, and at the maxima of the penetration.
        v: rigid motion of wheel and rail.
        elastic: constants of both bodies.
        mu: friction coefficient, constant; 0: no tangential tractions.
        cells: along each strip.
        by_zones, by_strips: derivatives of regions and pressures.
    """
    tangent, n, dome = np.zeros((6, CHANGES)), len(strips.s), parabola_means(cells)
    top = dome.max()
    work = Derivation(
        np.empty((n, INCREMENTS)),
        np.zeros((n, 3)),
        np.zeros((n, 3, INCREMENTS)),
        np.empty(END),
        dome / top,
        np.empty((n, 3)),
        np.empty((n, 3, CHANGES)),
        np.empty((n + 1, 3, MOTIONS)),
        np.empty((n + 1, 3, 3, MOTIONS)),
        np.empty((3, MOTIONS)),
        np.empty(CHANGES),
        np.empty((2, CHANGES)),
        np.zeros((6, CHANGES)),
        np.zeros((3, CHANGES)),
        np.zeros((4, CHANGES)),
        np.empty(3),
    )
    of_pair, of_regions = (elastic, mu, top), (by_zones, by_strips)
    add_derivatives(wheel, radius, pose, zones, strips, frames, v, of_pair, of_regions, work, tangent)
    return tangent


@borrowing
def add_derivatives(
    wheel: Shape,
    radius: float,
    pose: tuple[Array, Array],
    zones: PenetrationRegions,
    strips: StripPressures,
    frames: tuple[StripFrames, StripFrames],
    v: RigidVelocities,
    of_pair: tuple[PairElasticity, float, float],
    of_regions: tuple[RegionDerivatives, PressureDerivatives],
    work: Derivation,
    tangent: Array,
) -> None:
    """Add the derivatives of `force_derivatives` to a tangent (6, 12).

    Parameters:
        of_pair: constants of both bodies, friction coefficient, and the largest mean of 1 - t^2 over a cell.
        of_regions: derivatives of regions and pressures.
        work: filled.

    Other parameters are those of `force_derivatives`.
    """
    (origin, rotation), (middles, peaks), (elastic, mu, top), (by_zones, by_strips) = pose, frames, of_pair, of_regions
    increments, resultants, all_slopes, bounds = work.increments, work.resultants, work.slopes, work.bounds
    lanes = work.lanes
    by_points, by_frames, reference, by_speed = work.by_points, work.by_frames, work.reference, work.by_speed
    creepage, by_creepage, by_patch, of_patch = work.creepage, work.by_creepage, work.by_patch, work.of_patch
    by_strip, by_force, changes = work.by_strip, work.by_force, work.changes
    at = v.wheel_at
    rigid_motions(at[0] - origin[0], at[1] - origin[1], at[2] - origin[2], False, reference)
    start, n = 0, len(strips.s)
    for c in range(len(zones.peak)):
        stop = start
        of_patch[:] = 0.0
        while stop < n and strips.contact[stop] == c:
            stop += 1
        point, axes, place = peaks.point[c], peaks.axes[c], (zones.peak[c], zones.peak_x[c])
        by_place, by_point, by_axes = by_zones.contacts[c, :2], by_points[n], by_frames[n]
        surface_derivatives(wheel, radius, origin, rotation, place, by_place, (point, axes), by_point, by_axes)
        speed = rolling_speed(v, point, axes[0])
        component_derivatives(v, (-0.5, -0.5), reference, point, by_point, axes[0], by_axes[0], by_speed)
        a, b, load, weight = strips.along[c], strips.across[c], strips.load[c], zones.weight[c]
        xi, eta, _ = mean_creepages(strips, (start, stop), middles, v, speed, creepage)
        by_patch[:] = 0.0
        for i in range(start, stop):
            half, width, point, axes = strips.half[i], strips.width[i], middles.point[i], middles.axes[i]
            place, by_place, by_point, by_axes = (
                (strips.s[i], strips.x[i]),
                by_strips.strips[i],
                by_points[i],
                by_frames[i],
            )
            surface_derivatives(wheel, radius, origin, rotation, place, by_place, (point, axes), by_point, by_axes)
            own, by_own = (creepage[i, 0], creepage[i, 1], creepage[i, 2]), by_creepage[i]
            creepage_derivatives(v, reference, point, by_point, axes, by_axes, (speed, by_speed), own, by_own)
            share = 0.5 * np.pi * strips.scale[i] * half * half * width / load  # of the patch's normal force
            for q in range(CHANGES):
                by_patch[0, q] += share * by_own[0, q]
                by_patch[1, q] += share * by_own[1, q]
            for q in range(MOTIONS):
                by_share = share * (2.0 * by_strips.strips[i, 3, q] / half + by_strips.strips[i, 2, q] / width)
                by_patch[0, q] += by_share * (own[0] - xi)
                by_patch[1, q] += by_share * (own[1] - eta)
        kalker, kalker_slopes = coefficients(elastic.table, a / b), coefficient_slopes(elastic.table, a / b)
        flexible = foundation(a, b, elastic.G, kalker)
        # logarithmic derivatives of the three flexibilities; then the parts of the increments' derivatives that are the
        # same for all strips, and the derivative of the weight
        for q in range(MOTIONS):
            by_a, by_b = by_strips.patches[c, 1, q] / a, by_strips.patches[c, 2, q] / b
            ratio = a / b * (by_a - by_b)
            of_patch[0, q] = by_a - kalker_slopes[0] * ratio / kalker[0]
            of_patch[1, q] = by_a - kalker_slopes[1] * ratio / kalker[1]
            of_patch[2, q] = 1.5 * by_a - 0.5 * by_b - kalker_slopes[2] * ratio / kalker[2]
            of_patch[5, q] = by_zones.contacts[c, 3, q]
        for q in range(CHANGES):
            by_spin, by_along, by_across = of_patch[2, q], of_patch[0, q], of_patch[1, q]
            of_patch[3, q] = (by_patch[0, q] - xi * by_spin) / flexible.spin
            of_patch[3, q] -= (by_patch[0, q] - xi * by_along) / flexible.along
            of_patch[4, q] = (by_patch[1, q] - eta * by_spin) / flexible.spin
            of_patch[4, q] -= (by_patch[1, q] - eta * by_across) / flexible.across
        if mu > 0.0:
            for i in range(start, stop):
                bound = mu * PARABOLA * strips.scale[i] * strips.half[i] * top
                own = (creepage[i, 0], creepage[i, 1], creepage[i, 2])
                strip_increments(flexible, (xi, eta), own, strips.half[i], bound, increments[i])
            strip_slopes(increments[start:stop], bounds, resultants[start:stop], all_slopes[start:stop], lanes)
        for i in range(start, stop):
            half, width, by_own = strips.half[i], strips.width[i], by_creepage[i]
            normal = 0.5 * np.pi * strips.scale[i] * half * half * width
            for q in range(MOTIONS):
                by_force[2, q] = 0.5 * np.pi * by_strips.strips[i, 4, q] * weight + normal * of_patch[5, q]
            values = (0.0, 0.0, normal * weight, 0.0)
            if mu > 0.0:
                bound = mu * PARABOLA * strips.scale[i] * half * top
                scale, over, rigid = 1.5 * mu * top * normal, half / bound, half / (bound * flexible.spin)
                wx, wy, spin = creepage[i, 0], creepage[i, 1], creepage[i, 2]
                resultant, slopes = resultants[i], all_slopes[i]
                for q in range(MOTIONS):
                    by_strip[0, q] = by_strips.strips[i, 3, q] / half
                    by_strip[1, q] = by_strips.strips[i, 2, q] / width
                    by_strip[2, q] = 0.5 * np.pi * by_strips.strips[i, 4, q] / normal
                x, y, turn = scale * resultant[0], scale * resultant[1], scale * half * resultant[2]
                values = (x * weight, y * weight, normal * weight, turn * weight)
                size = weight * scale
                for q in range(CHANGES):
                    by_half, by_normal, by_3 = by_strip[0, q], by_strip[2, q], of_patch[2, q]
                    # the bound is in proportion to the normal force over length and width
                    shrink, grow = 2.0 * by_half + by_strip[1, q] - by_normal, weight * by_normal + of_patch[5, q]
                    less = shrink - by_3
                    ex, ey = rigid * (by_own[0, q] + wx * less), rigid * (by_own[1, q] + wy * less)
                    es = rigid * half * (by_own[2, q] + spin * (less + by_half))
                    dx = over * of_patch[3, q] + increments[i, 3] * shrink
                    dy = over * of_patch[4, q] + increments[i, 4] * shrink
                    for d in range(3):
                        changes[d] = slopes[d, 0] * ex + slopes[d, 1] * ey + slopes[d, 2] * es
                        changes[d] += slopes[d, 3] * dx + slopes[d, 4] * dy
                    by_force[0, q] = size * changes[0] + x * grow
                    by_force[1, q] = size * changes[1] + y * grow
                    by_force[3, q] = half * size * changes[2] + turn * (grow + weight * by_half)
            add_strip(middles.point[i], middles.axes[i], values, by_points[i], by_frames[i], by_force, tangent)
        start = stop


@borrowing
def add_strip(
    point: Array,
    axes: Array,
    resultant: tuple[float, float, float, float],
    by_point: Array,
    by_axes: Array,
    by_resultant: Array,
    tangent: Array,
) -> None:
    """Add a strip's derivative (6, 12) of force and moment about the rail's origin.

    Parameters:
        point, axes: (3,) m and (3, 3), of its middle.
        resultant: longitudinal and lateral force, pressing force N, and moment N m about the inward normal.
        by_point, by_axes, by_resultant: (3, 6), (3, 3, 6) and (4, 12).
        tangent: (6, 12), added to.
    """
    (x, y, p, turn), (px, py, pz) = resultant, (point[0], point[1], point[2])
    fx = x * axes[0, 0] + y * axes[1, 0] - p * axes[2, 0]
    fy = x * axes[0, 1] + y * axes[1, 1] - p * axes[2, 1]
    fz = x * axes[0, 2] + y * axes[1, 2] - p * axes[2, 2]
    for q in range(CHANGES):
        along, across, pressing, by_turn = (
            by_resultant[0, q],
            by_resultant[1, q],
            by_resultant[2, q],
            by_resultant[3, q],
        )
        cx = along * axes[0, 0] + across * axes[1, 0] - pressing * axes[2, 0]
        cy = along * axes[0, 1] + across * axes[1, 1] - pressing * axes[2, 1]
        cz = along * axes[0, 2] + across * axes[1, 2] - pressing * axes[2, 2]
        tangent[0, q] += cx
        tangent[1, q] += cy
        tangent[2, q] += cz
        tangent[3, q] += py * cz - pz * cy - by_turn * axes[2, 0]
        tangent[4, q] += pz * cx - px * cz - by_turn * axes[2, 1]
        tangent[5, q] += px * cy - py * cx - by_turn * axes[2, 2]
    for q in range(MOTIONS):
        cx = x * by_axes[0, 0, q] + y * by_axes[1, 0, q] - p * by_axes[2, 0, q]
        cy = x * by_axes[0, 1, q] + y * by_axes[1, 1, q] - p * by_axes[2, 1, q]
        cz = x * by_axes[0, 2, q] + y * by_axes[1, 2, q] - p * by_axes[2, 2, q]
        dx, dy, dz = by_point[0, q], by_point[1, q], by_point[2, q]
        tangent[0, q] += cx
        tangent[1, q] += cy
        tangent[2, q] += cz
        tangent[3, q] += dy * fz - dz * fy + py * cz - pz * cy - turn * by_axes[2, 0, q]
        tangent[4, q] += dz * fx - dx * fz + pz * cx - px * cz - turn * by_axes[2, 1, q]
        tangent[5, q] += dx * fy - dy * fx + px * cy - py * cx - turn * by_axes[2, 2, q]
