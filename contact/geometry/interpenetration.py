"""Interpenetration regions by the method of virtual penetration: around every local maximum of the penetration.

J. Piotrowski, W. Kik, Vehicle System Dynamics 46 (2008) 27-48, doi:10.1080/00423110701586444. Two maxima that approach
each other, or whose minimum between them vanishes, merge continuously into one contact, so that forces do not jump: the
weight of the lower one decreases, and the region of the higher one extends over it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import roots_legendre

from wheelrail.contact.geometry.line_scan import Lines, lines_to_scan, scan
from wheelrail.contact.geometry.quadric_pair import curvature, vertical_approach
from wheelrail.contact.geometry.rigid_search import Scan, level_crossing, local_maxima, lowest
from wheelrail.contact.geometry.surface_gap import nearest_place
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.curves.closest_point import Shape, local, next_piece, piece
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled

VIRTUAL = 0.55  # penetration of the virtual bodies over that of the elastic ones, Piotrowski and Kik 2008
SEPARATION = 1.5  # times the merging distance: two maxima further apart are separate contacts
_GAUSS, _WEIGHTS = roots_legendre(8)
HALF = 0.5 * (_GAUSS + 1.0)
# positions and widths from 0 to 1 of the strips of half a region, denser at the maximum
POSITIONS = HALF * HALF
WIDTHS = HALF * _WEIGHTS
MIN_PENETRATION = 1e-15  # m: smallest penetration of a strip, for a length above zero
MIN_SLOPE_COSINE = 0.05  # cosine of the wheel's slope: lower bound for the radius along the rail

UNSOLVED = "beyond the part of its surface that carries contact points"  # of an overlap
INSIDE = 1e-3  # m under the rail's surface along the vertical: of a wheel inside it, beyond errors of the samples


class PenetrationRegions(NamedTuple):
    """Contacts (k,) and strips (n,) across them, contact by contact.

    Parameters:
        peak: (k,) m, position of the maximum on the upper body's profile.
        peak_x: (k,) m, longitudinal position of the maximum.
        depth: (k,) m, penetration.
        weight: (k,), weight of the contact, 0 to 1.
        contact: (n,), contact of each strip.
        s, x: (n,) m, position on the upper body.
        width: (n,) m.
        penetration: (n,) m, of the virtual bodies.
        radius: (n,) m, along x.
    """

    peak: Array
    peak_x: Array
    depth: Array
    weight: Array
    contact: Nodes
    s: Array
    x: Array
    width: Array
    penetration: Array
    radius: Array


@borrowing
def fade(t: float) -> float:
    """Smooth step (continuously differentiable) from 0 to 1 for t from 0 to 1."""
    t = min(max(t, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@compiled
def merging_weights(top: Array, low: Array, merge: float) -> tuple[Array, Array]:
    """Weight (k,) of each maximum as a contact, and fraction (k, k) of another's basin that belongs to its region.

    Parameters:
        top, low: (k, 3), (k - 1, 3) maxima and minima between them: position, penetration, x, m.
        merge: m, maxima closer than that are one contact.
    """
    n = len(top)
    weight, reach = np.ones(n), np.eye(n)
    for i in range(n):
        for j in range(n):
            if i == j:
                continue
            height, other_height = top[i, 1], top[j, 1]
            minimum = low[min(i, j) : max(i, j), 1].min()
            lower = min(height, other_height)
            apart = fade((abs(top[i, 0] - top[j, 0]) / merge - 1.0) / (SEPARATION - 1.0))
            separate = fade((lower - minimum) / (VIRTUAL * lower)) * apart
            # which is higher, blended within the depth of the minimum
            dominated = (
                fade(0.5 + 0.5 * (other_height - height) / (lower - minimum))
                if lower > minimum
                else (1.0 if other_height > height else 0.0)
            )
            weight[i] *= 1.0 - (1.0 - separate) * dominated
            level = (1.0 - VIRTUAL) * height
            if other_height > level:
                reach[i, j] = 1.0 - (1.0 - fade((minimum - level) / (other_height - level))) * apart
    return weight, reach


class WheelRegions(NamedTuple):
    """Regions of a wheel on a rail, with what they consist of.

    Parameters:
        approach: m, largest penetration; without, minus the gap.
        beyond: whether the penetration reaches an end of the wheel's profile or of the rail's.
        top: (k, 3) m, maxima: position, penetration and x.
        low: (k - 1, 3) m, minima between them, likewise; with the penetration 0 where there is a gap.
        edges: (h,) m, outer ends of the halves of regions: for each maximum with a weight, those on both sides of each
            maximum in its reach.
        contacts: (c, 4) m, position, x, penetration, and weight.
        contact: (n,), contact of each strip; as many in each half.
        strips: (n, 5) m, position, x, width, penetration of the virtual bodies, and radius along x.
    """

    approach: float
    beyond: bool
    top: Array
    low: Array
    edges: Array
    contacts: Array
    contact: Nodes
    strips: Array


@compiled
def wheel_regions(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, lines: Lines, merge: float
) -> WheelRegions:
    """Regions of a wheel; parameters as for `profile_regions`, with the pose's origin (3,) m and rotation (3, 3)."""
    part = lines_to_scan(lines, radius, origin, rotation)
    positions, samples = lines.s, scan(rail, lines, radius, origin, rotation, part)
    top, low, before, approach = local_maxima(wheel, rail, radius, origin, rotation, positions, samples)
    depth, where, sample = samples.depth, samples.x, samples.sample
    beyond = first_beyond(samples, part) >= 0
    if not (beyond or len(top)):
        approach = nearest_place(wheel, rail, radius, origin, rotation, lines)[1]
    weight, reach = merging_weights(top, low, merge)
    m, most = len(POSITIONS), 2 * len(top) * len(top)
    contacts, edges = np.empty((len(top), 4)), np.empty(most)
    contact, strips = np.empty(most * m, dtype=np.int64), np.empty((most * m, 5))
    count, halves, n = 0, 0, 0
    if beyond:
        return WheelRegions(approach, beyond, top, low, edges[:0], contacts[:0], contact[:0], strips[:0])
    for k in range(len(top)):
        if weight[k] <= 0.0:
            continue
        contacts[count, 0], contacts[count, 1], contacts[count, 2] = top[k, 0], top[k, 2], top[k, 1]
        contacts[count, 3] = weight[k]
        level = (1.0 - VIRTUAL) * top[k, 1]
        for j in range(len(top)):
            if reach[k, j] <= 0.0:
                continue
            middle = top[j, 0]
            for direction in (-1, 1):
                stop = half_limit(positions, low, j, direction)
                i, inner = before[j] + (direction > 0), middle
                while (positions[i] - stop) * direction < 0.0 and (
                    (positions[i] - middle) * direction <= 0.0 or depth[i] >= level
                ):
                    if (positions[i] - middle) * direction > 0.0:
                        inner = positions[i]
                    i += direction
                outer = positions[i] if (positions[i] - stop) * direction < 0.0 else stop
                edge = level_crossing(wheel, rail, radius, origin, rotation, inner, outer, level, where[i], sample[i])
                edges[halves] = edge
                halves += 1
                x, near, at = top[j, 2], sample[before[j]], piece(wheel, middle)
                for q in range(m):
                    s = middle + (edge - middle) * POSITIONS[q]
                    at = next_piece(wheel, s, at)
                    z, t, _ = local(wheel, s, at)
                    d, _, x, near = lowest(rail, radius, origin, rotation, z, t, x, near)
                    contact[n], strips[n, 0], strips[n, 1] = count, s, x
                    strips[n, 2], strips[n, 3] = (
                        abs(edge - middle) * WIDTHS[q],
                        max(reach[k, j] * (d - level), MIN_PENETRATION),
                    )
                    strips[n, 4] = (z.imag + radius) / max(t.real, MIN_SLOPE_COSINE)
                    n += 1
        count += 1
    return WheelRegions(approach, beyond, top, low, edges[:halves], contacts[:count], contact[:n], strips[:n])


