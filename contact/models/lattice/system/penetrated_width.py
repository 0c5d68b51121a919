"""Compiled: width of the undeformed penetration by the exact profiles, in strips of a lattice, for its resolution.

With the largest penetration d along x on every line, t the number of strips across, and m(t, t') the least d between
two lines, 0 where it is negative, the width is

    n = 1.2 int int max(d, d') m dt dt' / int d^2 dt

over all d > 0. On one maximum the numerator is (int d dt)^2, and n the width of a parabola; of several regions n is the
mean, weighted by int d^2 dt, and of two that merge it grows with the saddle between them: a continuous function of the
pose. Of finite bodies d is the penetration less their bulk displacement, which is none of the contact: its lift, linear
between some lines.
"""

from __future__ import annotations

import numpy as np
from scipy.special import roots_legendre

from wheelrail.contact.models.lattice.influence.bulk import (
    BulkCompliance,
    bulk_displacements,
    bulk_known,
    bulk_places,
)
from wheelrail.contact.models.lattice.influence.pair_tables import Lattice
from wheelrail.contact.models.lattice.system.contact_lines import ContactLines
from wheelrail.contact.models.lattice.system.equations import EquationData, strip_loads
from wheelrail.contact.models.lattice.system.surface import SurfaceData, crests, penetration_changes
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import borrowing, compiled

SAMPLES = 4  # in a strip, between which maxima of the penetration are sought
ROOT_STEPS, ROOT_ERROR = 60, 1e-12  # m
PARABOLAS = 4  # to an extremum, each over a tenth of the last one's width
OF_PARABOLA = 1.2  # width over (integral)^2 / (integral of the square)
NODES, WEIGHTS = (np.ascontiguousarray(part) for part in roots_legendre(16))
SHIFT = 1e-8  # m, of lines to both sides, for slopes along the profile


@borrowing
def strips_across(depth: Array, slenderness: Array) -> float:
    """Number of strips across, counted by their slenderness (K,), by their mean penetrations (K,) m, for contacts that
    are wide: that of a parabola of more than three strips is at most 3 % too large. Saddles are taken to lie lower than
    the means.
    """
    K = len(depth)
    double, square = 0.0, 0.0
    for i in range(K):
        if not depth[i] > 0.0:
            continue
        own = 1.0 / slenderness[i]
        square += own * depth[i] * depth[i]
        double += (own * depth[i]) ** 2
        least = depth[i]
        for j in range(i + 1, K):
            if not depth[j] > 0.0:
                break
            double += 2.0 * own / slenderness[j] * max(depth[i], depth[j]) * min(least, depth[j])
            if j < K - 1 and depth[j] <= depth[j - 1] and depth[j] <= depth[j + 1]:
                least = min(least, max(depth[j] - 0.25 * (depth[j - 1] - 2.0 * depth[j] + depth[j + 1]), 0.0))
    return OF_PARABOLA * double / square if square > 0.0 else 0.0


@compiled
def strips_beside_bulk(
    values: Array,
    data: EquationData,
    lines: ContactLines,
    lattice: Lattice,
    slenderness: Array,
    bodies: tuple[BulkCompliance, ...],
) -> tuple[bool, float]:
    """`strips_across` of the penetration less the displacement of finite bodies by the loads of a state, and whether
    their compliance is known there.

    Parameters:
        values, data: (S, block) of the loaded strips, and data of their equations.
        lines, lattice, slenderness: of all strips.
        bodies: finite ones.
    """
    loads, loaded = strip_loads(values, data.places, data.basis, data.motion.speed > 0.0), data.places.strip
    depth, inside = lines.depth.copy(), np.flatnonzero(lines.depth > 0.0)
    wide, own = lattice.width[inside], data.places.width
    for body in bodies:
        places = bulk_places(body, lattice.middle[inside], wide, lines.foot[inside])
        under = bulk_places(body, data.places.middle, own, lines.foot[loaded])
        if not bulk_known(body, (places, wide), (under, own)):
            return False, 0.0
        depth[inside] -= bulk_displacements(body.arc, body.values, places, under, own, loads)
    return True, strips_across(depth, slenderness)


@compiled
def _depth(surface: SurfaceData, origin: Array, rotation: Array, lift: Array, s: float) -> float:
    """Largest penetration m along x on the line s m, less the lift."""
    return float(crests(surface, origin, rotation, np.array([s]))[0].depth[0] - np.interp(s, lift[0], lift[1]))


