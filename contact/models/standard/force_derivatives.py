"""Derivative of the contact force of a wheel on a rail by pose and motion, in closed form.

Every strip has three resultants of its tractions, see `wheelrail.contact.models.standard.strip_resultant`, which depend
on its creepages and on the load and the shape of its patch. Derivatives are carried along in twelve directions, those
of `wheelrail.contact.results.result.ContactResult.tangent`.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.interpenetration import PenetrationRegions
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
from wheelrail.support.compiled import compiled

CHANGES = 12


@compiled
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
    """Fill derivatives (3, 12) of a point on the wheel and (3, 3, 12) of its axes.

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
    by_point[:], by_axes[:] = 0.0, 0.0
    turned = np.empty((3, MOTIONS))
    rigid_motions(point[0] - origin[0], point[1] - origin[1], point[2] - origin[2], False, by_point[:, :MOTIONS])
    for a in (0, 2):
        rigid_motions(axes[a, 0], axes[a, 1], axes[a, 2], True, turned)
        by_axes[a, :, :MOTIONS] = turned
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


@compiled
def velocity_derivatives(
    v: RigidVelocities, origin: Array, point: Array, by_point: Array, relative: Array, flow: Array
) -> tuple[Array, Array]:
    """Velocity (3,) m/s of the wheel relative to the rail at a point, and mean velocity (3,) of both; their derivatives
    (3, 12) are filled.

    Parameters:
        v: rigid motion of both bodies; the wheel's reference point moves with its frame.
        origin: (3,) m of the wheel's frame.
        point, by_point: (3,) m and (3, 12).
        relative, flow: (3, 12), filled.
    """
    reference = np.empty((3, MOTIONS))
    to_reference = v.wheel_at - origin
    rigid_motions(to_reference[0], to_reference[1], to_reference[2], False, reference)
    wheel, rail = np.empty(3), np.empty(3)
    relative[:], flow[:] = 0.0, 0.0
    for c in range(3):
        i, j = (c + 1) % 3, (c + 2) % 3
        turn_i, turn_j, rail_i, rail_j = v.wheel_turn[i], v.wheel_turn[j], v.rail_turn[i], v.rail_turn[j]
        wheel[c] = v.wheel[c] + turn_i * (point[j] - v.wheel_at[j]) - turn_j * (point[i] - v.wheel_at[i])
        rail[c] = v.rail[c] + rail_i * (point[j] - v.rail_at[j]) - rail_j * (point[i] - v.rail_at[i])
        for q in range(MOTIONS):
            by_wheel = turn_i * (by_point[j, q] - reference[j, q]) - turn_j * (by_point[i, q] - reference[i, q])
            by_rail = rail_i * by_point[j, q] - rail_j * by_point[i, q]
            relative[c, q], flow[c, q] = by_wheel - by_rail, 0.5 * (by_wheel + by_rail)
        relative[c, 6 + c] = 1.0
        relative[c, 9 + i], relative[c, 9 + j] = point[j] - v.wheel_at[j], -(point[i] - v.wheel_at[i])
        for q in range(MOTIONS, CHANGES):
            flow[c, q] = 0.5 * relative[c, q]
    return wheel - rail, 0.5 * (wheel + rail)


