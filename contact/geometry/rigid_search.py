"""Contact points of a rigid wheel on a rigid rail: local maxima of the penetration profile, on the exact curves.

The penetration is the depth of the wheel's lowest points below the rail's surface. Its slope is exact as well: that of
the wheel's profile relative to the rail's normal. Maxima, minima and edges therefore do not depend on the initial
sampling.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.meshes.curves.closest_point import (
    SMALL_STEP,
    SPACING,
    Shape,
    foot_from,
    local,
    nearer_sample,
    nearest_sample,
    next_piece,
    piece,
)
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import borrowing, unchecked

MAXIMA = 8  # at most, more than a wheel and a rail can have
NEAR = -1e-4  # m: sampled maxima lower than that are not refined
CLOSE = 1e-9  # m: smallest distance of a maximum and a minimum
ITERATIONS = 12  # for the lowest point of a yawed wheel
LOWEST = 1e-7  # m, last change of its x by Newton's method, with which the error of the penetration is quadratic
LAST = 1e-10  # m, last change of its x in turns with the closest point: the next one is a thousand times smaller
TURNS, DIRECT = 24, 3  # of closest points and angles in turns; those without a secant's step
LARGEST = 40.0  # times the change of the angle, of such a step
LARGE = 0.1  # rad, beyond the difference between neighbouring lines
FARTHEST = 10.0  # times the longest step: not the neighbourhood of the guess


@borrowing
def deepest(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, s: float, x: float, sample: int
) -> tuple[float, float, float, int]:
    """Penetration m of line s at its lowest point, where the wheel's forward direction is parallel to the rail; its
    slope by s, the lowest x m, and the rail's nearest sample. Beside the rail: minus the distance from its end.

    Parameters:
        wheel, rail: shapes of the profiles.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        s, x: m, arc length on the profile, and initial guess of the lowest point along the rolling circle.
        sample: initial guess of the nearest sample, negative without.
    """
    z, t, _ = local(wheel, s, piece(wheel, s))
    return lowest(rail, radius, origin, rotation, z, t, x, sample)


@borrowing
def lowest(
    rail: Shape, radius: float, origin: Array, rotation: Array, z: complex, t: complex, x: float, sample: int
) -> tuple[float, float, float, int]:
    """As `deepest`, of the line of a point z m with the tangent t on the wheel's profile.

    Newton's method in the rail's arc length a and the angle along the rolling circle at once: the rail's tangent is
    perpendicular to the distance of both points, and its normal to the wheel's forward direction.
    """
    r, sine, cosine = z.imag + radius, np.sin(x / radius), np.cos(x / radius)
    at, j = 0.0, -1
    for _ in range(ITERATIONS):
        forward_y, forward_z, up_y, up_z = (
            rotation[1, 0] * cosine + rotation[1, 2] * sine,
            rotation[2, 0] * cosine + rotation[2, 2] * sine,
            rotation[1, 0] * sine - rotation[1, 2] * cosine,
            rotation[2, 0] * sine - rotation[2, 2] * cosine,
        )
        y = origin[1] + r * up_y + rotation[1, 1] * z.real
        h = origin[2] + r * up_z + rotation[2, 1] * z.real
        if j < 0:
            q = complex(y, h)
            sample = nearest_sample(rail, q) if sample < 0 else nearer_sample(rail, q, sample)
            at = rail.samples[sample]
            j = piece(rail, at)
        point, along, change = local(rail, at, j)
        y, h = y - point.real, h - point.imag
        beside, height = along.real * y + along.imag * h, along.real * h - along.imag * y
        second = 1.0 - (change.real * y + change.imag * h)
        level, upward = along.real * forward_z - along.imag * forward_y, along.real * up_z - along.imag * up_y
        across = r * (along.real * forward_y + along.imag * forward_z)
        bend = change.real * forward_z - change.imag * forward_y
        determinant = second * upward - across * bend
        step, turn = (beside * upward + across * level) / determinant, (second * level + bend * beside) / determinant
        size = max(abs(step) / (2.0 * SPACING), abs(turn) / LARGE)
        if not (second > 0.0 > determinant and size < FARTHEST):
            break
        if size > 1.0:  # on steep flanges of wheels that yaw the closest point runs far along with the angle
            step, turn = step / size, turn / size
        if abs(step) < SMALL_STEP and radius * abs(turn) < LOWEST:
            ty, tz = t.imag * up_y + t.real * rotation[1, 1], t.imag * up_z + t.real * rotation[2, 1]
            slope = ty * along.imag - tz * along.real + step * (ty * change.imag - tz * change.real)
            # The last step raises the point by half of what the slopes of its height, which it takes to zero, say.
            height += 0.5 * (turn * r * level + step * (change.real * h - change.imag * y))
            return -height, slope, radius * (np.arctan(sine / cosine) + turn), sample
        at += step
        if not rail.breaks[0] < at < rail.breaks[-1]:
            break
        j = next_piece(rail, at, j)
        size = 1.0 / np.sqrt(1.0 + turn * turn)
        sine, cosine = size * (sine + turn * cosine), size * (cosine - turn * sine)
    return lowest_at_foot(rail, radius, origin, rotation, z, t, x, sample)


@borrowing
def next_turn(
    turn: int, at: float, last: float, change: float, changed: float, sine: float, cosine: float
) -> tuple[float, float]:
    """Sine and cosine of the next angle along the rolling circle, of closest points and angles in turns.

    Parameters:
        turn: number of turns before.
        at, last: sines of this turn and of the one before.
        change, changed: by these turns.
        sine, cosine: after this turn.

    On the steep flange of a wheel that yaws the closest point runs along with the angle: turns alone stall there, or
    run away. A secant's step takes their change to zero.
    """
    bend = (change - changed) / (at - last) if turn >= DIRECT and at != last else 0.0
    if bend >= -1.0 / LARGEST:
        return sine, cosine
    sine = min(max(at - change / bend, -1.0), 1.0)
    return sine, np.copysign(np.sqrt(1.0 - sine * sine), cosine)


@borrowing
def lowest_at_foot(
    rail: Shape, radius: float, origin: Array, rotation: Array, z: complex, t: complex, x: float, sample: int
) -> tuple[float, float, float, int]:
    """As `lowest`, at corners and beside the ends of the rail too: closest points of the rail and angles in turns.

    Beside the ends the penetration is minus the distance from them, the smallest that is found.
    """
    r, j, at, depth, slope, bottom = z.imag + radius, -1, 0.0, 0.0, 0.0, x
    beside = -np.inf, 0.0, x
    sine, cosine, at_sine, change = np.sin(x / radius), np.cos(x / radius), 0.0, 0.0
    for turn in range(TURNS):
        y = origin[1] + rotation[1, 0] * r * sine + rotation[1, 1] * z.real - rotation[1, 2] * r * cosine
        h = origin[2] + rotation[2, 0] * r * sine + rotation[2, 1] * z.real - rotation[2, 2] * r * cosine
        q = complex(y, h)
        if j < 0:
            at = rail.samples[sample]
            j = piece(rail, at)
        at, height, inside, j = foot_from(rail, q, at, j)
        end, along, _ = local(rail, at, j)
        ny, nz = -along.imag, along.real
        if not inside:
            height = abs(q - end)
            if height > 0.0:
                ny, nz = (q.real - end.real) / height, (q.imag - end.imag) / height
        ty = rotation[1, 0] * t.imag * sine + rotation[1, 1] * t.real - rotation[1, 2] * t.imag * cosine
        tz = rotation[2, 0] * t.imag * sine + rotation[2, 1] * t.real - rotation[2, 2] * t.imag * cosine
        depth, slope = -height, -(ty * ny + tz * nz)
        if not inside and depth > beside[0]:
            beside = depth, slope, bottom
        forward, upward = ny * rotation[1, 0] + nz * rotation[2, 0], ny * rotation[1, 2] + nz * rotation[2, 2]
        if upward == 0.0:
            break
        before, bottom = bottom, -radius * np.arctan(forward / upward)
        if abs(bottom - before) < LAST:
            break
        size = np.copysign(np.sqrt(forward * forward + upward * upward), upward)
        last, changed, at_sine, sine, cosine = at_sine, change, sine, -forward / size, upward / size
        change = sine - at_sine
        sine, cosine = next_turn(turn, at_sine, last, change, changed, sine, cosine)
        bottom = radius * np.arctan(sine / cosine)
    if not inside:
        return beside[0], beside[1], beside[2], sample
    return depth, slope, bottom, sample


@borrowing
def stationary_point(
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
    """Position, penetration and x [m] at which the slope changes its sign, by false position (Illinois).

    Parameters:
        wheel, rail, radius, origin, rotation: as for `deepest`.
        low, high: m, bounds of the position.
        rise, fall: slopes there.
        x, sample: initial guesses.
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
        if moved < 1e-12:
            break
    return s, depth, x


