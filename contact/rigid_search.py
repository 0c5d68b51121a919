"""Contact points of a rigid wheel on a rigid rail: humps of the overlap along the wheel's profile, on the exact curves.

The overlap is the depth of the wheel's lowest points below the rail's surface. Its slope is exact, too: that of the
wheel's profile against the rail's normal. So humps, valleys and edges do not depend on where the search looks first.
"""

from __future__ import annotations

import numpy as np

from contact.pose import Array
from meshes.closest import Shape, foot, local, nearer_sample, nearest_sample, piece
from meshes.compiled import compiled

HUMPS = 8  # more than a wheel and a rail can have
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


@compiled
def scan(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, lines: Array
) -> tuple[Array, Array, Array]:
    """Overlap [m], its slope and its x [m] at lines (n,) m."""
    n = len(lines)
    depth, slope, where = np.empty(n), np.empty(n), np.empty(n)
    x, sample = 0.0, -1
    for i in range(n):
        depth[i], slope[i], x, sample = deepest(wheel, rail, radius, origin, rotation, lines[i], x, sample)
        if depth[i] == NONE:
            x, sample = 0.0, -1
        where[i] = x
    return depth, slope, where


@compiled
def humps(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    lines: Array,
    depth: Array,
    slope: Array,
    where: Array,
) -> tuple[Array, Array, float]:
    """Humps (n, 3) with overlap, valleys (n - 1, 3) between them: place, overlap and x, all m; largest overlap m."""
    top, low = np.empty((HUMPS, 3)), np.empty((HUMPS, 3))
    count, approach, last = 0, depth.max(), 0
    for i in range(len(lines) - 1):
        if not (slope[i] > 0.0 >= slope[i + 1]) or max(depth[i], depth[i + 1]) < -1e-4 or count == HUMPS:
            continue
        s, d, x = turning(
            wheel, rail, radius, origin, rotation, lines[i], lines[i + 1], slope[i], slope[i + 1], where[i], -1
        )
        approach = max(approach, d)
        if d <= 0.0:
            continue
        if count > 0:
            k = last + 1
            for j in range(last + 1, i + 1):
                if depth[j] < depth[k]:
                    k = j
            low[count - 1, 0], low[count - 1, 1], low[count - 1, 2] = lines[k], depth[k], where[k]
            if depth[k] > 0.0:  # one that matters, between the lines
                j = k - 1 if slope[k] > 0.0 else k
                one, other = max(lines[j], top[count - 1, 0] + CLOSE), min(lines[j + 1], s - CLOSE)
                _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, one, where[k], -1)
                _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, other, where[k], -1)
                if fall < 0.0 < rise:
                    low[count - 1, 0], low[count - 1, 1], low[count - 1, 2] = turning(
                        wheel, rail, radius, origin, rotation, one, other, fall, rise, where[k], -1
                    )
        top[count, 0], top[count, 1], top[count, 2] = s, d, x
        count, last = count + 1, i
    return top[:count].copy(), low[: max(count - 1, 0)].copy(), approach