@compiled
def _edge(surface: SurfaceData, origin: Array, rotation: Array, lift: Array, inside: float, outside: float) -> float:
    """Bound m of a region of penetration between a line in it and one beside it, by the Illinois method."""
    f, g = _depth(surface, origin, rotation, lift, inside), _depth(surface, origin, rotation, lift, outside)
    kept = 0
    for _ in range(ROOT_STEPS):
        if abs(outside - inside) < ROOT_ERROR or g == 0.0:
            break
        s = 0.5 * (inside + outside) if not np.isfinite(g) else inside + (outside - inside) * f / (f - g)
        h = _depth(surface, origin, rotation, lift, s)
        if abs(h) < ROOT_ERROR * ROOT_ERROR:
            return s
        if h > 0.0:
            inside, f = s, h
            if kept == 1:
                g *= 0.5
            kept = 1
        else:
            outside, g = s, h
            if kept == -1:
                f *= 0.5
            kept = -1
    return inside


@compiled
def _extremum(
    surface: SurfaceData, origin: Array, rotation: Array, lift: Array, s: float, span: float, sign: float
) -> float:
    """Place m of a maximum (sign 1) or minimum (-1) of the penetration near a line s m, by parabolas over a span m."""
    for _ in range(PARABOLAS):
        before = sign * _depth(surface, origin, rotation, lift, s - span)
        at = sign * _depth(surface, origin, rotation, lift, s)
        after = sign * _depth(surface, origin, rotation, lift, s + span)
        bend = before - 2.0 * at + after
        if not (bend < 0.0 and np.isfinite(bend)):
            break
        s += span * min(max(0.5 * (before - after) / bend, -1.0), 1.0)
        span *= 0.1
    return s


@compiled
def _add_maxima(
    surface: SurfaceData,
    origin: Array,
    rotation: Array,
    lift: Array,
    s: Array,
    found: list[tuple[float, float, bool]],
) -> None:
    """Append the pieces of penetration with one maximum between lines s (n,) m: bounds m, and whether a piece continues
    the last one across a saddle.
    """
    d = crests(surface, origin, rotation, s)[0].depth - np.interp(s, lift[0], lift[1])
    n, k = len(s), 0
    while k < n:
        if d[k] > 0.0:
            low, continues = s[k], False
            if k > 0:
                low = _edge(surface, origin, rotation, lift, s[k], s[k - 1])
            while k + 1 < n and d[k + 1] > 0.0:
                k += 1
                if k + 1 < n and d[k] <= d[k - 1] and d[k] < d[k + 1]:
                    saddle = _extremum(surface, origin, rotation, lift, s[k], 0.5 * (s[k + 1] - s[k - 1]), -1.0)
                    if low < saddle < s[k + 1] and _depth(surface, origin, rotation, lift, saddle) > 0.0:
                        found.append((low, saddle, continues))
                        low, continues = saddle, True
                    elif low < saddle < s[k + 1]:
                        found.append((low, _edge(surface, origin, rotation, lift, s[k - 1], saddle), continues))
                        low, continues = _edge(surface, origin, rotation, lift, s[k + 1], saddle), False
            high = s[k]
            if k < n - 1:
                high = _edge(surface, origin, rotation, lift, s[k], s[k + 1])
            found.append((low, high, continues))
        elif 0 < k < n - 1 and d[k] >= d[k - 1] and d[k] > d[k + 1]:
            top = _extremum(surface, origin, rotation, lift, s[k], 0.5 * (s[k + 1] - s[k - 1]), 1.0)
            if s[k - 1] < top < s[k + 1] and _depth(surface, origin, rotation, lift, top) > 0.0:
                low = _edge(surface, origin, rotation, lift, top, s[k - 1])
                found.append((low, _edge(surface, origin, rotation, lift, top, s[k + 1]), False))
        k += 1


@compiled
def maxima(
    surface: SurfaceData, origin: Array, rotation: Array, lift: Array, middle: Array, width: Array, depth: Array
) -> tuple[Array, Mask]:
    """Pieces of the undeformed penetration with one maximum each, in order: their bounds (P, 2) m, and whether they
    continue the last one across a saddle (P,).

    Parameters:
        surface: of both bodies.
        origin, rotation: of the upper one.
        lift: (2, R) m, places of lines, and by how much the penetration is less there.
        middle, width, depth: (K,) m, of the strips: where they lie, and their mean penetration less the lift.
    """
    K = len(middle)
    sought = np.zeros(K, dtype=np.bool_)
    for k in range(K):
        before, after = depth[max(k - 1, 0)], depth[min(k + 1, K - 1)]
        # a sharp maximum may penetrate where the mean over the strip does not
        if depth[k] > 0.0 or (np.isfinite(depth[k]) and depth[k] >= before and depth[k] >= after):
            sought[max(k - 1, 0) : k + 2] = True
    found = [(0.0, 0.0, False) for _ in range(0)]
    k = 0
    while k < K:
        start = k
        while k < K and sought[k]:
            k += 1
        if k == start:
            k += 1
            continue
        s = np.empty((k - start) * SAMPLES + 1)
        for i in range(start, k):
            for j in range(SAMPLES):
                s[(i - start) * SAMPLES + j] = middle[i] + (j / SAMPLES - 0.5) * width[i]
        s[-1] = middle[k - 1] + 0.5 * width[k - 1]
        _add_maxima(surface, origin, rotation, lift, s, found)
    bounds, continues = np.empty((len(found), 2)), np.zeros(len(found), dtype=np.bool_)
    for p in range(len(found)):
        bounds[p, 0], bounds[p, 1], continues[p] = found[p]
    return bounds, continues


