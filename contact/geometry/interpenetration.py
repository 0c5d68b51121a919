"""Where bodies touch by the method of virtual penetration: around every hump, what overlaps by more than a share of it.

J. Piotrowski, W. Kik, Vehicle System Dynamics 46 (2008) 27-48, doi:10.1080/00423110701586444. Two humps that come close
or lose the valley between them become one contact little by little, so that no force ever jumps: the lower one counts
for less, and the zone of the higher one reaches over it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import roots_legendre

from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.contact.geometry.rigid_search import HUMPS, Lines, crossing, deepest, humps, scan
from wheelrail.contact.kinematics.frames import Pose
from wheelrail.meshes.curves.closest_point import Shape, local, piece
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled

VIRTUAL = 0.55  # penetration of the virtual bodies over that of the elastic ones, Piotrowski and Kik 2008
APART = 1.5  # times the merging distance: two humps further apart are contacts of their own
_GAUSS, _WEIGHTS = roots_legendre(8)
HALF = 0.5 * (_GAUSS + 1.0)
# places and widths from 0 to 1 of half a zone's strips, closer together at the hump, where a strip sees itself
PLACES = HALF * HALF
WIDTHS = HALF * _WEIGHTS
LEAST = 1e-15  # m: overlap of a strip at the very edge, which still has a length
STEEPEST = 0.05  # cosine: where a wheel's surface is as steep as this it does not get flatter along the rail


class PenetrationRegions(NamedTuple):
    """Contacts (k,): place of the hump on the upper body's profile, m, and x there, m; overlap m; share that counts, 0
    to 1. Strips (n,) across, contact by contact: contact; place m, x m; width m; virtual overlap m; radius along x m.
    """

    peak: Array
    peak_x: Array
    depth: Array
    share: Array
    contact: Nodes
    s: Array
    x: Array
    width: Array
    overlap: Array
    radius: Array


@compiled
def fade(t: float) -> float:
    """From 0 to 1 without a kink, as t goes from 0 to 1."""
    t = min(max(t, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


@compiled
def shares(top: Array, low: Array, merge: float) -> tuple[Array, Array]:
    """Share (k,) of each hump that counts as a contact of its own, and (k, k) how much of another hump's basin belongs
    to its zone; merge m: humps closer than that are one contact.
    """
    n = len(top)
    own, reach = np.ones(n), np.eye(n)
    for i in range(n):
        for j in range(n):
            if i == j:
                continue
            mine, other = top[i, 1], top[j, 1]
            valley = low[min(i, j) : max(i, j), 1].min()
            lower = min(mine, other)
            apart = fade((abs(top[i, 0] - top[j, 0]) / merge - 1.0) / (APART - 1.0))
            single = fade((lower - valley) / (VIRTUAL * lower)) * apart
            # which is the higher one: undecided only within the depth of the valley
            above = (
                fade(0.5 + 0.5 * (other - mine) / (lower - valley))
                if lower > valley
                else (1.0 if other > mine else 0.0)
            )
            own[i] *= 1.0 - (1.0 - single) * above
            level = (1.0 - VIRTUAL) * mine
            if other > level:
                reach[i, j] = 1.0 - (1.0 - fade((valley - level) / (other - level))) * apart
    return own, reach


@compiled
def wheel_zones(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, lines: Lines, merge: float
) -> tuple[float, bool, Array, Nodes, Array]:
    """Largest overlap m and whether it leaves the lines; contacts (k, 4) and strips: contact (n,), values (n, 5)."""
    seen, places = scan(rail, lines, radius, origin, rotation), lines.s
    depth, where, sample = seen.depth, seen.x, seen.sample
    top, low, before, approach = humps(wheel, rail, radius, origin, rotation, places, seen)
    beyond = depth[0] > 0.0 or depth[-1] > 0.0
    own, reach = shares(top, low, merge)
    m = len(PLACES)
    contacts = np.empty((len(top), 4))
    contact, strips = np.empty(HUMPS * HUMPS * 2 * m, dtype=np.int64), np.empty((HUMPS * HUMPS * 2 * m, 5))
    count, n = 0, 0
    if beyond:
        return approach, beyond, contacts[:0], contact[:0], strips[:0]
    for k in range(len(top)):
        if own[k] <= 0.0:
            continue
        contacts[count, 0], contacts[count, 1], contacts[count, 2] = top[k, 0], top[k, 2], top[k, 1]
        contacts[count, 3] = own[k]
        level = (1.0 - VIRTUAL) * top[k, 1]
        for j in range(len(top)):
            if reach[k, j] <= 0.0:
                continue
            middle = top[j, 0]
            for way in (-1, 1):
                stop = places[0] if way < 0 else places[-1]
                if way < 0 and j > 0:
                    stop = low[j - 1, 0]
                if way > 0 and j < len(top) - 1:
                    stop = low[j, 0]
                i, inner = before[j] + (way > 0), middle
                while (places[i] - stop) * way < 0.0 and ((places[i] - middle) * way <= 0.0 or depth[i] >= level):
                    if (places[i] - middle) * way > 0.0:
                        inner = places[i]
                    i += way
                edge = stop
                outer = places[i] if (places[i] - stop) * way < 0.0 else stop
                d, _, _, _ = deepest(wheel, rail, radius, origin, rotation, outer, where[i], sample[i])
                if d < level:
                    edge = crossing(wheel, rail, radius, origin, rotation, inner, outer, level, where[i], sample[i])
                x, near = top[j, 2], sample[before[j]]
                for q in range(m):
                    s = middle + (edge - middle) * PLACES[q]
                    d, _, x, near = deepest(wheel, rail, radius, origin, rotation, s, x, near)
                    z, t, _ = local(wheel, s, piece(wheel, s))
                    contact[n], strips[n, 0], strips[n, 1] = count, s, x
                    strips[n, 2], strips[n, 3] = abs(edge - middle) * WIDTHS[q], max(reach[k, j] * (d - level), LEAST)
                    strips[n, 4] = (z.imag + radius) / max(t.real, STEEPEST)
                    n += 1
        count += 1
    return approach, beyond, contacts[:count], contact[:n], strips[:n]


def profile_zones(
    wheel: Profile, rail: Profile, radius: float, pose: Pose, lines: Lines, merge: float
) -> tuple[PenetrationRegions | None, float]:
    """Zones (None without overlap) of a wheel of nominal radius m on a rail, looked for at lines of its
    profile, and the largest overlap m. Raises ValueError for an overlap beyond the lines.
    """
    approach, beyond, contacts, contact, strips = wheel_zones(
        wheel.shape, rail.shape, radius, pose.origin, np.ascontiguousarray(pose.rotation), lines, merge
    )
    if beyond:
        raise ValueError("the wheel overlaps the rail beyond the part of its surface that touches rails")
    if not len(contacts):
        return None, approach
    peak, peak_x, depth, share = contacts.T
    place, x, width, overlap, radii = strips.T
    return PenetrationRegions(peak, peak_x, depth, share, contact, place, x, width, overlap, radii), approach


def quadric_zones(
    upper: tuple[float, float], lower: tuple[float, float], pose: Pose
) -> tuple[PenetrationRegions | None, float]:
    """The same of two bodies with principal radii [m] in x and y, see `wheelrail.contact.geometry.quadric_pair`."""
    above, below = curvature(upper), curvature(lower)
    x, y = pose.origin[:2] * above / (above + below)
    A, B = above + below
    approach = float(-pose.origin[2] - (pose.origin[:2] ** 2 * above * below / (above + below)).sum())
    if approach <= 0.0:
        return None, approach
    half = np.sqrt(VIRTUAL * approach / B)
    away = half * np.concatenate([-PLACES, PLACES])
    ones = np.ones_like(away)
    return PenetrationRegions(
        np.array([y]),
        np.array([x]),
        np.array([approach]),
        np.array([1.0]),
        np.zeros(len(away), dtype=np.int64),
        y + away,
        x * ones,
        half * np.concatenate([WIDTHS, WIDTHS]),
        VIRTUAL * approach - B * away**2,
        0.5 / A * ones,
    ), approach
