"""Interpenetration regions by the method of virtual penetration: around every local maximum of the penetration.

J. Piotrowski, W. Kik, Vehicle System Dynamics 46 (2008) 27-48, doi:10.1080/00423110701586444. Maxima that approach
each other, or whose minimum between them vanishes, merge continuously into one contact, so that forces do not jump:
they share its weight, and the region of each extends over the others (`merging_weights`, `covered`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import roots_legendre

from wheelrail.contact.geometry.line_scan import Lines, inside, lines_to_scan, scan
from wheelrail.contact.geometry.quadric_pair import curvature, vertical_approach
from wheelrail.contact.geometry.rigid_search import Scan, level_crossing, local_maxima, lowest
from wheelrail.contact.geometry.surface_gap import SAMPLED, nearest_place
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.curves.closest_point import Shape, local, next_piece, piece
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, compiled, unchecked

VIRTUAL = 0.55  # penetration of the virtual bodies over that of the elastic ones, Piotrowski and Kik 2008
SEPARATION = 1.5  # times the merging distance: two maxima further apart are separate contacts
_GAUSS, _WEIGHTS = roots_legendre(8)
HALF = 0.5 * (_GAUSS + 1.0)
# positions and widths from 0 to 1 of the strips of half a region, denser at the maximum
POSITIONS = HALF * HALF
WIDTHS = HALF * _WEIGHTS
POWER = 4  # of heights: of two maxima, twice as high above the minimum between them, the higher has 94 % of the weight
LEAST_WEIGHT = 1e-4  # of a contact: lower ones have none
MIN_PENETRATION = 1e-15  # m: smallest penetration of a strip, for a length above zero
MIN_SLOPE_COSINE = 0.05  # cosine of the wheel's slope: lower bound for the radius along the rail

TOO_DEEP = "the wheel lies inside the rail, too deep for a contact"
UNSOLVED = "beyond the part of its surface that carries contact points"  # of an overlap


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


@borrowing
def fade_slope(t: float) -> float:
    """Derivative of `fade`."""
    return 6.0 * t * (1.0 - t) if 0.0 < t < 1.0 else 0.0


@borrowing
def saddle_between(low: Array, i: int, j: int) -> int:
    """Row of the lowest minimum (k - 1, 3) between two maxima."""
    lowest = min(i, j)
    for k in range(min(i, j), max(i, j)):
        if low[k, 1] < low[lowest, 1]:
            lowest = k
    return lowest


@borrowing
def apart(away: float, merge: float) -> tuple[float, float]:
    """How far two places at a distance m are separate contacts, 0 to 1, and its derivative by the distance."""
    t = (away / merge - 1.0) / (SEPARATION - 1.0)
    return fade(t), fade_slope(t) / (merge * (SEPARATION - 1.0))


@unchecked
def merging_weights(top: Array, low: Array, merge: float, by_top: Array, by_low: Array) -> tuple[Array, Array]:
    """Weight (k,) of each maximum as a contact, and its derivatives (k, q) by q parameters.

    Parameters:
        top, low: (k, 3), (k - 1, 3) maxima and minima between them: position, penetration, x, m.
        merge: m, maxima closer than that are one contact.
        by_top, by_low: (k, 3, q) and (k - 1, 3, q), their derivatives.

    Maxima are joined at the minima between them, from the highest minimum down. Two groups share one contact in the
    ratio of the `POWER` of their heights above the minimum that joins them, and their joint height above it is the norm
    of both with this power. A maximum that has just appeared on a slope has no height above its minimum: neither it nor
    any other weight jumps. Sums of powers do not depend on the order in which minima of the same height are taken. From
    a maximum's own view another one counts as far as its own region, down to (1 - VIRTUAL) of its height, extends over
    the minimum, or as both are close: as much of it as `covered` has in the region, so that no load is counted twice.
    """
    n, q = len(top), by_top.shape[2]
    if n <= 1:
        return np.ones(n), np.zeros((n, q))
    weight, by_weight, share, by_share = np.ones(n), np.zeros((n, q)), np.ones(n), np.zeros((n, q))
    whole, own, first, last = top[:, 1].copy(), top[:, 1].copy(), np.arange(n), np.arange(n)
    by_whole, by_own, part, by_part = by_top[:, 1].copy(), by_top[:, 1].copy(), np.zeros(n), np.zeros((n, q))
    done = np.zeros(n - 1, np.bool_)
    for _ in range(n - 1):
        k = -1
        for j in range(n - 1):
            if not done[j] and (k < 0 or low[j, 1] > low[k, 1]):
                k = j
        done[k] = True
        minimum, start, middle, stop = low[k, 1], first[k], k + 1, last[k + 1] + 1
        by_minimum = by_low[k, 1] if minimum > 0.0 else np.zeros(q)
        total, by_total = 0.0, np.zeros(q)
        for i in range(start, stop):  # powers of heights, by maxima
            height = max(whole[i] - minimum, 0.0)
            part[i] = share[i] * height**POWER
            by_part[i] = by_share[i] * height**POWER
            by_part[i] += share[i] * POWER * height ** (POWER - 1) * (by_whole[i] - by_minimum)
            total += part[i]
            by_total += by_part[i]
        for i in range(start, stop):
            before = max(own[i] - minimum, 0.0) ** POWER
            by_before = POWER * max(own[i] - minimum, 0.0) ** (POWER - 1) * (by_own[i] - by_minimum)
            after, by_after, height = before, by_before.copy(), top[i, 1]
            deep, deep_slope = (height - minimum) / (VIRTUAL * height), 0.0
            deep, deep_slope = fade(deep), fade_slope(deep)
            by_deep = deep_slope / VIRTUAL * (minimum * by_top[i, 1] / height - by_minimum) / height
            for j in range(middle if i < middle else start, stop if i < middle else middle):
                far, far_slope = apart(abs(top[i, 0] - top[j, 0]), merge)
                by_far = (far_slope if top[i, 0] > top[j, 0] else -far_slope) * (by_top[i, 0] - by_top[j, 0])
                counts = 1.0 - deep * far
                after += counts * part[j]
                by_after += counts * by_part[j] - (by_deep * far + deep * by_far) * part[j]
            if after > 0.0:
                by_weight[i] = by_weight[i] * (before / after)
                by_weight[i] += weight[i] * (by_before - before / after * by_after) / after
                weight[i] *= before / after
                root = after ** (1.0 / POWER)
                own[i], by_own[i] = minimum + root, by_minimum + root / (POWER * after) * by_after
        for i in range(start, stop):
            first[i], last[i] = start, stop - 1
            if total > 0.0:
                share[i], by_share[i] = part[i] / total, (by_part[i] - part[i] / total * by_total) / total
                root = total ** (1.0 / POWER)
                whole[i], by_whole[i] = minimum + root, by_minimum + root / (POWER * total) * by_total
    for i in range(n):
        kept = weight[i] > LEAST_WEIGHT
        weight[i] = (weight[i] - LEAST_WEIGHT) / (1.0 - LEAST_WEIGHT) if kept else 0.0
        by_weight[i] *= 1.0 / (1.0 - LEAST_WEIGHT) if kept else 0.0
    return weight, by_weight


@borrowing
def extends(top: Array, low: Array, k: int, j: int, merge: float) -> bool:
    """Whether the region of maximum k covers places around maximum j."""
    if j == k:
        return True
    level, nearest = (1.0 - VIRTUAL) * top[k, 1], low[j - 1 if j > k else j, 0]
    open_ = low[saddle_between(low, k, j), 1] > level or abs(nearest - top[k, 0]) < SEPARATION * merge
    return bool(top[j, 1] > level and open_)


@borrowing
def covered(virtual: float, valley: float, away: float, merge: float) -> tuple[float, float, float, float]:
    """Virtual penetration m that a place behind a minimum has in the region of another maximum, and its derivatives.

    Parameters:
        virtual: m, penetration of the virtual bodies there.
        valley: m, that at the lowest minimum on the way.
        away: m, distance from the maximum of the region.
        merge: m, places closer than that belong to the region.

    A place that is not higher than the minimum belongs to the region; the region ends where the minimum leaves it.
    """
    if virtual <= 0.0 or valley >= virtual:
        return virtual, 1.0, 0.0, 0.0
    t = valley / virtual
    far, far_slope = apart(away, merge)
    inside, slope = 1.0 - (1.0 - fade(t)) * far, fade_slope(t) * far
    return virtual * inside, inside - slope * t, slope, -virtual * (1.0 - fade(t)) * far_slope


class WheelRegions(NamedTuple):
    """Regions of a wheel on a rail, with what they consist of.

    Parameters:
        approach: m, largest penetration; without, minus the gap.
        beyond: whether the penetration reaches an end of the wheel's profile or of the rail's, is larger than that of
            all maxima, or the wheel lies inside the rail.
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
    beyond = first_beyond(samples, part) >= 0 or approach > (top[:, 1].max() if len(top) else 0.0) + SAMPLED
    if not (beyond or len(top)):
        beyond = inside(lines, samples, part, radius, origin, rotation)
        approach = min(nearest_place(wheel, rail, radius, origin, rotation, lines, part, samples)[1], 0.0)
    weight, _ = merging_weights(top, low, merge, np.zeros((len(top), 3, 0)), np.zeros((len(low), 3, 0)))
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
            if not extends(top, low, k, j, merge):
                continue
            middle, valley = top[j, 0], low[saddle_between(low, k, j), 1] - level if j != k else np.inf
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
                    strips[n, 2] = abs(edge - middle) * WIDTHS[q]
                    strips[n, 3] = max(covered(d - level, valley, abs(s - top[k, 0]), merge)[0], MIN_PENETRATION)
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
    if found.beyond:
        raise ValueError(overlap(wheel, rail, radius, pose, lines))
    if not len(found.contacts):
        return None, found.approach
    peak, peak_x, depth, weight = found.contacts.T
    s, x, width, penetration, radii = found.strips.T
    regions = PenetrationRegions(peak, peak_x, depth, weight, found.contact, s, x, width, penetration, radii)
    return regions, found.approach


def overlap(wheel: Profile, rail: Profile, radius: float, pose: Pose, lines: Lines) -> str:
    """Text on an overlap whose regions are beyond what is solved; parameters as for `profile_regions`."""
    rotation = np.ascontiguousarray(pose.rotation)
    part = lines_to_scan(lines, radius, pose.origin, rotation)
    samples = scan(rail.shape, lines, radius, pose.origin, rotation, part)
    i = first_beyond(samples, part)
    if i >= 0:
        profile = wheel if i in (0, len(lines.s) - 1) else rail
        return overlap_text(samples.depth[i], wheel.point(lines.s[i]), f"where profile {profile.name} ends")
    i = int(samples.depth.argmax())
    if samples.depth[i] > 0.0:
        return overlap_text(samples.depth[i], wheel.point(lines.s[i]), "where no contact point was found")
    return TOO_DEEP


def overlap_text(depth: float, place: Array, reason: str) -> str:
    """Text on an overlap that is not solved: its depth m, place (y, z) m on the wheel's profile, and the reason."""
    y, z = 1e3 * place
    at = f"at y = {y:.1f}, z = {z:.1f} mm of its profile"
    return f"the wheel overlaps the rail {1e3 * depth:.3g} mm deep {at}, {reason}"


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
