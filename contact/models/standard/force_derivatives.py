"""Derivative of the contact force of a wheel on a rail by pose and motion, in closed form.

Every strip has three resultants of its tractions, see `wheelrail.contact.models.standard.strip_resultant`, which depend
on its creepages and on the load and the shape of its patch. Derivatives are carried along in twelve directions, those
of `wheelrail.contact.results.result.ContactResult.tangent`.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
from wheelrail.contact.geometry.wheel_surface import Place
from wheelrail.contact.kinematics.rigid_velocities import RigidVelocities, creepages, rolling_speed
from wheelrail.contact.models.standard.creep_coefficients import PairElasticity, coefficients
from wheelrail.contact.models.standard.fastsim import foundation
from wheelrail.contact.models.standard.forces import StripFrames, half_ellipse_means
from wheelrail.contact.models.standard.normal import StripPressures
from wheelrail.contact.models.standard.pressure_derivatives import PressureDerivatives
from wheelrail.contact.models.standard.region_derivatives import MOTIONS, RegionDerivatives, rigid_motions
from wheelrail.contact.models.standard.strip_resultant import strip_resultant
from wheelrail.meshes.curves.closest_point import Shape, local, piece
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import unchecked

CHANGES = 12


@unchecked
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


@unchecked
def velocity_derivatives(
    v: RigidVelocities, reference: Array, point: Array, by_point: Array, relative: Array, flow: Array
) -> tuple[Place, Place]:
    """Velocity m/s of the wheel relative to the rail at a point, and mean velocity of both; their derivatives (3, 12)
    are filled.

    Parameters:
        v: rigid motion of both bodies; the wheel's reference point moves with its frame.
        reference: (3, 6), derivatives of that point.
        point, by_point: (3,) m and (3, 6).
        relative, flow: (3, 12), filled.
    """
    x, y, z = point[0] - v.wheel_at[0], point[1] - v.wheel_at[1], point[2] - v.wheel_at[2]
    wx, wy, wz = v.wheel_turn
    wheel = v.wheel[0] + wy * z - wz * y, v.wheel[1] + wz * x - wx * z, v.wheel[2] + wx * y - wy * x
    a, b, c = point[0] - v.rail_at[0], point[1] - v.rail_at[1], point[2] - v.rail_at[2]
    rx, ry, rz = v.rail_turn
    rail = v.rail[0] + ry * c - rz * b, v.rail[1] + rz * a - rx * c, v.rail[2] + rx * b - ry * a
    for q in range(MOTIONS):
        dx, dy, dz = by_point[0, q], by_point[1, q], by_point[2, q]
        ex, ey, ez = dx - reference[0, q], dy - reference[1, q], dz - reference[2, q]
        wheel_x, wheel_y, wheel_z = wy * ez - wz * ey, wz * ex - wx * ez, wx * ey - wy * ex
        rail_x, rail_y, rail_z = ry * dz - rz * dy, rz * dx - rx * dz, rx * dy - ry * dx
        relative[0, q], relative[1, q], relative[2, q] = wheel_x - rail_x, wheel_y - rail_y, wheel_z - rail_z
        flow[0, q], flow[1, q] = 0.5 * (wheel_x + rail_x), 0.5 * (wheel_y + rail_y)
        flow[2, q] = 0.5 * (wheel_z + rail_z)
    for k in range(3):
        for q in range(MOTIONS, CHANGES):
            relative[k, q] = 0.0
        relative[k, MOTIONS + k] = 1.0
    relative[0, 10], relative[0, 11] = z, -y
    relative[1, 11], relative[1, 9] = x, -z
    relative[2, 9], relative[2, 10] = y, -x
    for k in range(3):
        for q in range(MOTIONS, CHANGES):
            flow[k, q] = 0.5 * relative[k, q]
    return (
        (wheel[0] - rail[0], wheel[1] - rail[1], wheel[2] - rail[2]),
        (0.5 * (wheel[0] + rail[0]), 0.5 * (wheel[1] + rail[1]), 0.5 * (wheel[2] + rail[2])),
    )


@unchecked
def creepage_derivatives(
    v: RigidVelocities,
    velocity: Place,
    by_velocity: Array,
    axes: Array,
    by_axes: Array,
    speed: tuple[float, Array],
    creepage: tuple[float, float, float],
    columns: Array,
) -> None:
    """Fill derivatives (3, 12) of longitudinal and lateral creepage and of spin.

    Parameters:
        v: rigid motion of both bodies.
        velocity, by_velocity: m/s and (3, 12), of the wheel relative to the rail.
        axes, by_axes: (3, 3) and (3, 3, 6).
        speed: rolling speed m/s and its derivatives (12,).
        creepage: the values.
        columns: filled.
    """
    (V, by_V), (vx, vy, vz) = speed, velocity
    wx, wy, wz = v.wheel_turn[0] - v.rail_turn[0], v.wheel_turn[1] - v.rail_turn[1], v.wheel_turn[2] - v.rail_turn[2]
    for k in range(2):
        fx, fy, fz, value = axes[k, 0], axes[k, 1], axes[k, 2], creepage[k]
        for q in range(CHANGES):
            change = by_velocity[0, q] * fx + by_velocity[1, q] * fy + by_velocity[2, q] * fz
            columns[k, q] = (change - value * by_V[q]) / V
        for q in range(MOTIONS):
            columns[k, q] += (vx * by_axes[k, 0, q] + vy * by_axes[k, 1, q] + vz * by_axes[k, 2, q]) / V
    for q in range(CHANGES):
        columns[2, q] = -creepage[2] * by_V[q] / V
    for q in range(MOTIONS):
        columns[2, q] -= (wx * by_axes[2, 0, q] + wy * by_axes[2, 1, q] + wz * by_axes[2, 2, q]) / V
    for k in range(3):
        columns[2, 9 + k] -= axes[2, k] / V


@unchecked
def coefficient_slopes(table: Array, ratio: float) -> tuple[float, float, float]:
    """Derivatives of `wheelrail.contact.models.standard.creep_coefficients.coefficients` by the ratio of semi-axes."""
    side, shorter = (1 if ratio > 1.0 else 0), min(ratio, 1.0 / ratio)
    if shorter <= 0.1:
        return 0.0, 0.0, 0.0
    i = min(int(10.0 * shorter - 1.0), 8)
    slope = 10.0 * (-shorter * shorter if ratio > 1.0 else 1.0)
    low, high = table[side, i], table[side, i + 1]
    return slope * (high[0] - low[0]), slope * (high[1] - low[1]), slope * (high[2] - low[2])


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
    (origin, rotation), (middles, peaks) = pose, frames
    tangent, n = np.zeros((6, CHANGES)), len(strips.s)
    dome = half_ellipse_means(cells)[1]
    top = dome.max()
    bounds, resultant, slopes = dome / top, np.zeros(3), np.zeros((3, 3))
    by_point, by_axes, reference = np.empty((3, MOTIONS)), np.empty((3, 3, MOTIONS)), np.empty((3, MOTIONS))
    by_velocity, by_flow, by_speed = np.empty((3, CHANGES)), np.empty((3, CHANGES)), np.empty(CHANGES)
    by_patch, by_own, of_patch = np.empty((3, CHANGES)), np.empty((3, CHANGES)), np.zeros((7, CHANGES))
    by_strip, by_force, scratch = np.zeros((2, CHANGES)), np.zeros((4, CHANGES)), np.empty((4, 3))
    away = v.wheel_at - origin
    rigid_motions(away[0], away[1], away[2], False, reference)
    start = 0
    for c in range(len(zones.peak)):
        stop, volume = start, 0.0
        of_patch[:] = 0.0
        while stop < n and strips.contact[stop] == c:
            half, width = strips.half[stop], strips.width[stop]
            volume += 4.0 / 3.0 * half**3 * width
            for q in range(MOTIONS):
                by_width, by_half = by_strips.strips[stop, 2, q], by_strips.strips[stop, 3, q]
                of_patch[0, q] -= 4.0 / 3.0 * half * half * (3.0 * width * by_half + half * by_width)
            stop += 1
        point, axes, place = peaks.point[c], peaks.axes[c], (zones.peak[c], zones.peak_x[c])
        by_place = by_zones.contacts[c, :2]
        surface_derivatives(wheel, radius, origin, rotation, place, by_place, (point, axes), by_point, by_axes)
        velocity, flow = velocity_derivatives(v, reference, point, by_point, by_velocity, by_flow)
        speed = rolling_speed(v, point, axes[0])
        for q in range(CHANGES):
            by_speed[q] = -(by_flow[0, q] * axes[0, 0] + by_flow[1, q] * axes[0, 1] + by_flow[2, q] * axes[0, 2])
        for q in range(MOTIONS):
            by_speed[q] -= flow[0] * by_axes[0, 0, q] + flow[1] * by_axes[0, 1, q] + flow[2] * by_axes[0, 2, q]
        a, b, load, weight = strips.along[c], strips.across[c], strips.load[c], zones.weight[c]
        xi, eta, phi = creepages(v, point, axes, speed)
        creepage_derivatives(v, velocity, by_velocity, axes, by_axes, (speed, by_speed), (xi, eta, phi), by_patch)
        kalker, kalker_slopes = coefficients(elastic.table, a / b), coefficient_slopes(elastic.table, a / b)
        flexible = foundation(a, b, elastic.G, kalker)
        # logarithmic derivatives: of the bound but for the half length, of the three flexibilities; then the parts of
        # the increments' derivatives that are the same for all strips, and the derivative of the weight
        for q in range(MOTIONS):
            by_load, by_a = by_strips.patches[c, 0, q] / load, by_strips.patches[c, 1, q] / a
            by_b = by_strips.patches[c, 2, q] / b
            ratio = a / b * (by_a - by_b)
            of_patch[0, q] = by_load + of_patch[0, q] / volume
            of_patch[1, q] = by_a - kalker_slopes[0] * ratio / kalker[0]
            of_patch[2, q] = by_a - kalker_slopes[1] * ratio / kalker[1]
            of_patch[3, q] = 1.5 * by_a - 0.5 * by_b - kalker_slopes[2] * ratio / kalker[2]
            of_patch[6, q] = by_zones.contacts[c, 3, q]
        for q in range(CHANGES):
            of_patch[4, q] = (by_patch[0, q] - xi * of_patch[1, q]) / flexible.along - by_patch[0, q] / flexible.spin
            of_patch[5, q] = (by_patch[1, q] - eta * of_patch[2, q]) / flexible.across - by_patch[1, q] / flexible.spin
        for i in range(start, stop):
            half, width = strips.half[i], strips.width[i]
            point, axes, place = middles.point[i], middles.axes[i], (strips.s[i], strips.x[i])
            by_place = by_strips.strips[i, :2]
            surface_derivatives(wheel, radius, origin, rotation, place, by_place, (point, axes), by_point, by_axes)
            normal = 0.5 * np.pi * strips.scale[i] * half * half * width
            for q in range(MOTIONS):
                by_force[2, q] = 0.5 * np.pi * by_strips.strips[i, 4, q] * weight + normal * of_patch[6, q]
            values = (0.0, 0.0, normal * weight, 0.0)
            if mu > 0.0:
                bound = mu * load / volume * half * half * top
                scale = 2.0 * half * width * bound
                velocity, _ = velocity_derivatives(v, reference, point, by_point, by_velocity, by_flow)
                wx, wy, spin = creepages(v, point, axes, speed)
                creepage_derivatives(v, velocity, by_velocity, axes, by_axes, (speed, by_speed), (wx, wy, spin), by_own)
                gx = xi / flexible.along + (wx - xi) / flexible.spin
                gy = eta / flexible.across + (wy - eta) / flexible.spin
                gs = spin / flexible.spin
                normalised = (half * gx / bound, half * gy / bound, half * half * gs / bound)
                strip_resultant(normalised, bounds, resultant, slopes, scratch)
                for q in range(MOTIONS):
                    by_strip[0, q] = by_strips.strips[i, 3, q] / half
                    by_strip[1, q] = by_strips.strips[i, 2, q] / width
                x, y, turn = scale * resultant[0], scale * resultant[1], scale * half * resultant[2]
                values = (x * weight, y * weight, normal * weight, turn * weight)
                size = weight * scale
                for q in range(CHANGES):
                    by_half, by_width = by_strip[0, q], by_strip[1, q]
                    by_bound, by_3 = of_patch[0, q] + 2.0 * by_half, of_patch[3, q]
                    shrink, grow = by_half - by_bound, weight * (by_half + by_width + by_bound) + of_patch[6, q]
                    by_gx = of_patch[4, q] + (by_own[0, q] - (wx - xi) * by_3) / flexible.spin
                    by_gy = of_patch[5, q] + (by_own[1, q] - (wy - eta) * by_3) / flexible.spin
                    by_gs = (by_own[2, q] - spin * by_3) / flexible.spin
                    ex, ey = half / bound * (by_gx + gx * shrink), half / bound * (by_gy + gy * shrink)
                    es = half * half / bound * (by_gs + gs * (shrink + by_half))
                    by_force[0, q] = size * (slopes[0, 0] * ex + slopes[0, 1] * ey + slopes[0, 2] * es) + x * grow
                    by_force[1, q] = size * (slopes[1, 0] * ex + slopes[1, 1] * ey + slopes[1, 2] * es) + y * grow
                    by_turn = slopes[2, 0] * ex + slopes[2, 1] * ey + slopes[2, 2] * es
                    by_force[3, q] = half * size * by_turn + turn * (grow + weight * by_half)
            add_strip(point, axes, values, by_point, by_axes, by_force, tangent)
        start = stop
    return tangent


@unchecked
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
