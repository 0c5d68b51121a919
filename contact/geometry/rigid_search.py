"""Contact points of a rigid wheel on a rigid rail: humps of the overlap along the wheel's profile, on the exact curves.

The overlap is the depth of the wheel's lowest points below the rail's surface. Its slope is exact, too: that of the
wheel's profile against the rail's normal. So humps, valleys and edges do not depend on where the search looks first.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.meshes.curves.closest_point import Shape, foot, local, nearer_sample, nearest_sample, piece
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array, Complex, Nodes
from wheelrail.support.compiled import compiled

HUMPS = 8  # more than a wheel and a rail can have
NEAR = -1e-4  # m: humps lower than that are not looked at
NONE = -1.0  # m: the overlap beside the rail
CLOSE = 1e-9  # m: a hump and a valley are further apart
TURNS = 12  # at most, of finding the lowest place of a yawed wheel


@compiled
def look(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, s: float, x: float, sample: int
) -> tuple[float, float, float, int]:
    """Overlap [m] at s and x [m] of a wheel's profile and rolling circle, its slope by s, the lowest x for a rail as
    steep as here, and the rail's sample next to the point.
    """
    z, t, _ = local(wheel, s, piece(wheel, s))
    r, sine, cosine = z.imag + radius, np.sin(x / radius), np.cos(x / radius)
    y = origin[1] + rotation[1, 0] * r * sine + rotation[1, 1] * z.real - rotation[1, 2] * r * cosine
    h = origin[2] + rotation[2, 0] * r * sine + rotation[2, 1] * z.real - rotation[2, 2] * r * cosine
    q = complex(y, h)
    sample = nearest_sample(rail, q) if sample < 0 else nearer_sample(rail, q, sample)
    at, away, inside = foot(rail, q, rail.samples[sample])
    if not inside:
        return NONE, 0.0, x, sample
    _, along, _ = local(rail, at, piece(rail, at))
    ny, nz = -along.imag, along.real
    ty = rotation[1, 0] * t.imag * sine + rotation[1, 1] * t.real - rotation[1, 2] * t.imag * cosine
    tz = rotation[2, 0] * t.imag * sine + rotation[2, 1] * t.real - rotation[2, 2] * t.imag * cosine
    forward, upward = ny * rotation[1, 0] + nz * rotation[2, 0], ny * rotation[1, 2] + nz * rotation[2, 2]
    lowest = -radius * np.arctan(forward / upward) if upward != 0.0 else x
    return -away, -(ty * ny + tz * nz), lowest, sample


@compiled
def deepest(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, s: float, x: float, sample: int
) -> tuple[float, float, float, int]:
    """The same at the lowest x of line s, from a guess of it: the wheel's forward direction runs along the rail."""
    depth, slope, lowest, sample = look(wheel, rail, radius, origin, rotation, s, x, sample)
    for _ in range(TURNS):
        if abs(lowest - x) < 1e-12:
            break
        x = lowest
        depth, slope, lowest, sample = look(wheel, rail, radius, origin, rotation, s, x, sample)
    return depth, slope, x, sample


@compiled
def turning(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    low: float,
    high: float,
    rise: float,
    fall: float,
    x: float,
    sample: int,
) -> tuple[float, float, float]:
    """Place [m], overlap [m] and x [m] where the slope, rise at low and fall at high [m], changes its sign: by false
    position with the stale end's slope halved (Illinois).
    """
    s, depth, side = low, 0.0, 0
    for _ in range(80):
        s = high - fall * (high - low) / (fall - rise) if fall != rise else 0.5 * (low + high)
        s = min(max(s, low), high)
        depth, slope, x, sample = deepest(wheel, rail, radius, origin, rotation, s, x, sample)
        if slope == 0.0 or high - low < 1e-14:
            break
        if (slope > 0.0) == (rise > 0.0):
            moved, low, rise = s - low, s, slope
            if side == 1:
                fall *= 0.5
            side = 1
        else:
            moved, high, fall = high - s, s, slope
            if side == -1:
                rise *= 0.5
            side = -1
        if moved < 1e-15:
            break
    return s, depth, x


@compiled
def crossing(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    inner: float,
    outer: float,
    level: float,
    x: float,
    sample: int,
) -> float:
    """Place [m] where the overlap, above a level [m] at inner and below it at outer, meets it: Newton's method from
    outside, where a hump is steep, between bounds.
    """
    s = outer
    for _ in range(60):
        depth, slope, x, sample = deepest(wheel, rail, radius, origin, rotation, s, x, sample)
        if depth >= level:
            inner = s
        else:
            outer = s
        new = s - (depth - level) / slope if slope != 0.0 and depth != NONE else 0.5 * (inner + outer)
        if not min(inner, outer) <= new <= max(inner, outer):
            new = 0.5 * (inner + outer)
        if abs(new - s) < 1e-15:
            break
        s = new
    return s


class Lines(NamedTuple):
    """Where humps are looked for: places s (n,) m on the wheel's profile, points and tangents there, and those of the
    rail's samples, as y + iz in m; curvature (m,) 1/m of the rail at its samples, positive where it is convex.
    """

    s: Array
    point: Complex
    tangent: Complex
    rail_tangent: Complex
    rail_curvature: Array

    @classmethod
    def of(cls, wheel: Profile, rail: Profile, s: Array) -> Lines:
        at = rail.shape.samples
        own = _complex(wheel.point(s)), _complex(wheel.tangent(s))
        return cls(s, own[0], own[1], _complex(rail.tangent(at)), rail.curvature(at))