@compiled
def creepage_derivatives(
    v: RigidVelocities,
    velocity: Array,
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
        velocity, by_velocity: (3,) m/s and (3, 12), of the wheel relative to the rail.
        axes, by_axes: (3, 3) and (3, 3, 12).
        speed: rolling speed m/s and its derivatives (12,).
        creepage: the values.
        columns: filled.
    """
    V, by_V = speed
    for q in range(CHANGES):
        along, across, turn = 0.0, 0.0, 0.0
        for c in range(3):
            along += by_velocity[c, q] * axes[0, c] + velocity[c] * by_axes[0, c, q]
            across += by_velocity[c, q] * axes[1, c] + velocity[c] * by_axes[1, c, q]
            turn -= (v.wheel_turn[c] - v.rail_turn[c]) * by_axes[2, c, q]
        if q >= 9:
            turn -= axes[2, q - 9]
        columns[0, q] = (along - creepage[0] * by_V[q]) / V
        columns[1, q] = (across - creepage[1] * by_V[q]) / V
        columns[2, q] = (turn - creepage[2] * by_V[q]) / V


@compiled
def coefficient_slopes(table: Array, ratio: float) -> tuple[float, float, float]:
    """Derivatives of `wheelrail.contact.models.standard.creep_coefficients.coefficients` by the ratio of semi-axes."""
    side, shorter = (1 if ratio > 1.0 else 0), min(ratio, 1.0 / ratio)
    if shorter <= 0.1:
        return 0.0, 0.0, 0.0
    i = min(int(10.0 * shorter - 1.0), 8)
    slope = 10.0 * (-shorter * shorter if ratio > 1.0 else 1.0)
    low, high = table[side, i], table[side, i + 1]
    return slope * (high[0] - low[0]), slope * (high[1] - low[1]), slope * (high[2] - low[2])


@compiled
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
    bounds, resultant, slopes = dome / dome.max(), np.zeros(3), np.zeros((3, 3))
    by_point, by_axes = np.empty((3, CHANGES)), np.empty((3, 3, CHANGES))
    by_velocity, by_flow = np.empty((3, CHANGES)), np.empty((3, CHANGES))
    by_patch, by_own, by_place = np.empty((3, CHANGES)), np.empty((3, CHANGES)), np.empty((2, MOTIONS))
    by_speed, by_volume, by_size = np.zeros(CHANGES), np.zeros(CHANGES), np.zeros((3, CHANGES))
    by_strip, increments, by_force = np.zeros((4, CHANGES)), np.zeros((3, CHANGES)), np.zeros((4, CHANGES))
    start = 0
    for c in range(len(zones.peak)):
        stop, volume = start, 0.0
        by_volume[:] = 0.0
        while stop < n and strips.contact[stop] == c:
            half, width = strips.half[stop], strips.width[stop]
            volume += 4.0 / 3.0 * half**3 * width
            for q in range(MOTIONS):
                by_width, by_half = by_strips.strips[stop, 2, q], by_strips.strips[stop, 3, q]
                by_volume[q] += 4.0 / 3.0 * half * half * (3.0 * width * by_half + half * by_width)
            stop += 1
        by_place[:] = by_zones.contacts[c, :2]
        point, axes, place = peaks.point[c], peaks.axes[c], (zones.peak[c], zones.peak_x[c])
        surface_derivatives(wheel, radius, origin, rotation, place, by_place, (point, axes), by_point, by_axes)
        velocity, flow = velocity_derivatives(v, origin, point, by_point, by_velocity, by_flow)
        speed = rolling_speed(v, point, axes[0])
        for q in range(CHANGES):
            by_speed[q] = 0.0
            for d in range(3):
                by_speed[q] -= by_flow[d, q] * axes[0, d] + flow[d] * by_axes[0, d, q]
        a, b, load = strips.along[c], strips.across[c], strips.load[c]
        xi, eta, phi = creepages(v, point, axes, speed)
        creepage_derivatives(v, velocity, by_velocity, axes, by_axes, (speed, by_speed), (xi, eta, phi), by_patch)
        kalker, kalker_slopes = coefficients(elastic.table, a / b), coefficient_slopes(elastic.table, a / b)
        flexible = foundation(a, b, elastic.G, kalker)
        by_size[:, :MOTIONS] = by_strips.patches[c]
        for i in range(start, stop):
            half, width, weight = strips.half[i], strips.width[i], zones.weight[c]
            by_strip[:, :MOTIONS] = by_strips.strips[i, 1:]
            by_place[:] = by_strips.strips[i, :2]
            point, axes, place = middles.point[i], middles.axes[i], (strips.s[i], strips.x[i])
            surface_derivatives(wheel, radius, origin, rotation, place, by_place, (point, axes), by_point, by_axes)
            normal = 0.5 * np.pi * strips.scale[i] * half * half * width
            bound = mu * load / volume * half * half * dome.max()
            scale = 2.0 * half * width * bound
            if mu > 0.0:
                velocity, _ = velocity_derivatives(v, origin, point, by_point, by_velocity, by_flow)
                wx, wy, spin = creepages(v, point, axes, speed)
                creepage_derivatives(v, velocity, by_velocity, axes, by_axes, (speed, by_speed), (wx, wy, spin), by_own)
                gx = xi / flexible.along + (wx - xi) / flexible.spin
                gy = eta / flexible.across + (wy - eta) / flexible.spin
                gs = spin / flexible.spin
                normalised = (half * gx / bound, half * gy / bound, half * half * gs / bound)
                strip_resultant(normalised, bounds, resultant, slopes)
            for q in range(CHANGES):
                by_force[2, q] = 0.5 * np.pi * by_strip[3, q] * weight
                if q < MOTIONS:
                    by_force[2, q] += normal * by_zones.contacts[c, 3, q]
            if mu > 0.0:
                for q in range(CHANGES):
                    # logarithmic derivatives of load, semi-axes, half length, width, and of the largest bound
                    by_load, by_a, by_b = by_size[0, q] / load, by_size[1, q] / a, by_size[2, q] / b
                    by_half, by_width, by_weight = by_strip[2, q] / half, by_strip[1, q] / width, 0.0
                    if q < MOTIONS:
                        by_weight = by_zones.contacts[c, 3, q]
                    by_bound = by_load - by_volume[q] / volume + 2.0 * by_half
                    ratio = a / b * (by_a - by_b)
                    by_1 = by_a - kalker_slopes[0] * ratio / kalker[0]
                    by_2 = by_a - kalker_slopes[1] * ratio / kalker[1]
                    by_3 = 1.5 * by_a - 0.5 * by_b - kalker_slopes[2] * ratio / kalker[2]
                    by_gx = (by_patch[0, q] - xi * by_1) / flexible.along
                    by_gx += (by_own[0, q] - by_patch[0, q] - (wx - xi) * by_3) / flexible.spin
                    by_gy = (by_patch[1, q] - eta * by_2) / flexible.across
                    by_gy += (by_own[1, q] - by_patch[1, q] - (wy - eta) * by_3) / flexible.spin
                    by_gs = (by_own[2, q] - spin * by_3) / flexible.spin
                    shrink = by_half - by_bound
                    increments[0, q] = half / bound * (by_gx + gx * shrink)
                    increments[1, q] = half / bound * (by_gy + gy * shrink)
                    increments[2, q] = half * half / bound * (by_gs + gs * (shrink + by_half))
                    grow = weight * (by_half + by_width + by_bound) + by_weight
                    for d in range(3):
                        change = 0.0
                        for e in range(3):
                            change += slopes[d, e] * increments[e, q]
                        by_value = scale * (weight * change + resultant[d] * grow)
                        if d == 2:
                            by_value = half * (by_value + scale * weight * resultant[d] * by_half)
                        by_force[d if d < 2 else 3, q] = by_value
            values = (
                scale * weight * resultant[0],
                scale * weight * resultant[1],
                normal * weight,
                scale * weight * half * resultant[2],
            )
            add_strip(point, axes, values, by_point, by_axes, by_force, tangent)
        start = stop
    return tangent


@compiled
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
        by_point, by_axes, by_resultant: (3, 12), (3, 3, 12) and (4, 12).
        tangent: (6, 12), added to.
    """
    (x, y, p, turn), force, by_force = resultant, np.empty(3), np.empty(3)
    for d in range(3):
        force[d] = x * axes[0, d] + y * axes[1, d] - p * axes[2, d]
    for q in range(CHANGES):
        for d in range(3):
            by_force[d] = (
                by_resultant[0, q] * axes[0, d]
                + by_resultant[1, q] * axes[1, d]
                - by_resultant[2, q] * axes[2, d]
                + x * by_axes[0, d, q]
                + y * by_axes[1, d, q]
                - p * by_axes[2, d, q]
            )
            tangent[d, q] += by_force[d]
        for d in range(3):
            i, j = (d + 1) % 3, (d + 2) % 3
            tangent[3 + d, q] += (
                by_point[i, q] * force[j]
                - by_point[j, q] * force[i]
                + point[i] * by_force[j]
                - point[j] * by_force[i]
                - by_resultant[3, q] * axes[2, d]
                - turn * by_axes[2, d, q]
            )