@compiled
def penetrated_width(
    surface: SurfaceData,
    origin: Array,
    rotation: Array,
    lift: Array,
    middle: Array,
    width: Array,
    bounds: Array,
    continues: Mask,
    slopes: bool,
) -> tuple[float, Array]:
    """Number of strips across the penetration, and its derivative (6 + R,) by pose and lift if slopes, else zeros.

    Parameters:
        surface, origin, rotation, lift, middle, width: see `maxima`.
        bounds, continues: (P, 2) m and (P,), of its pieces with one maximum.
    """
    P, N, J = len(bounds), len(NODES), 6 + lift.shape[1]
    depth, share = np.zeros((P, N)), np.zeros((P, N))
    change, longer = np.zeros((P, N, J)), np.zeros((P, N, J))  # of the depth and, relative, of the share
    saddle, saddle_change = np.zeros(P), np.zeros((P, J))
    for p in range(P):
        half = 0.5 * (bounds[p, 1] - bounds[p, 0])
        lines = np.empty(N + 2)
        lines[:N] = 0.5 * (bounds[p, 0] + bounds[p, 1]) + half * NODES
        lines[N:] = bounds[p]
        at, x, _ = crests(surface, origin, rotation, lines)
        w = np.interp(lines, middle, width)
        d = at.depth - np.interp(lines, lift[0], lift[1])
        depth[p], share[p] = np.maximum(d[:N], 0.0), half * WEIGHTS / w[:N]
        if continues[p]:
            saddle[p] = max(d[N], 0.0)
        if not slopes:
            continue
        by_pose = np.zeros((N + 2, J))
        by_pose[:, :6] = penetration_changes(surface, origin, rotation, lines, x).depth
        for k in range(J - 6):
            one = np.zeros(J - 6)
            one[k] = 1.0
            by_pose[:, 6 + k] = -np.interp(lines, lift[0], one)
        before, after = lines - SHIFT, lines + SHIFT
        slope = crests(surface, origin, rotation, after)[0].depth - crests(surface, origin, rotation, before)[0].depth
        slope -= np.interp(after, lift[0], lift[1]) - np.interp(before, lift[0], lift[1])
        slope /= 2.0 * SHIFT
        w_slope = (np.interp(after, middle, width) - np.interp(before, middle, width)) / (2.0 * SHIFT)
        saddle_change[p] = by_pose[N]
        for j in range(J):
            # bounds at the edge of a region move with it, saddles count as fixed
            low = 0.0 if continues[p] else -by_pose[N, j] / slope[N]
            high = 0.0 if p + 1 < P and continues[p + 1] else -by_pose[N + 1, j] / slope[N + 1]
            for i in range(N):
                moved = 0.5 * (high + low) + 0.5 * (high - low) * NODES[i]
                longer[p, i, j] = 0.5 * (high - low) / half - w_slope[i] / w[i] * moved
                change[p, i, j] = by_pose[i, j] + slope[i] * moved
    double, square = 0.0, 0.0
    double_change, square_change = np.zeros(J), np.zeros(J)
    for p in range(P):
        own, least, place = np.zeros(J), np.inf, p
        for q in range(p, P):
            if q > p:
                if not continues[q]:
                    break
                if saddle[q] < least:
                    least, place = saddle[q], q
            twice = 1.0 if q == p else 2.0
            for i in range(N):
                for k in range(N):
                    a, b = depth[p, i], depth[q, k]
                    weight = twice * share[p, i] * share[q, k]
                    low = min(a, b, least)
                    double += weight * max(a, b) * low
                    if not slopes:
                        continue
                    for j in range(J):
                        value = max(a, b) * low * (longer[p, i, j] + longer[q, k, j])
                        if least < min(a, b):
                            higher = change[p, i, j] if a > b else change[q, k, j]
                            value += higher * least + max(a, b) * saddle_change[place, j]
                        else:
                            value += a * change[q, k, j] + b * change[p, i, j]
                        own[j] += weight * value
        for i in range(N):
            a = depth[p, i]
            square += share[p, i] * a * a
            square_change += share[p, i] * (a * a * longer[p, i] + 2.0 * a * change[p, i])
        double_change += own
    if not square > 0.0:
        return 0.0, np.zeros(J)
    number = OF_PARABOLA * double / square
    return number, OF_PARABOLA / square * double_change - number / square * square_change