@borrowing
def level_crossing(
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
    """Position [m] at which the penetration equals a level, by Newton's method with bounds; `outer` if it is not less
    there.

    Parameters:
        wheel, rail, radius, origin, rotation: as for `deepest`.
        inner, outer: m, bounds; the iteration starts at the outer one, where the profile is steep.
        level: m, exceeded at inner.
        x, sample: initial guesses.
    """
    s = outer
    for _ in range(60):
        depth, slope, x, sample = deepest(wheel, rail, radius, origin, rotation, s, x, sample)
        if depth >= level:
            if s == outer:
                return outer
            inner = s
        else:
            outer = s
        new = s - (depth - level) / slope if slope != 0.0 else 0.5 * (inner + outer)
        if not min(inner, outer) <= new <= max(inner, outer):
            new = 0.5 * (inner + outer)
        moved, s = abs(new - s), new
        if moved < 1e-10:  # the next one is quadratic in it
            break
    return s


class Scan(NamedTuple):
    """Penetration (n,) m, its slope, x m, and the rail's nearest sample, -1 beside the rail, at every line."""

    depth: Array
    slope: Array
    x: Array
    sample: Nodes


@unchecked
def local_maxima(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, lines: Array, samples: Scan
) -> tuple[Array, Array, Nodes, float]:
    """Maxima (n, 3), minima (n - 1, 3) between them, line (n,) before each maximum, largest penetration m.

    Columns: position, penetration and x, m. A gap between two maxima has the penetration 0.

    Parameters:
        wheel, rail, radius, origin, rotation: as for `deepest`.
        lines: (m,) m, arc lengths on the wheel's profile.
        samples: of `scan`.
    """
    depth, slope, where, sample = samples
    top, low, before = np.empty((MAXIMA, 3)), np.empty((MAXIMA, 3)), np.empty(MAXIMA, dtype=np.int64)
    count, approach, n = 0, depth.max(), len(lines)
    for i in range(n - 1):
        if not (slope[i] > 0.0 >= slope[i + 1]) or max(depth[i], depth[i + 1]) < NEAR or count == MAXIMA:
            continue
        j, k = i, i + 1
        _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[j], where[j], sample[j])
        _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[k], where[k], sample[k])
        if rise <= 0.0 and j > 0:  # the samples are not accurate enough
            j -= 1
            _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[j], where[j], sample[j])
        if fall > 0.0 and k < n - 1:
            k += 1
            _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, lines[k], where[k], sample[k])
        if not rise > 0.0 >= fall:
            continue
        s, d, x = stationary_point(
            wheel, rail, radius, origin, rotation, lines[j], lines[k], rise, fall, where[i], sample[i]
        )
        approach = max(approach, d)
        if d <= 0.0:
            continue
        if count > 0:
            k = before[count - 1] + 1
            for j in range(k, i + 1):
                if depth[j] < depth[k]:
                    k = j
            low[count - 1, 0], low[count - 1, 1], low[count - 1, 2] = lines[k], max(depth[k], 0.0), where[k]
            if depth[k] > 0.0:  # inside the region of penetration: refine it
                left, right = max(lines[k - 1], top[count - 1, 0] + CLOSE), min(lines[k + 1], s - CLOSE)
                _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, left, where[k], sample[k])
                _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, right, where[k], sample[k])
                if fall < 0.0 < rise:
                    low[count - 1, 0], low[count - 1, 1], low[count - 1, 2] = stationary_point(
                        wheel, rail, radius, origin, rotation, left, right, fall, rise, where[k], sample[k]
                    )
        top[count, 0], top[count, 1], top[count, 2], before[count] = s, d, x, i
        count += 1
    return top[:count].copy(), low[: max(count - 1, 0)].copy(), before[:count].copy(), approach