@borrowing
def first_beyond(samples: Scan, part: tuple[int, int]) -> int:
    """First line of a scan at which the penetration reaches an end of the wheel's profile, or of the rail's; -1
    without.

    Parameters:
        samples: the scan.
        part: the first of its lines, and one past the last.
    """
    depth, sample = samples.depth, samples.sample
    for i in range(part[0], part[1]):
        if depth[i] > 0.0:
            if i == 0 or i == len(depth) - 1:
                return i
            before, after = i - 1, i + 1
            if before >= part[0] and sample[before] < 0 and 2.0 * depth[i] > depth[after]:
                return i
            if after < part[1] and sample[after] < 0 and 2.0 * depth[i] > depth[before]:
                return i
    return -1


@borrowing
def half_limit(positions: Array, low: Array, j: int, direction: int) -> float:
    """Position m up to which the half of a region around maximum j may extend, in direction -1 or 1: the minimum before
    the next maximum, or the end of the lines.
    """
    if direction < 0:
        return float(low[j - 1, 0] if j > 0 else positions[0])
    return float(low[j, 0] if j < len(low) else positions[-1])


def profile_regions(
    wheel: Profile, rail: Profile, radius: float, pose: Pose, lines: Lines, merge: float
) -> tuple[PenetrationRegions | None, float]:
    """Regions (None without penetration) of a wheel on a rail, and the largest penetration m.

    Parameters:
        wheel, rail: profiles.
        radius: nominal rolling radius, m.
        pose: of the wheel's frame in the rail's frame.
        lines: of the wheel's profile on which the penetration is sampled.
        merge: m, maxima closer than that are one contact.

    Raises ValueError for a penetration that reaches an end of a profile, and for a wheel inside the rail.
    """
    found = wheel_regions(
        wheel.shape, rail.shape, radius, pose.origin, np.ascontiguousarray(pose.rotation), lines, merge
    )
    if found.beyond or not len(found.contacts):
        check_outside(wheel, rail, radius, pose, lines)
        return None, found.approach
    peak, peak_x, depth, weight = found.contacts.T
    s, x, width, penetration, radii = found.strips.T
    regions = PenetrationRegions(peak, peak_x, depth, weight, found.contact, s, x, width, penetration, radii)
    return regions, found.approach


