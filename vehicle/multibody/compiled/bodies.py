"""Motion of a body in the track frame at its own distance, and its accelerations, in compiled code.

Equations and symbols: `wheelrail.vehicle.multibody.body_motion` and docs/theory/multibody.md.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Nodes
from wheelrail.vehicle.multibody.compiled.sections import Section
from wheelrail.vehicle.multibody.compiled.vectors import (
    Matrix,
    Vector,
    add,
    analytic,
    body_rotation,
    cross,
    dot,
    load,
    multiply,
    product,
    rotate,
    rotate_back,
    scale,
    subtract,
)


class BodyArrays(NamedTuple):
    """Bodies (n,).

    Parameters:
        place, height: m, of the centre of mass along the vehicle and above top of rail.
        mass: kg.
        inertia: (n, 3) kg m2.
        wheelset: (n,) 1 for wheelsets, otherwise 0.
        radius: nominal rolling radius, m.
        gravity: m/s2.
        held: (n, 6) 1 for held coordinates, otherwise 0.
        kept: index of the body whose place the speed hold keeps; -1: none.
        hold_stiffness, hold_damping: N/m and N s/m.
    """

    place: Array
    height: Array
    mass: Array
    inertia: Array
    wheelset: Array
    radius: float
    gravity: float
    held: Nodes
    kept: int
    hold_stiffness: float
    hold_damping: float


class Travel(NamedTuple):
    """Reference motion along the track: distance m, speed m/s, acceleration m/s2; and time s."""

    distance: float
    speed: float
    acceleration: float
    time: float


class FrameMotion(NamedTuple):
    """Motion of a body in its track frame, see `wheelrail.vehicle.multibody.body_motion.RelativeMotion`."""

    speed: float
    offset: Vector
    offset_rate: Vector
    frame_rate: Vector
    roll_axis: Vector
    axle: Vector
    spin: float
    rotation: Matrix


class Motion(NamedTuple):
    """Position m, velocity m/s, axes and their angular velocity rad/s of a body, in common axes."""

    position: Vector
    velocity: Vector
    axes: Matrix
    rate: Vector


@analytic
def motion_in(rows: Array) -> Motion:
    """Motion of rows (6, 3): position, velocity, axes, angular velocity."""
    return Motion(load(rows[0]), load(rows[1]), (load(rows[2]), load(rows[3]), load(rows[4])), load(rows[5]))


@analytic
def frame_motion(bodies: BodyArrays, i: int, travel: Travel, section: Section, q: Array, rate: Array) -> FrameMotion:
    """Motion of body i with coordinates q (6,) and their rates (6,)."""
    speed, roll, yaw = travel.speed + rate[0], q[3], q[5]
    pitch = q[4] * (1.0 - bodies.wheelset[i])  # the axes of wheelsets do not spin
    cr, sr, cy, sy = np.cos(roll), np.sin(roll), np.cos(yaw), np.sin(yaw)
    return FrameMotion(
        speed,
        (0.0, q[1], bodies.height[i] + q[2]),
        (0.0, rate[1], rate[2]),
        scale(speed, section.rate),
        (cy, sy, 0.0),
        (-sy * cr, cy * cr, sr),
        rate[4] + bodies.wheelset[i] * travel.speed / bodies.radius,
        body_rotation(roll, pitch, yaw),
    )


@analytic
def motion_of(bodies: BodyArrays, i: int, section: Section, frame: FrameMotion, rate: Array) -> Motion:
    """Motion of body i in common axes; rate (6,) of its coordinates."""
    velocity = add(frame.offset_rate, cross(frame.frame_rate, frame.offset))
    velocity = (velocity[0] + frame.speed, velocity[1], velocity[2])
    turn = add(frame.frame_rate, scale(rate[3], frame.roll_axis))
    turn = (turn[0], turn[1], turn[2] + rate[5])
    turn = add(turn, scale((1.0 - bodies.wheelset[i]) * frame.spin, frame.axle))
    return Motion(
        add(section.position, rotate(section.axes, frame.offset)),
        rotate(section.axes, velocity),
        product(section.axes, frame.rotation),
        rotate(section.axes, turn),
    )


class Acceleration(NamedTuple):
    """Second derivatives of three coordinates, and what their derivatives need.

    Parameters:
        values: second derivatives x.
        directions: vectors of the velocities that belong to the coordinates.
        misfit: N or N m, sum_j m_j x_j less the force or moment: what holds coordinates.
        inverse: of the equations of x.
    """

    values: Vector
    directions: Matrix
    misfit: Vector
    inverse: Matrix


@analytic
def projected(directions: Matrix, vector: Vector, held: tuple[int, int, int], nominal: Vector) -> Vector:
    """Right-hand sides of `constrained`: products with the directions of free coordinates, nominal for held ones."""
    return (
        dot(directions[0], vector) if held[0] == 0 else nominal[0],
        dot(directions[1], vector) if held[1] == 0 else nominal[1],
        dot(directions[2], vector) if held[2] == 0 else nominal[2],
    )


@analytic
def constrained(
    directions: Matrix, momenta: Matrix, right: Vector, held: tuple[int, int, int], nominal: Vector
) -> Acceleration:
    """Solution x of d_k . (sum_j m_j x_j - right) = 0 for free coordinates k, x_k nominal for held ones.

    Parameters:
        directions: vectors d_k of the velocities that belong to the coordinates.
        momenta: vectors m_k, mass or inertia times d_k.
        right: force or moment without what the accelerations cause.
        held: 1 where a coordinate is held.
        nominal: second derivatives of held coordinates.
    """
    a = rotate_back(momenta, directions[0]) if held[0] == 0 else (1.0, 0.0, 0.0)
    b = rotate_back(momenta, directions[1]) if held[1] == 0 else (0.0, 1.0, 0.0)
    c = rotate_back(momenta, directions[2]) if held[2] == 0 else (0.0, 0.0, 1.0)
    normal = cross(b, c)
    size = 1.0 / dot(a, normal)
    inverse = (scale(size, normal), scale(size, cross(c, a)), scale(size, cross(a, b)))
    x = rotate(inverse, projected(directions, right, held, nominal))
    return Acceleration(x, directions, subtract(rotate(momenta, x), right), inverse)


@analytic
def translation(
    bodies: BodyArrays, i: int, section: Section, frame: FrameMotion, force: Vector, path: float
) -> Acceleration:
    """Accelerations m/s2 along the path, in y and in z of body i under a force N in its track frame.

    path: acceleration of the reference motion, m/s2.
    """
    rate = frame.frame_rate
    inertial = scale(frame.speed * frame.speed, cross(section.rate_slope, frame.offset))
    inertial = add(inertial, cross(rate, cross(rate, frame.offset)))
    inertial = add(inertial, scale(2.0, cross(rate, frame.offset_rate)))
    inertial = add(inertial, (0.0, frame.speed * rate[2], -frame.speed * rate[1]))
    lever = cross(section.rate, frame.offset)
    directions = ((1.0 + lever[0], lever[1], lever[2]), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    held, mass = (bodies.held[i, 0], bodies.held[i, 1], bodies.held[i, 2]), bodies.mass[i]
    momenta = (scale(mass, directions[0]), scale(mass, directions[1]), scale(mass, directions[2]))
    return constrained(directions, momenta, subtract(force, scale(mass, inertial)), held, (path, 0.0, 0.0))


@analytic
def rotation(
    bodies: BodyArrays,
    i: int,
    section: Section,
    frame: FrameMotion,
    rate: Array,
    moment: Vector,
    path: float,
    rolling: float,
) -> Acceleration:
    """Second derivatives rad/s2 of roll, pitch and yaw of body i; the pitch of a wheelset with nominal rolling.

    Parameters:
        bodies, i: all bodies, and index of this one.
        section, frame: track section and motion in it.
        rate: (6,) of the coordinates.
        moment: N m in the track frame.
        path: acceleration along the path, m/s2.
        rolling: second derivative of the nominal pitch, rad/s2.
    """
    axes, vertical = frame.rotation, (0.0, 0.0, 1.0)
    yaw_rate, roll_rate, spin = scale(rate[5], vertical), scale(rate[3], frame.roll_axis), scale(frame.spin, frame.axle)
    before_roll = add(frame.frame_rate, yaw_rate)
    before_spin = add(before_roll, roll_rate)
    bias = add(scale(path, section.rate), scale(frame.speed * frame.speed, section.rate_slope))
    bias = add(bias, cross(frame.frame_rate, yaw_rate))
    bias = add(bias, add(cross(before_roll, roll_rate), cross(before_spin, spin)))
    inertia = (bodies.inertia[i, 0], bodies.inertia[i, 1], bodies.inertia[i, 2])
    angular = rotate_back(axes, add(before_spin, spin))
    free = subtract(rotate_back(axes, moment), cross(angular, multiply(inertia, angular)))
    free = subtract(free, multiply(inertia, rotate_back(axes, bias)))
    roll, pitch, yaw = (
        rotate_back(axes, frame.roll_axis),
        rotate_back(axes, frame.axle),
        rotate_back(axes, vertical),
    )
    momenta = (multiply(inertia, roll), multiply(inertia, pitch), multiply(inertia, yaw))
    held = (bodies.held[i, 3], bodies.held[i, 4], bodies.held[i, 5])
    return constrained((roll, pitch, yaw), momenta, free, held, (0.0, rolling, 0.0))
