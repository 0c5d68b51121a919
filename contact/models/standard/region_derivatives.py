"""Derivatives of the interpenetration regions of a wheel on a rail by the wheel's pose, in closed form.

The penetration is minus the height h of a point p of the wheel above the rail. Its derivatives by two variables a, b,
the place on the wheel and its pose, are -n.p_ab - c (t.p_a)(t.p_b) with the rail's normal n and tangent t at the
closest point and c = k / (1 + k h), k the rail's curvature. Maxima, ends and lowest points are defined by equations;
their derivatives follow from those of the equations (implicit functions).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.interpenetration import (
    MIN_PENETRATION,
    MIN_SLOPE_COSINE,
    POSITIONS,
    VIRTUAL,
    WIDTHS,
    WheelRegions,
    covered,
    extends,
    half_limit,
    merging_weights,
    saddle_between,
)
from wheelrail.contact.geometry.rigid_search import deepest
from wheelrail.contact.geometry.wheel_surface import Place
from wheelrail.meshes.curves.closest_point import Shape, foot, local, nearer_sample, nearest_sample, piece
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, unchecked

MOTIONS = 6  # of a rigid body: translations along the axes of the rail, rotations about them


class RegionDerivatives(NamedTuple):
    """Derivatives by the six rigid motions of the wheel about its origin, of the columns of `WheelRegions`.

    Parameters:
        contacts: (c, 4, 6).
        strips: (n, 5, 6).
    """

    contacts: Array
    strips: Array


@borrowing
def rigid_motions(x: float, y: float, z: float, turns_only: bool, columns: Array) -> None:
    """Fill the derivatives (3, 6) of a vector by rigid motions: a distance from the origin, or a direction, which
    turns only.
    """
    columns[:] = 0.0
    if not turns_only:
        columns[0, 0] = columns[1, 1] = columns[2, 2] = 1.0
    columns[1, 3], columns[2, 3] = -z, y
    columns[0, 4], columns[2, 4] = z, -x
    columns[0, 5], columns[1, 5] = -y, x


@borrowing
def turned(rotation: Array, a: float, b: float, c: float) -> Place:
    """Vector of the wheel's axes in those of the rail."""
    return (
        rotation[0, 0] * a + rotation[0, 1] * b + rotation[0, 2] * c,
        rotation[1, 0] * a + rotation[1, 1] * b + rotation[1, 2] * c,
        rotation[2, 0] * a + rotation[2, 1] * b + rotation[2, 2] * c,
    )


@borrowing
def along_direction(vector: Place, y: float, z: float) -> tuple[float, float, float, float]:
    """Component of a vector along a direction (0, y, z), and its derivatives by the three rotations."""
    a, b, c = vector
    return y * b + z * c, z * b - y * c, -z * a, y * a


@borrowing
def at_line(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    s: float,
    x: float,
    sample: int,
    rows: Array,
) -> tuple[int, float]:
    """Fill derivatives of the penetration, its slope, and x at the lowest point of a line; the rail's nearest sample,
    and the penetration m.

    Parameters:
        wheel, rail: shapes of the profiles.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        s, x: m, the line, and its lowest point.
        sample: initial guess of the nearest sample, negative without.
        rows: (3, 7) filled; columns: by s, and by the six rigid motions.
    """
    z, t, k = local(wheel, s, piece(wheel, s))
    r, sine, cosine = z.imag + radius, np.sin(x / radius), np.cos(x / radius)
    point = turned(rotation, r * sine, z.real, -r * cosine)
    tangent = turned(rotation, t.imag * sine, t.real, -t.imag * cosine)
    bow = turned(rotation, k.imag * sine, k.real, -k.imag * cosine)
    forward = turned(rotation, r * cosine / radius, 0.0, r * sine / radius)
    both = turned(rotation, t.imag * cosine / radius, 0.0, t.imag * sine / radius)
    inward = turned(rotation, -r * sine / radius**2, 0.0, r * cosine / radius**2)
    q = complex(origin[1] + point[1], origin[2] + point[2])
    sample = nearest_sample(rail, q) if sample < 0 else nearer_sample(rail, q, sample)
    at, height, _ = foot(rail, q, rail.samples[sample])
    _, along, change = local(rail, at, piece(rail, at))
    ty, tz = along.real, along.imag
    curvature = change.real * tz - change.imag * ty
    bend = curvature / (1.0 + curvature * height)
    # along the rail's tangent and its inward normal (0, tz, -ty)
    by_s, by_x = ty * tangent[1] + tz * tangent[2], ty * forward[1] + tz * forward[2]
    own, down = along_direction(point, ty, tz), along_direction(point, tz, -ty)
    first, by_forward = along_direction(tangent, tz, -ty), along_direction(forward, tz, -ty)
    ss = tz * bow[1] - ty * bow[2] - bend * by_s * by_s
    sx = tz * both[1] - ty * both[2] - bend * by_s * by_x
    xx = tz * inward[1] - ty * inward[2] - bend * by_x * by_x
    rows[0, 0], rows[1, 0], rows[2, 0] = first[0], ss - sx * sx / xx, -sx / xx
    rows[0, 1], rows[0, 2], rows[0, 3] = 0.0, tz, -ty
    rows[1, 1], rows[1, 2], rows[1, 3] = 0.0, -bend * by_s * ty, -bend * by_s * tz
    rows[2, 1], rows[2, 2], rows[2, 3] = 0.0, -bend * by_x * ty, -bend * by_x * tz
    for i in range(1, 4):
        rows[0, 3 + i] = down[i]
        rows[1, 3 + i] = first[i] - bend * by_s * own[i]
        rows[2, 3 + i] = by_forward[i] - bend * by_x * own[i]
    for i in range(1, 1 + MOTIONS):
        rows[2, i] /= -xx
        rows[1, i] += sx * rows[2, i]
    return sample, -height


