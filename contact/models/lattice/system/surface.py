"""Compiled: undeformed surfaces of a pair, their penetration and rigid slip at points of strips."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.contact.geometry.strip_surfaces import NEXT, ProfileStrips, QuadricStrips, StripSurfaces
from wheelrail.contact.geometry.wheel_surface import wheel_place
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.meshes.curves.closest_point import Shape, foot, local, nearer_sample, nearest_sample, piece
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import compiled

CREST_STEPS = 12
CREST_ERROR = 1e-10  # m
STEEPEST = 0.9  # slope of the fixed-point map up to which Newton's step is taken; a maximum has less than 1


class SurfaceData(NamedTuple):
    """Surfaces of a pair for compiled code.

    Parameters:
        revolves: whether the upper one is a wheel's profile revolved about y, on an extruded rail; else quadrics.
        wheel, rail: profiles; empty for quadrics.
        radius: of the wheel, m.
        upper, lower: (2,) 1/m, coefficients of quadrics along x and across.
    """

    revolves: bool
    wheel: Shape
    rail: Shape
    radius: float
    upper: Array
    lower: Array


class Motion(NamedTuple):
    """Pose of the upper body, velocity fields of both, and the rolling speed.

    Parameters:
        origin, rotation: (3,) m and (3, 3) of the upper body.
        wheel, rail: velocity m/s, rotation rad/s and reference m, all (3,), of v + w x (X - reference).
        speed: m/s; 0 without friction.
    """

    origin: Array
    rotation: Array
    wheel: tuple[Array, Array, Array]
    rail: tuple[Array, Array, Array]
    speed: float


class Penetration(NamedTuple):
    """Penetration at n points.

    Parameters:
        depth: (n,) m; -inf beyond the ends of the rail.
        slope: (n,) its derivative along x.
        pose: (n, 6) its derivative by translation and rotation of the wheel's frame.
        foot: (n,) m, arc length of the closest points on the lower body.
        foot_pose: (n, 6) its derivative by the pose.
    """

    depth: Array
    slope: Array
    pose: Array
    foot: Array
    foot_pose: Array


NO_SHAPE = Shape(np.zeros(2), np.zeros(1), np.zeros((1, 3, 8), dtype=complex), np.zeros(1), np.zeros(1, dtype=complex))


def surface_data(surfaces: StripSurfaces) -> SurfaceData:
    """Data of profiles or quadrics."""
    if isinstance(surfaces, ProfileStrips):
        none = np.zeros(2)
        return SurfaceData(True, surfaces.wheel.shape, surfaces.rail.shape, surfaces.radius, none, none)
    assert isinstance(surfaces, QuadricStrips)
    quadrics = (np.array(curvature(radii), dtype=float) for radii in (surfaces.upper, surfaces.lower))
    return SurfaceData(False, NO_SHAPE, NO_SHAPE, 1.0, *quadrics)


def motion_data(pose: Pose, motion: RigidMotion, speed: float) -> Motion:
    """Data of a pose and a motion."""
    origin, rotation = np.asarray(pose.origin, dtype=float), np.ascontiguousarray(pose.rotation)
    return Motion(origin, rotation, _field(motion.wheel), _field(motion.rail), speed)


def _field(body: Twist) -> tuple[Array, Array, Array]:
    velocity, rotation, reference = (
        np.ascontiguousarray(part, dtype=float) for part in (body.velocity, body.rotation, body.reference)
    )
    return velocity, rotation, reference


@compiled
def penetration(surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array) -> Penetration:
    """`Penetration` of points s, x (n,) m across and along.

    With the closest point r(sigma) of the rail, (q - r) r' = 0, and the wheel's normal w the penetration is (q - r) w.
    """
    n = len(s)
    result = Penetration(np.empty(n), np.empty(n), np.zeros((n, 6)), np.empty(n), np.zeros((n, 6)))
    point, axes = np.empty((1, 3)), np.empty((1, 3, 3))
    last, sample = complex(np.inf, 0.0), 0
    for i in range(n):
        if not surface.revolves:
            _quadrics(surface, origin, s[i], x[i], result, i)
            continue
        wheel_place(surface.wheel, surface.radius, origin, rotation, s[i], x[i], point, axes, 0)
        q = complex(point[0, 1], point[0, 2])
        rail = surface.rail
        sample = nearer_sample(rail, q, sample) if abs(q - last) < NEXT else nearest_sample(rail, q)
        last = q
        result.foot[i], _, inside = foot(rail, q, rail.samples[sample])
        on_rail, t, k = local(rail, result.foot[i], piece(rail, result.foot[i]))
        away = q - on_rail
        wx, wy, wz = axes[0, 2]
        result.depth[i] = away.real * wy + away.imag * wz if inside else -np.inf
        moves = 1.0 / (1.0 - (away.real * k.real + away.imag * k.imag))
        along = (t.real * wy + t.imag * wz) * moves
        change = result.pose[i]
        _carried(point[0], origin, wy - along * t.real, wz - along * t.imag, change)
        change[3] += wy * away.imag - wz * away.real
        change[4] -= wx * away.imag
        change[5] += wx * away.real
        _carried(point[0], origin, moves * t.real, moves * t.imag, result.foot_pose[i])
        about_axle = rotation[0, 1] * change[3] + rotation[1, 1] * change[4] + rotation[2, 1] * change[5]
        result.slope[i] = -about_axle / surface.radius
    return result


@compiled
def crests(surface: SurfaceData, origin: Array, rotation: Array, s: Array) -> tuple[Array, Array, Array]:
    """Largest penetration (n,) m on the lines s (n,) m, its place m along x and the relative curvature 1/m there.

    Penetration is largest where the wheel's circle is parallel to the rail: where its tangent has no component along
    the rail's normal.
    """
    n = len(s)
    x, bend = np.zeros(n), np.empty(n)
    if not surface.revolves:
        a, b = surface.upper[0], surface.lower[0]
        x[:] = origin[0] * a / (a + b)
        bend[:] = 2 * (a + b)
        return penetration(surface, origin, rotation, s, x).depth, x, bend
    wheel, radius = surface.wheel, surface.radius
    for i in range(n if rotation[1, 0] != 0.0 else 0):
        x[i] = _crest(surface, origin, rotation, s[i])
    for i in range(n):
        z, t, _ = local(wheel, s[i], piece(wheel, s[i]))
        r = z.imag + radius
        bend[i] = max(r * t.real, 0.05 * r) / (radius * radius)
    return penetration(surface, origin, rotation, s, x).depth, x, bend


@compiled
def _crest(surface: SurfaceData, origin: Array, rotation: Array, s: float) -> float:
    """Place m along x of the largest penetration on a line s m of a wheel, by Newton's method.

    The equation is x = -R arctan(f / u), where f and u are the components of the rail's normal n along the wheel's
    forward and upward axes; n changes with the closest point on the rail.
    """
    rail, radius = surface.rail, surface.radius
    point, axes, x, sample = np.empty((1, 3)), np.empty((1, 3, 3)), 0.0, -1
    for _ in range(CREST_STEPS):
        wheel_place(surface.wheel, radius, origin, rotation, s, x, point, axes, 0)
        q = complex(point[0, 1], point[0, 2])
        sample = nearest_sample(rail, q) if sample < 0 else nearer_sample(rail, q, sample)
        at, _, _ = foot(rail, q, rail.samples[sample])
        z, t, k = local(rail, at, piece(rail, at))
        away = q - z
        moved = (t.real * axes[0, 0, 1] + t.imag * axes[0, 0, 2]) / (1.0 - (away.real * k.real + away.imag * k.imag))
        forward = rotation[2, 0] * t.real - rotation[1, 0] * t.imag
        up = rotation[2, 2] * t.real - rotation[1, 2] * t.imag
        forward_change = (rotation[2, 0] * k.real - rotation[1, 0] * k.imag) * moved
        up_change = (rotation[2, 2] * k.real - rotation[1, 2] * k.imag) * moved
        slope = -radius * (forward_change * up - forward * up_change) / (forward * forward + up * up)
        step = -radius * np.arctan(forward / up) - x
        if slope < STEEPEST:
            step /= 1.0 - slope
        x += step
        if abs(step) < CREST_ERROR:
            break
    return x


@compiled
def crest_changes(surface: SurfaceData, rotation: Array, feet: Array, feet_change: Array) -> Array:
    """Derivative (n, 6) of the places of `crests` along x by the pose, from the closest points on the rail (n,) m there
    and their derivative (n, 6).
    """
    n = len(feet)
    change = np.zeros((n, 6))
    if not surface.revolves:
        change[:, 0] = surface.upper[0] / (surface.upper[0] + surface.lower[0])
        return change
    rail = surface.rail
    for i in range(n):
        _, t, k = local(rail, feet[i], piece(rail, feet[i]))
        normal, bend = np.array([0.0, -t.imag, t.real]), np.array([0.0, -k.imag, k.real])
        forward, up = 0.0, 0.0
        for c in range(3):
            forward += rotation[c, 0] * normal[c]
            up += rotation[c, 2] * normal[c]
        for j in range(6):
            along, high = 0.0, 0.0
            for c in range(3):
                moved = bend[c] * feet_change[i, j]
                if j >= 3:  # the normal in the axes of the wheel, which rotate by e_j: n x e_j
                    unit = np.zeros(3)
                    unit[j - 3] = 1.0
                    moved += _cross(normal, unit, c)
                along += rotation[c, 0] * moved
                high += rotation[c, 2] * moved
            change[i, j] = -surface.radius * (along * up - forward * high) / (forward * forward + up * up)
    return change


@compiled
def _quadrics(surface: SurfaceData, origin: Array, s: float, x: float, result: Penetration, i: int) -> None:
    """Write the penetration of two quadrics at a point into row i."""
    (ax, ay), (bx, by) = surface.upper, surface.lower
    dx, ds = x - origin[0], s - origin[1]
    result.depth[i] = -origin[2] - ax * dx * dx - ay * ds * ds - bx * x * x - by * s * s
    result.slope[i] = -2 * ax * dx - 2 * bx * x
    result.pose[i, 0], result.pose[i, 1], result.pose[i, 2] = 2 * ax * dx, 2 * ay * ds, -1.0
    result.foot[i] = s


@compiled
def _carried(point: Array, origin: Array, gy: float, gz: float, change: Array) -> None:
    """Derivative (6,) of (0, gy, gz) times a point that moves with a frame."""
    rx, ry, rz = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
    change[0], change[1], change[2] = 0.0, gy, gz
    change[3], change[4], change[5] = ry * gz - rz * gy, -rx * gz, rx * gy


class SurfaceFrames(NamedTuple):
    """Points (n, 3) m of the upper body and its axes (n, 3, 3) there: longitudinal, lateral and outward.

    forward (n, 3): change of the points along x; turn (3,) rad/m: rotation of the axes along x.
    """

    point: Array
    axes: Array
    forward: Array
    turn: Array


@compiled
def frames(surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array) -> SurfaceFrames:
    """Points and axes at s, x (n,) m across and along."""
    n = len(s)
    point, axes, forward, turn = np.zeros((n, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3)), np.zeros(3)
    if surface.revolves:
        for c in range(3):
            turn[c] = -rotation[c, 1] / surface.radius
    for i in range(n):
        if surface.revolves:
            wheel_place(surface.wheel, surface.radius, origin, rotation, s[i], x[i], point, axes, i)
            for c in range(3):
                a, b = (c + 1) % 3, (c + 2) % 3
                forward[i, c] = turn[a] * (point[i, b] - origin[b]) - turn[b] * (point[i, a] - origin[a])
        else:
            point[i, 0], point[i, 1] = x[i], s[i]
            axes[i, 0, 0], axes[i, 1, 1], axes[i, 2, 2], forward[i, 0] = 1.0, 1.0, -1.0, 1.0
    return SurfaceFrames(point, axes, forward, turn)


@compiled
def _cross(a: Array, b: Array, c: int) -> float:
    """Component c of a cross product."""
    first, second = (c + 1) % 3, (c + 2) % 3
    return float(a[first] * b[second] - a[second] * b[first])


@compiled
def rigid_shift(places: SurfaceFrames, level: Array, motion: Motion) -> tuple[Array, Array, Array]:
    """Rigid tangential velocity (n, 2) m/s of the upper relative to the lower body, its derivative (n, 2) along x, and
    the mean velocity (n,) m/s of both in the longitudinal axes.

    level (n, 3): longitudinal axes where the strips touch. Material flows along its own surface, and both surfaces end
    up in the common one: the velocity of the wheel counts along its circle, that of the rail, which is straight, along
    the level axis. Along the wheel's circle it would be smaller by x^2 / (2 R^2), as much as the creepage of a few
    per mille of saturation. The lateral axes turn along x, which is the spin of a conical wheel.
    """
    n = len(places.point)
    shift, slope, flow = np.zeros((n, 2)), np.zeros((n, 2)), np.zeros(n)
    arm, other_arm = np.empty(3), np.empty(3)
    for i in range(n):
        for c in range(3):
            arm[c] = places.point[i, c] - motion.wheel[2][c]
            other_arm[c] = places.point[i, c] - motion.rail[2][c]
        for c in range(3):
            own = motion.wheel[0][c] + _cross(motion.wheel[1], arm, c)
            other = motion.rail[0][c] + _cross(motion.rail[1], other_arm, c)
            own_change = _cross(motion.wheel[1], places.forward[i], c)
            other_change = _cross(motion.rail[1], places.forward[i], c)
            x, y = places.axes[i, 0, c], places.axes[i, 1, c]
            x_change, y_change = _cross(places.turn, places.axes[i, 0], c), _cross(places.turn, places.axes[i, 1], c)
            flow[i] += 0.5 * x * (own + other)
            shift[i, 0] += x * own - level[i, c] * other
            shift[i, 1] += y * (own - other)
            slope[i, 0] += x * own_change + x_change * own - level[i, c] * other_change
            slope[i, 1] += y * (own_change - other_change) + y_change * (own - other)
    return shift, slope, flow


class ContactLines(NamedTuple):
    """Where K strips touch: on their middles, the points of largest penetration along x.

    Parameters:
        depth: (K,) m, penetration at their x, the mean over the width; -inf far from contact.
        x: (K,) m, its place along x.
        curvature: (K,) 1/m, relative curvature along x there.
        foot: (K,) m, arc length of the closest points on the lower body; NaN where the gap exceeds `MARGIN`.
        foot_pose: (K, 6) its derivative by the pose.
        level: (K, 3) longitudinal axis.
        speed: m/s at which both materials flow backwards, the mean weighted by the squared penetration; 0 without
            penetration.
    """

    depth: Array
    x: Array
    curvature: Array
    foot: Array
    foot_pose: Array
    level: Array
    speed: float


GAUSS = 0.5 / np.sqrt(3.0)  # of a strip's width, from its middle
BETWEEN = 4  # strips between those at which the penetration is estimated first
MARGIN = 3e-4  # m, by which it may be larger in between, and largest gap that displacements may close


@compiled
def contact_lines(surface: SurfaceData, motion: Motion, middle: Array, width: Array) -> ContactLines:
    """`ContactLines` of strips with middles and widths (K,) m."""
    K = len(middle)
    depth, x, curvature = np.full(K, -np.inf), np.zeros(K), np.ones(K)
    count = (K + BETWEEN - 2) // BETWEEN + 1
    probes = np.empty(count, dtype=np.int64)
    for k in range(count):
        probes[k] = min(k * BETWEEN, K - 1)
    near = crests(surface, motion.origin, motion.rotation, middle[probes])[0] > -MARGIN
    own = np.zeros(K, dtype=np.bool_)
    for k in range(count):
        if near[k]:
            own[max(probes[k] - BETWEEN, 0) : probes[k] + BETWEEN + 1] = True
    inside = np.flatnonzero(own)
    at = crests(surface, motion.origin, motion.rotation, middle[inside])
    s, along = np.empty(2 * len(inside)), np.empty(2 * len(inside))
    for k in range(len(inside)):
        for g in range(2):
            s[2 * k + g] = middle[inside[k]] + (2 * g - 1) * GAUSS * width[inside[k]]
            along[2 * k + g] = at[1][k]
    sides = penetration(surface, motion.origin, motion.rotation, s, along).depth
    for k in range(len(inside)):
        depth[inside[k]] = 0.5 * (sides[2 * k] + sides[2 * k + 1])
        x[inside[k]], curvature[inside[k]] = at[1][k], at[2][k]
    foot, foot_pose, level = np.full(K, np.nan), np.zeros((K, 6)), np.zeros((K, 3))
    touching = np.flatnonzero(depth > -MARGIN)
    s, along = middle[touching], x[touching]
    closest = penetration(surface, motion.origin, motion.rotation, s, along)
    places = frames(surface, motion.origin, motion.rotation, s, along)
    flow = rigid_shift(places, np.ascontiguousarray(places.axes[:, 0]), motion)[2]
    total, weights = 0.0, 0.0
    for k in range(len(touching)):
        i = touching[k]
        foot[i], foot_pose[i], level[i] = closest.foot[k], closest.foot_pose[k], places.axes[k, 0]
        weight = max(depth[i], 0.0) ** 2 * width[i]
        total, weights = total - weight * flow[k], weights + weight
    return ContactLines(depth, x, curvature, foot, foot_pose, level, total / weights if weights > 0.0 else 0.0)


@compiled
def smallest_gaps(depth: Array, near: Mask) -> Mask:
    """Strips (K,) that penetrate or, of those near to contact, lie where the gap is smallest, and the next ones.

    Parameters:
        depth: (K,) m, penetration.
        near: (K,) strips near to contact.
    """
    K = len(depth)
    chosen = np.zeros(K, dtype=np.bool_)
    for k in range(K):
        smallest = near[k] and depth[k] >= depth[max(k - 1, 0)] and depth[k] >= depth[min(k + 1, K - 1)]
        if smallest or depth[k] > 0.0:
            for m in range(max(k - 1, 0), min(k + 2, K)):
                chosen[m] = chosen[m] or near[m]
    return chosen
