"""Compiled: undeformed surfaces of a pair, their penetration and rigid slip at points of strips."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.contact.geometry.rigid_search import lowest
from wheelrail.contact.geometry.strip_surfaces import NEXT, ProfileStrips, QuadricStrips, StripSurfaces
from wheelrail.contact.geometry.wheel_surface import Place, on_circle, write_frame
from wheelrail.contact.kinematics.frames import Pose, RigidMotion, Twist
from wheelrail.meshes.curves.closest_point import Shape, foot, local, nearer_sample, nearest_sample, piece
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

GAUSS = 0.5 / np.sqrt(3.0)  # of a strip's width, from its middle
OPPOSED = -0.5  # cosine between the normals of surfaces that may touch, a tenth of a radian apart under large loads


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
        foot: (n,) m, arc length of the closest points on the lower body.
    """

    depth: Array
    slope: Array
    foot: Array


class PenetrationChanges(NamedTuple):
    """Derivatives (n, 6) of the penetration and of the closest points at n points by the pose of the wheel's frame."""

    depth: Array
    foot: Array


class Projection(NamedTuple):
    """A point of a wheel, projected on the rail: `project`.

    Parameters:
        depth: m, penetration; -inf beyond the ends of the rail, and where the surfaces do not face each other.
        foot: m, arc length of the closest point.
        sample: number of the nearest sample of the rail.
        point, normal: of the wheel, m.
        gradient: derivative of the penetration by the point's position across and upwards, for a fixed normal.
        away: m, from the closest point to the point.
        moves: derivative of foot by the point's position across and upwards.
    """

    depth: float
    foot: float
    sample: int
    point: Place
    normal: Place
    gradient: complex
    away: complex
    moves: complex


NO_SHAPE = Shape(
    np.zeros(2), np.zeros(1), np.zeros((1, 3, 8), dtype=complex), np.zeros(1), np.zeros(1, dtype=complex), False
)


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


@borrowing
def project(rail: Shape, point: Place, normal: Place, sample: int) -> Projection:
    """Projection of a point with an outward normal; sample: that nearest to a neighbour, -1 without one.

    With the closest point r(sigma) of the rail, (q - r) r' = 0, and the wheel's normal w the penetration is (q - r) w.
    """
    q = complex(point[1], point[2])
    sample = nearest_sample(rail, q) if sample < 0 else nearer_sample(rail, q, sample)
    at, _, inside = foot(rail, q, rail.samples[sample])
    on_rail, t, k = local(rail, at, piece(rail, at))
    away, w = q - on_rail, complex(normal[1], normal[2])
    moves = t * (1.0 / (1.0 - (away.real * k.real + away.imag * k.imag)))
    gradient = w - (t.real * w.real + t.imag * w.imag) * moves
    # beside the rail, and for surfaces that face the same way, as a flange's back and a gauge face: no contact
    opposed = inside and w.imag * t.real - w.real * t.imag < OPPOSED
    depth = away.real * w.real + away.imag * w.imag if opposed else -np.inf
    return Projection(depth, at, sample, point, normal, gradient, away, moves)


@borrowing
def _turned(at: Projection, origin: Array) -> Place:
    """Derivative of the penetration by rotation of the wheel about the axes of space through its origin."""
    rx, ry, rz = at.point[0] - origin[0], at.point[1] - origin[1], at.point[2] - origin[2]
    wx, wy, wz = at.normal
    g, away = at.gradient, at.away
    return (
        ry * g.imag - rz * g.real + wy * away.imag - wz * away.real,
        -rx * g.imag - wx * away.imag,
        rx * g.real + wx * away.real,
    )


@compiled
def penetration(surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array) -> Penetration:
    """`Penetration` of points s, x (n,) m across and along; fastest where neighbours share s."""
    n = len(s)
    result = Penetration(np.empty(n), np.empty(n), np.empty(n))
    _store_penetration(surface, origin, rotation, s, x, result)
    return result