@borrowing
def stationary_derivatives(rows: Array, columns: Array) -> None:
    """Fill derivatives (3, 6) of position, penetration and x of a maximum or minimum from those (3, 7) at its line."""
    for i in range(MOTIONS):
        moved = -rows[1, 1 + i] / rows[1, 0]
        columns[0, i], columns[1, i] = moved, rows[0, 1 + i]
        columns[2, i] = rows[2, 1 + i] + rows[2, 0] * moved


@unchecked
def region_derivatives(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    lines: Array,
    merge: float,
    regions: WheelRegions,
) -> RegionDerivatives:
    """Derivatives of the regions of a wheel.

    Parameters:
        wheel, rail: shapes of the profiles.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        lines: (m,) m, on which the penetration was sampled.
        merge: m, maxima closer than that are one contact.
        regions: at this pose, not beyond the lines.
    """
    top, low, strips = regions.top, regions.low, regions.strips
    count, m = len(top), len(POSITIONS)
    by_top, by_low = np.zeros((count, 3, MOTIONS)), np.zeros((max(count - 1, 0), 3, MOTIONS))
    rows = np.empty((3, 1 + MOTIONS))
    near = -1
    for k in range(count):
        near, _ = at_line(wheel, rail, radius, origin, rotation, top[k, 0], top[k, 2], near, rows)
        stationary_derivatives(rows, by_top[k])
    for k in range(count - 1):
        if low[k, 1] > 0.0:
            near, _ = at_line(wheel, rail, radius, origin, rotation, low[k, 0], low[k, 2], near, rows)
            stationary_derivatives(rows, by_low[k])
    weight, by_weight = merging_weights(top, low, merge, by_top, by_low)
    by_contacts, by_strips = np.empty((len(regions.contacts), 4, MOTIONS)), np.empty((len(strips), 5, MOTIONS))
    by_edge = np.empty(MOTIONS)
    contact, half = 0, 0
    for k in range(count):
        if weight[k] <= 0.0:
            continue
        for c in range(MOTIONS):
            by_contacts[contact, 0, c], by_contacts[contact, 1, c] = by_top[k, 0, c], by_top[k, 2, c]
            by_contacts[contact, 2, c], by_contacts[contact, 3, c] = by_top[k, 1, c], by_weight[k, c]
        for j in range(count):
            if not extends(top, low, k, j, merge):
                continue
            level, saddle, valley = (1.0 - VIRTUAL) * top[k, 1], 0, np.inf
            if j != k:
                saddle = saddle_between(low, k, j)
                valley = low[saddle, 1] - level
            for direction in (-1, 1):
                edge = regions.edges[half]
                by_edge[:] = 0.0
                if edge != half_limit(lines, low, j, direction):  # where the penetration equals the level
                    x = strips[half * m + m - 1, 1]  # of the outermost strip
                    _, _, x, near = deepest(wheel, rail, radius, origin, rotation, edge, x, near)
                    near, _ = at_line(wheel, rail, radius, origin, rotation, edge, x, near, rows)
                    for c in range(MOTIONS):
                        by_edge[c] = ((1.0 - VIRTUAL) * by_top[k, 1, c] - rows[0, 1 + c]) / rows[0, 0]
                elif 0 <= j + min(direction, 0) < count - 1:
                    by_edge[:] = by_low[j + min(direction, 0), 0]
                for q in range(m):
                    i = half * m + q
                    s, x = strips[i, 0], strips[i, 1]
                    near, depth = at_line(wheel, rail, radius, origin, rotation, s, x, near, rows)
                    z, t, change = local(wheel, s, piece(wheel, s))
                    away = s - top[k, 0]
                    of_region = covered(depth - level, valley, abs(away), merge)
                    if of_region[0] <= MIN_PENETRATION:
                        of_region = (0.0, 0.0, 0.0, 0.0)
                    for c in range(MOTIONS):
                        by_half = by_edge[c] - by_top[j, 0, c]
                        moved = by_top[j, 0, c] + by_half * POSITIONS[q]
                        by_strips[i, 0, c], by_strips[i, 1, c] = moved, rows[2, 1 + c] + rows[2, 0] * moved
                        by_strips[i, 2, c] = direction * by_half * WIDTHS[q]
                        by_level = (1.0 - VIRTUAL) * by_top[k, 1, c]
                        by_depth = rows[0, 1 + c] + rows[0, 0] * moved - by_level
                        by_strips[i, 3, c] = of_region[1] * by_depth
                        if of_region[2] != 0.0:
                            by_strips[i, 3, c] += of_region[2] * (by_low[saddle, 1, c] - by_level)
                        if of_region[3] != 0.0:
                            by_strips[i, 3, c] += of_region[3] * np.sign(away) * (moved - by_top[k, 0, c])
                        by_strips[i, 4, c] = t.imag / max(t.real, MIN_SLOPE_COSINE) * moved
                        if t.real > MIN_SLOPE_COSINE:
                            by_strips[i, 4, c] -= (z.imag + radius) * change.real / t.real**2 * moved
                half += 1
        contact += 1
    return RegionDerivatives(by_contacts, by_strips)
