"""Motion of a body in the track frame at its own distance, and its accelerations, in compiled code.

Equations and symbols: `wheelrail.vehicle.multibody.body_motion` and docs/theory/multibody.md.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Complex
from wheelrail.vehicle.multibody.compiled.sections import Section
from wheelrail.vehicle.multibody.compiled.vectors import (
    Matrix,
    Vector,
    add,
    analytic,
    body_rotation,
    cross,
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
        held: index of the body whose place the speed hold keeps; -1: none.
        hold_stiffness, hold_damping: N/m and N s/m.
    """

    place: Array
    height: Array
    mass: Array
    inertia: Array
    wheelset: Array
    radius: float
    gravity: float
    held: int
    hold_stiffness: float
    hold_damping: float


class Travel(NamedTuple):
    """Reference motion along the track: distance m, speed m/s and acceleration m/s2."""

    distance: complex
    speed: complex
    acceleration: complex


class FrameMotion(NamedTuple):
    """Motion of a body in its track frame, see `wheelrail.vehicle.multibody.body_motion.RelativeMotion`."""

    speed: complex
    offset: Vector
    offset_rate: Vector
    frame_rate: Vector
    roll_axis: Vector
    axle: Vector
    spin: complex
    rotation: Matrix


class Motion(NamedTuple):
    """Position m, velocity m/s, axes and their angular velocity rad/s of a body, in common axes."""

    position: Vector
    velocity: Vector
    axes: Matrix
    rate: Vector


@analytic
def frame_motion(
    bodies: BodyArrays, i: int, travel: Travel, section: Section, q: Complex, rate: Complex
) -> FrameMotion:
    """Motion of body i with coordinates q (6,) and their rates (6,)."""
    speed, roll, yaw, zero = travel.speed + rate[0], q[3], q[5], 0.0 * q[0]
    pitch = q[4] * (1.0 - bodies.wheelset[i])  # the axes of wheelsets do not spin
    cr, sr, cy, sy = np.cos(roll), np.sin(roll), np.cos(yaw), np.sin(yaw)
    return FrameMotion(
        speed,
        (zero, q[1], bodies.height[i] + q[2]),
        (zero, rate[1], rate[2]),
        scale(speed, section.rate),
        (cy, sy, zero),
        (-sy * cr, cy * cr, sr),
        rate[4] + bodies.wheelset[i] * travel.speed / bodies.radius,
        body_rotation(roll, pitch, yaw),
    )


@analytic
def motion_of(bodies: BodyArrays, i: int, section: Section, frame: FrameMotion, rate: Complex) -> Motion:
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


@analytic
def translation(bodies: BodyArrays, i: int, section: Section, frame: FrameMotion, force: Vector) -> Vector:
    """Accelerations m/s2 along the path, in y and in z of body i under a force N in its track frame."""
    rate = frame.frame_rate
    inertial = scale(frame.speed * frame.speed, cross(section.rate_slope, frame.offset))
    inertial = add(inertial, cross(rate, cross(rate, frame.offset)))
    inertial = add(inertial, scale(2.0, cross(rate, frame.offset_rate)))
    inertial = add(inertial, (0.0 * frame.speed, frame.speed * rate[2], -frame.speed * rate[1]))
    free, lever = subtract(scale(1.0 / bodies.mass[i], force), inertial), cross(section.rate, frame.offset)
    path = free[0] / (1.0 + lever[0])
    return path, free[1] - path * lever[1], free[2] - path * lever[2]


@analytic
def rotation(
    bodies: BodyArrays, i: int, section: Section, frame: FrameMotion, rate: Complex, moment: Vector, path: complex
) -> Vector:
    """Second derivatives rad/s2 of roll, pitch and yaw of body i.

    Parameters:
        bodies, i: all bodies, and index of this one.
        section, frame: track section and motion in it.
        rate: (6,) of the coordinates.
        moment: N m in the track frame.
        path: acceleration along the path, m/s2.
    """
    zero = 0.0 * path
    yaw_rate, roll_rate, spin = (zero, zero, rate[5]), scale(rate[3], frame.roll_axis), scale(frame.spin, frame.axle)
    before_roll = add(frame.frame_rate, yaw_rate)
    before_spin = add(before_roll, roll_rate)
    bias = add(scale(path, section.rate), scale(frame.speed * frame.speed, section.rate_slope))
    bias = add(bias, cross(frame.frame_rate, yaw_rate))
    bias = add(bias, add(cross(before_roll, roll_rate), cross(before_spin, spin)))
    inertia = (bodies.inertia[i, 0], bodies.inertia[i, 1], bodies.inertia[i, 2])
    angular = rotate_back(frame.rotation, add(before_spin, spin))
    right = subtract(rotate_back(frame.rotation, moment), cross(angular, multiply(inertia, angular)))
    x, y, z = subtract(
        rotate(frame.rotation, (right[0] / inertia[0], right[1] / inertia[1], right[2] / inertia[2])), bias
    )
    cos_yaw, sin_yaw, sin_roll = frame.roll_axis[0], frame.roll_axis[1], frame.axle[2]
    pitch = (cos_yaw * y - sin_yaw * x) / np.sqrt(1.0 - sin_roll * sin_roll)
    return cos_yaw * x + sin_yaw * y, pitch, z - sin_roll * pitch
