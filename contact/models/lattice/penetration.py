"""Undeformed penetration at points of strips, its derivatives by the pose and along x, and rigid slip there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.quadric_pair import curvature
from wheelrail.contact.geometry.wheel_surface import wheel_place
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.fitted.surfaces import NEXT, ProfileStrips, QuadricStrips, StripSurfaces
from wheelrail.meshes.curves.closest_point import Shape, foot, local, nearer_sample, nearest_sample, piece
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


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


class SurfaceFrames(NamedTuple):
    """Points (n, 3) m of the upper body and its axes (n, 3, 3) there: longitudinal, lateral and outward.

    forward (n, 3): change of the points along x; turn (3,) rad/m: rotation of the axes along x.
    """

    point: Array
    axes: Array
    forward: Array
    turn: Array


@compiled
def _wheel_on_rail(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, s: Array, x: Array
) -> Penetration:
    """`Penetration` of points s, x (n,) m of a wheel revolved about y on an extruded rail.

    With the closest point r(sigma) of the rail, (q - r) r' = 0, and the wheel's normal w the penetration is (q - r) w.
    """
    n = len(s)
    depth, slope, change = np.empty(n), np.empty(n), np.empty((n, 6))
    feet, feet_change = np.empty(n), np.empty((n, 6))
    point, axes = np.empty((1, 3)), np.empty((1, 3, 3))
    last, sample = complex(np.inf, 0.0), 0
    for i in range(n):
        wheel_place(wheel, radius, origin, rotation, s[i], x[i], point, axes, 0)
        q = complex(point[0, 1], point[0, 2])
        sample = nearer_sample(rail, q, sample) if abs(q - last) < NEXT else nearest_sample(rail, q)
        last = q
        feet[i], _, inside = foot(rail, q, rail.samples[sample])
        on_rail, t, k = local(rail, feet[i], piece(rail, feet[i]))
        away = q - on_rail
        wy, wz = axes[0, 2, 1], axes[0, 2, 2]
        depth[i] = away.real * wy + away.imag * wz if inside else -np.inf
        moves = 1.0 / (1.0 - (away.real * k.real + away.imag * k.imag))
        along = (t.real * wy + t.imag * wz) * moves
        gy, gz = wy - along * t.real, wz - along * t.imag
        _carried(point[0], origin, gy, gz, change[i])
        nx, ny, nz = axes[0, 2]
        change[i, 3] += ny * away.imag - nz * away.real
        change[i, 4] -= nx * away.imag
        change[i, 5] += nx * away.real
        _carried(point[0], origin, moves * t.real, moves * t.imag, feet_change[i])
        about_axle = 0.0
        for c in range(3):
            about_axle += rotation[c, 1] * change[i, 3 + c]
        slope[i] = -about_axle / radius
    return Penetration(depth, slope, change, feet, feet_change)


@compiled
def _carried(point: Array, origin: Array, gy: float, gz: float, change: Array) -> None:
    """Derivative (6,) of (0, gy, gz) times a point that moves with a frame."""
    rx, ry, rz = point - origin
    change[0], change[1], change[2] = 0.0, gy, gz
    change[3], change[4], change[5] = ry * gz - rz * gy, -rx * gz, rx * gy


@compiled
def _wheel_frames(
    wheel: Shape, radius: float, origin: Array, rotation: Array, s: Array, x: Array
) -> tuple[Array, Array]:
    """Points (n, 3) m and axes (n, 3, 3) of a wheel."""
    points, axes = np.empty((len(s), 3)), np.empty((len(s), 3, 3))
    for i in range(len(s)):
        wheel_place(wheel, radius, origin, rotation, s[i], x[i], points, axes, i)
    return points, axes


def penetration(surfaces: StripSurfaces, pose: Pose, s: Array, x: Array) -> Penetration:
    """Penetration at points s, x (n,) m across and along."""
    if isinstance(surfaces, ProfileStrips):
        shapes = surfaces.wheel.shape, surfaces.rail.shape
        return _wheel_on_rail(*shapes, surfaces.radius, pose.origin, np.ascontiguousarray(pose.rotation), s, x)
    assert isinstance(surfaces, QuadricStrips)
    (ax, ay), (bx, by) = curvature(surfaces.upper), curvature(surfaces.lower)
    X, Y, Z = pose.origin
    change = np.zeros((len(s), 6))
    change[:, 0], change[:, 1], change[:, 2] = 2 * ax * (x - X), 2 * ay * (s - Y), -1.0
    depth = -Z - ax * (x - X) ** 2 - ay * (s - Y) ** 2 - bx * x * x - by * s * s
    return Penetration(depth, -2 * ax * (x - X) - 2 * bx * x, change, s, np.zeros((len(s), 6)))


def frames(surfaces: StripSurfaces, pose: Pose, s: Array, x: Array) -> SurfaceFrames:
    """Points and axes at s, x (n,) m across and along."""
    if isinstance(surfaces, ProfileStrips):
        rotation = np.ascontiguousarray(pose.rotation)
        point, axes = _wheel_frames(surfaces.wheel.shape, surfaces.radius, pose.origin, rotation, s, x)
        turn = -rotation[:, 1] / surfaces.radius
        return SurfaceFrames(point, axes, np.cross(turn, point - pose.origin), turn)
    point = np.column_stack([x, s, np.zeros_like(x)])
    axes = np.broadcast_to(np.diag([1.0, 1.0, -1.0]), (len(x), 3, 3))
    return SurfaceFrames(point, axes, np.broadcast_to([1.0, 0.0, 0.0], (len(x), 3)), np.zeros(3))


def rigid_shift(places: SurfaceFrames, level: Array, motion: RigidMotion) -> tuple[Array, Array]:
    """Rigid tangential velocity (n, 2) m/s of the upper relative to the lower body, and its derivative (n, 2) along x.

    level (n, 3): longitudinal axes where the strips touch. Material flows along its own surface, and both surfaces end
    up in the common one: the velocity of the wheel counts along its circle, that of the rail, which is straight, along
    the level axis. Along the wheel's circle it would be smaller by x^2 / (2 R^2), as much as the creepage of a few
    per mille of saturation. The lateral axes turn along x, which is the spin of a conical wheel.
    """
    wheel, rail = motion.wheel, motion.rail
    tangent = places.axes[:, :2]
    straight = np.stack([level, tangent[:, 1]], axis=1)
    own, other = wheel.at(places.point), rail.at(places.point)
    shift = np.einsum("nkc,nc->nk", tangent, own) - np.einsum("nkc,nc->nk", straight, other)
    slope = np.einsum("nkc,nc->nk", tangent, np.cross(wheel.rotation, places.forward))
    slope += np.einsum("nkc,nc->nk", np.cross(places.turn, tangent), own)
    slope -= np.einsum("nkc,nc->nk", straight, np.cross(rail.rotation, places.forward))
    slope[:, 1] -= (np.cross(places.turn, tangent[:, 1]) * other).sum(axis=1)
    return shift, slope


def forward_flow(places: SurfaceFrames, motion: RigidMotion) -> Array:
    """Mean velocity (n,) m/s of both bodies along the longitudinal axes."""
    velocity = motion.wheel.at(places.point) + motion.rail.at(places.point)
    return np.asarray(0.5 * (velocity * places.axes[:, 0]).sum(axis=1))