def _complex(pairs: Array) -> Complex:
    return np.ascontiguousarray(pairs[:, 0] + 1j * pairs[:, 1])


class Scan(NamedTuple):
    """Overlap (n,) m, its slope, its x m and the rail's nearest sample at every line."""

    depth: Array
    slope: Array
    x: Array
    sample: Nodes


@compiled
def scan(rail: Shape, lines: Lines, radius: float, origin: Array, rotation: Array) -> Scan:
    """A first look, from the rail's samples and its curvature there: overlaps to about 1e-9 m."""
    n, last = len(lines.s), len(rail.samples) - 1
    depth, slope, where, nearest = np.full(n, NONE), np.zeros(n), np.zeros(n), np.zeros(n, dtype=np.int64)
    x, sample, rounds = 0.0, -1, 1 if rotation[1, 0] == 0.0 and rotation[2, 0] == 0.0 else 3
    for i in range(n):
        z, t = lines.point[i], lines.tangent[i]
        r = z.imag + radius
        for turn in range(rounds):
            sine, cosine = np.sin(x / radius), np.cos(x / radius)
            y = origin[1] + rotation[1, 0] * r * sine + rotation[1, 1] * z.real - rotation[1, 2] * r * cosine
            h = origin[2] + rotation[2, 0] * r * sine + rotation[2, 1] * z.real - rotation[2, 2] * r * cosine
            q = complex(y, h)
            sample = nearest_sample(rail, q) if sample < 0 else nearer_sample(rail, q, sample)
            away, along, bend = q - rail.sampled[sample], lines.rail_tangent[sample], lines.rail_curvature[sample]
            a = away.real * along.real + away.imag * along.imag
            d = away.imag * along.real - away.real * along.imag
            a /= 1.0 + bend * d  # to the foot on the circle of curvature
            turned = along * complex(1.0 - 0.5 * (a * bend) ** 2, -a * bend)
            ny, nz = -turned.imag, turned.real
            if turn < rounds - 1:
                forward, upward = ny * rotation[1, 0] + nz * rotation[2, 0], ny * rotation[1, 2] + nz * rotation[2, 2]
                x = -radius * np.arctan(forward / upward) if upward != 0.0 else x
        if (sample == 0 and a < 0.0) or (sample == last and a > 0.0):
            x, sample = 0.0, -1
            continue
        ty = rotation[1, 0] * t.imag * sine + rotation[1, 1] * t.real - rotation[1, 2] * t.imag * cosine
        tz = rotation[2, 0] * t.imag * sine + rotation[2, 1] * t.real - rotation[2, 2] * t.imag * cosine
        depth[i], slope[i] = -(d + 0.5 * bend * a * a * (1.0 + bend * d)), -(ty * ny + tz * nz)
        where[i], nearest[i] = x, sample
    return Scan(depth, slope, where, nearest)


@compiled
def humps(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, lines: Array, seen: Scan
) -> tuple[Array, Array, Nodes, float]:
    """Humps (n, 3) with overlap, valleys (n - 1, 3) between them: place, overlap and x, all m; the line (n,) before
    each hump; largest overlap m.
    """
    depth, slope, where, sample = seen
    top, low, before = np.empty((HUMPS, 3)), np.empty((HUMPS, 3)), np.empty(HUMPS, dtype=np.int64)
    count, approach, n = 0, depth.max(), len(lines)
    for i in range(n - 1):
        if not (slope[i] > 0.0 >= slope[i + 1]) or max(depth[i], depth[i + 1]) < NEAR or count == HUMPS:
            continue
        j, k = i, i + 1
        _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[j], where[j], sample[j])
        _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[k], where[k], sample[k])
        if rise <= 0.0 and j > 0:  # the first look missed it by a hair
            j -= 1
            _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[j], where[j], sample[j])
        if fall > 0.0 and k < n - 1:
            k += 1
            _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[k], where[k], sample[k])
        if not rise > 0.0 >= fall:
            continue
        s, d, x = turning(wheel, rail, radius, origin, rotation, lines[j], lines[k], rise, fall, where[i], sample[i])
        approach = max(approach, d)
        if d <= 0.0:
            continue
        if count > 0:
            k = before[count - 1] + 1
            for j in range(k, i + 1):
                if depth[j] < depth[k]:
                    k = j
            low[count - 1, 0], low[count - 1, 1], low[count - 1, 2] = lines[k], depth[k], where[k]
            if depth[k] > 0.0:  # one that matters, between the lines
                one, other = max(lines[k - 1], top[count - 1, 0] + CLOSE), min(lines[k + 1], s - CLOSE)
                _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, one, where[k], sample[k])
                _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, other, where[k], sample[k])
                if fall < 0.0 < rise:
                    low[count - 1, 0], low[count - 1, 1], low[count - 1, 2] = turning(
                        wheel, rail, radius, origin, rotation, one, other, fall, rise, where[k], sample[k]
                    )
        top[count, 0], top[count, 1], top[count, 2], before[count] = s, d, x, i
        count += 1
    return top[:count].copy(), low[: max(count - 1, 0)].copy(), before[:count].copy(), approach