@borrowing
def _store_penetration(
    surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array, result: Penetration
) -> None:
    """Fill `penetration`."""
    n = len(s)
    (ax, ay), (bx, by) = surface.upper, surface.lower
    z, t, sample, last = 0j, 0j, -1, np.inf
    for i in range(n):
        if not surface.revolves:
            dx, ds = x[i] - origin[0], s[i] - origin[1]
            result.depth[i] = -origin[2] - ax * dx * dx - ay * ds * ds - bx * x[i] * x[i] - by * s[i] * s[i]
            result.slope[i] = -2 * ax * dx - 2 * bx * x[i]
            result.foot[i] = s[i]
            continue
        if s[i] != last:
            z, t, _ = local(surface.wheel, s[i], piece(surface.wheel, s[i]))
            sample = sample if abs(s[i] - last) < NEXT else -1
            last = s[i]
        point, _, normal = on_circle(z, t, surface.radius, origin, rotation, x[i])
        at = project(surface.rail, point, normal, sample)
        turned, sample = _turned(at, origin), at.sample
        about_axle = rotation[0, 1] * turned[0] + rotation[1, 1] * turned[1] + rotation[2, 1] * turned[2]
        result.depth[i], result.slope[i], result.foot[i] = at.depth, -about_axle / surface.radius, at.foot


@compiled
def penetration_changes(surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array) -> PenetrationChanges:
    """`PenetrationChanges` at points s, x (n,) m across and along; fastest where neighbours share s."""
    n = len(s)
    result = PenetrationChanges(np.zeros((n, 6)), np.zeros((n, 6)))
    _store_changes(surface, origin, rotation, s, x, result)
    return result


@borrowing
def _store_changes(
    surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array, result: PenetrationChanges
) -> None:
    """Fill `penetration_changes`, which are zero."""
    n = len(s)
    if not surface.revolves:
        ax, ay = surface.upper
        for i in range(n):
            result.depth[i, 0] = 2 * ax * (x[i] - origin[0])
            result.depth[i, 1], result.depth[i, 2] = 2 * ay * (s[i] - origin[1]), -1.0
        return
    z, t, sample, last = 0j, 0j, -1, np.inf
    for i in range(n):
        if s[i] != last:
            z, t, _ = local(surface.wheel, s[i], piece(surface.wheel, s[i]))
            sample = sample if abs(s[i] - last) < NEXT else -1
            last = s[i]
        point, _, normal = on_circle(z, t, surface.radius, origin, rotation, x[i])
        at = project(surface.rail, point, normal, sample)
        sample = at.sample
        rx, ry, rz = point[0] - origin[0], point[1] - origin[1], point[2] - origin[2]
        result.depth[i, 1], result.depth[i, 2] = at.gradient.real, at.gradient.imag
        result.depth[i, 3], result.depth[i, 4], result.depth[i, 5] = _turned(at, origin)
        moves = result.foot[i]
        moves[1], moves[2] = at.moves.real, at.moves.imag
        moves[3] = ry * at.moves.imag - rz * at.moves.real
        moves[4], moves[5] = -rx * at.moves.imag, rx * at.moves.real


@compiled
def crests(surface: SurfaceData, origin: Array, rotation: Array, s: Array) -> tuple[Penetration, Array, Array]:
    """Largest penetration on the lines s (n,) m, its place (n,) m along x and the relative curvature (n,) 1/m there.

    Penetration is largest where the wheel's circle is parallel to the rail: where its tangent has no component along
    the rail's normal. Fastest where neighbours follow each other.
    """
    n = len(s)
    x, bend = np.zeros(n), np.empty(n)
    if not surface.revolves:
        a, b = surface.upper[0], surface.lower[0]
        x[:] = origin[0] * a / (a + b)
        bend[:] = 2 * (a + b)
        return penetration(surface, origin, rotation, s, x), x, bend
    _store_crests(surface, origin, rotation, s, x, bend)
    return penetration(surface, origin, rotation, s, x), x, bend


@borrowing
def _store_crests(surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array, bend: Array) -> None:
    """Fill places and curvatures of `crests` of a wheel; the places are zero."""
    wheel, radius, sample = surface.wheel, surface.radius, -1
    for i in range(len(s)):
        z, t, _ = local(wheel, s[i], piece(wheel, s[i]))
        r = z.imag + radius
        if rotation[1, 0] != 0.0:
            guess, sample = (x[i - 1], sample) if i > 0 and abs(s[i] - s[i - 1]) < NEXT else (0.0, -1)
            _, _, x[i], sample = lowest(surface.rail, radius, origin, rotation, z, t, guess, sample)
        bend[i] = max(r * t.real, 0.05 * r) / (radius * radius)


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
    places = SurfaceFrames(np.zeros((n, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3)), np.zeros(3))
    _store_frames(surface, origin, rotation, s, x, places)
    return places