def check_outside(wheel: Profile, rail: Profile, radius: float, pose: Pose, lines: Lines) -> None:
    """Raises ValueError for a wheel without contacts that lies inside the rail or overlaps it at an end of a profile.

    Parameters as for `profile_regions`.
    """
    rotation = np.ascontiguousarray(pose.rotation)
    part = lines_to_scan(lines, radius, pose.origin, rotation)
    samples = scan(rail.shape, lines, radius, pose.origin, rotation, part)
    i = first_beyond(samples, part)
    if i >= 0:
        profile = wheel if i in (0, len(lines.s) - 1) else rail
        raise ValueError(overlap_text(samples.depth[i], wheel.point(lines.s[i]), f"where profile {profile.name} ends"))
    if _inside(rail, radius, pose, lines):
        raise ValueError("the wheel lies inside the rail, too deep for a contact")


def overlap_text(depth: float, place: Array, reason: str) -> str:
    """Text on an overlap that is not solved: its depth m, place (y, z) m on the wheel's profile, and the reason."""
    y, z = 1e3 * place
    at = f"at y = {y:.1f}, z = {z:.1f} mm of its profile"
    return f"the wheel overlaps the rail {1e3 * depth:.3g} mm deep {at}, {reason}"


def _inside(rail: Profile, radius: float, pose: Pose, lines: Lines) -> bool:
    """Whether a part of the wheel below its axle lies under the rail's surface, parameters as for `profile_regions`."""
    points, r = lines.point, lines.point.imag + radius
    y, z = (pose.origin[k] + pose.rotation[k, 1] * points.real - pose.rotation[k, 2] * r for k in (1, 2))
    surface = rail.shape.sampled[np.argsort(rail.shape.sampled.real)]
    over = (y > surface.real[0]) & (y < surface.real[-1])
    return bool((z[over] < np.interp(y[over], surface.real, surface.imag) - INSIDE).any())


def quadric_regions(
    upper: tuple[float, float], lower: tuple[float, float], pose: Pose
) -> tuple[PenetrationRegions | None, float]:
    """Region (None without penetration) of two quadrics, and the approach m.

    Parameters:
        upper, lower: principal radii in x and y, m, see `wheelrail.contact.geometry.quadric_pair`.
        pose: of the upper body's apex.
    """
    above, below = curvature(upper), curvature(lower)
    x, y = pose.origin[:2] * above / (above + below)
    A, B = above + below
    approach = vertical_approach(upper, lower, pose)
    if approach <= 0.0:
        return None, approach
    half = np.sqrt(VIRTUAL * approach / B)
    offset = half * np.concatenate([-POSITIONS, POSITIONS])
    ones = np.ones_like(offset)
    return PenetrationRegions(
        np.array([y]),
        np.array([x]),
        np.array([approach]),
        np.array([1.0]),
        np.zeros(len(offset), dtype=np.int64),
        y + offset,
        x * ones,
        half * np.concatenate([WIDTHS, WIDTHS]),
        VIRTUAL * approach - B * offset**2,
        0.5 / A * ones,
    ), approach