@borrowing
def _store_frames(
    surface: SurfaceData, origin: Array, rotation: Array, s: Array, x: Array, places: SurfaceFrames
) -> None:
    """Fill `frames`, which are zero."""
    n = len(s)
    point, axes, forward, turn = places
    if surface.revolves:
        for c in range(3):
            turn[c] = -rotation[c, 1] / surface.radius
    z, t, last = 0j, 0j, np.inf
    for i in range(n):
        if surface.revolves:
            if s[i] != last:
                z, t, _ = local(surface.wheel, s[i], piece(surface.wheel, s[i]))
                last = s[i]
            write_frame(*on_circle(z, t, surface.radius, origin, rotation, x[i]), point, axes, i)
            rx, ry, rz = point[i, 0] - origin[0], point[i, 1] - origin[1], point[i, 2] - origin[2]
            forward[i, 0] = turn[1] * rz - turn[2] * ry
            forward[i, 1] = turn[2] * rx - turn[0] * rz
            forward[i, 2] = turn[0] * ry - turn[1] * rx
        else:
            point[i, 0], point[i, 1] = x[i], s[i]
            axes[i, 0, 0], axes[i, 1, 1], axes[i, 2, 2], forward[i, 0] = 1.0, 1.0, -1.0, 1.0


@compiled
def touching_changes(surface: SurfaceData, motion: Motion, s: Array, x: Array, feet: Array) -> tuple[Array, Array]:
    """Derivatives (n, 6) by the pose of the places of `crests` along x, and of the closest points on the lower body:
    these move along x with the former, which depend on the normals at the latter.

    Parameters:
        surface, motion: of both bodies.
        s, x: (n,) m, lines and places of the largest penetration on them.
        feet: (n,) m, arc length of the closest points.
    """
    n = len(s)
    crest, foot = np.zeros((n, 6)), penetration_changes(surface, motion.origin, motion.rotation, s, x).foot
    if surface.revolves:
        at = frames(surface, motion.origin, motion.rotation, s, x)
        _store_touching(surface, motion.rotation, at, feet, crest, foot)
    else:
        crest[:, 0] = surface.upper[0] / (surface.upper[0] + surface.lower[0])
    return crest, foot


@borrowing
def _store_touching(
    surface: SurfaceData, rotation: Array, at: SurfaceFrames, feet: Array, crest: Array, foot: Array
) -> None:
    """Fill crest and complete foot, which has the changes of fixed points, of `touching_changes` of a wheel."""
    rail = surface.rail
    for i in range(len(feet)):
        _, t, k = local(rail, feet[i], piece(rail, feet[i]))
        forward = rotation[2, 0] * t.real - rotation[1, 0] * t.imag
        up = rotation[2, 2] * t.real - rotation[1, 2] * t.imag
        # x = -R arctan(forward / up)
        by_forward = -surface.radius * up / (forward * forward + up * up)
        by_up = surface.radius * forward / (forward * forward + up * up)
        by_foot = by_forward * (rotation[2, 0] * k.real - rotation[1, 0] * k.imag)
        by_foot += by_up * (rotation[2, 2] * k.real - rotation[1, 2] * k.imag)
        by_crest = foot[i, 1] * at.forward[i, 1] + foot[i, 2] * at.forward[i, 2]
        for j in range(6):
            crest[i, j] = by_foot * foot[i, j]
        a = by_forward * rotation[0, 0] + by_up * rotation[0, 2]
        b = by_forward * rotation[1, 0] + by_up * rotation[1, 2]
        c = by_forward * rotation[2, 0] + by_up * rotation[2, 2]
        crest[i, 3] += b * t.real + c * t.imag  # the normal (0, -t.imag, t.real) rotates against the wheel's axes
        crest[i, 4] -= a * t.real
        crest[i, 5] -= a * t.imag
        for j in range(6):
            crest[i, j] /= 1.0 - by_foot * by_crest
            foot[i, j] += by_crest * crest[i, j]


@borrowing
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
    _store_shift(places, level, motion, np.empty((2, 3)), shift, slope, flow)
    return shift, slope, flow


@borrowing
def _store_shift(
    places: SurfaceFrames, level: Array, motion: Motion, arms: Array, shift: Array, slope: Array, flow: Array
) -> None:
    """Fill `rigid_shift`, which is zero; arms: (2, 3) work space."""
    arm, other_arm = arms[0], arms[1]
    for i in range(len(flow)):
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
