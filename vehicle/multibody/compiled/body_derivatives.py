"""Derivatives of the motion of a body and of its accelerations, in closed form and compiled.

A change of the coordinates turns the axes of a body by a rotation vector t: changes of vectors v that turn with them
are t x v. Equations and symbols: `wheelrail.vehicle.multibody.compiled.bodies` and docs/theory/multibody.md.
"""

from __future__ import annotations

from typing import NamedTuple

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.compiled.bodies import Acceleration, BodyArrays, FrameMotion, Travel, projected
from wheelrail.vehicle.multibody.compiled.equations import BodySolution
from wheelrail.vehicle.multibody.compiled.vectors import (
    Vector,
    add,
    analytic,
    cross,
    dot,
    multiply,
    rotate,
    rotate_back,
    scale,
    subtract,
)

VERTICAL: Vector = (0.0, 0.0, 1.0)
# Components of a body's motion: position, rotation, velocity and angular velocity in common axes, three each; the
# distance along the track, the rate of the pitch and the time.
DISTANCE, SPIN, TIME = 12, 13, 14
COMPONENTS = 15


class Change(NamedTuple):
    """Derivatives of what the equations of a body depend on, by a coordinate, by its rate or by time.

    Parameters:
        distance, speed: along the track.
        shift, shift_rate: of the coordinates y and z in the track frame, and of their rates; x is zero.
        turn, turn_rate: of roll, pitch and yaw, and of their rates; the pitch rate with that of nominal rolling.
        hold: N, of the force that keeps the speed.
        path, rolling: of the accelerations of the reference motion and of nominal rolling.
        time: 1 or 0.
    """

    distance: float
    speed: float
    shift: Vector
    shift_rate: Vector
    turn: Vector
    turn_rate: Vector
    hold: float
    path: float
    rolling: float
    time: float


class FrameChange(NamedTuple):
    """Derivatives of a body's motion in its track frame.

    Parameters:
        frame_rate: of the rotation of the frame.
        body_turn: rotation vector of the axes.
        yaw, roll, spin: of the angular velocities about the vertical, the roll axis and the axle.
        roll_axis, axle: of these axes.
    """

    frame_rate: Vector
    body_turn: Vector
    yaw: Vector
    roll: Vector
    spin: Vector
    roll_axis: Vector
    axle: Vector


class BodyBase(NamedTuple):
    """A body in the motion about which derivatives are taken, in its track frame.

    Parameters:
        solution: accelerations and what they follow from.
        curvature: rad/m3, second derivative of the section's rotation per length.
        yaw, roll, spin: rad/s, angular velocities as vectors.
    """

    solution: BodySolution
    curvature: Vector
    yaw: Vector
    roll: Vector
    spin: Vector


@analytic
def body_base(solution: BodySolution, curvature: Vector, rate: Array) -> BodyBase:
    """A body with rates (6,) of its coordinates."""
    frame = solution.frame
    yaw, roll, spin = scale(rate[5], VERTICAL), scale(rate[3], frame.roll_axis), scale(frame.spin, frame.axle)
    return BodyBase(solution, curvature, yaw, roll, spin)


@analytic
def unit(index: int, direction: int) -> float:
    return 1.0 if index == direction else 0.0


@analytic
def coordinate_change(bodies: BodyArrays, i: int, d: int) -> Change:
    """Change by coordinate d < 6 or rate d - 6 of body i."""
    hold = 0.0
    if bodies.kept == i:
        hold = -bodies.hold_stiffness * unit(0, d) - bodies.hold_damping * unit(6, d)
    return Change(
        unit(0, d),
        unit(6, d),
        (0.0, unit(1, d), unit(2, d)),
        (0.0, unit(7, d), unit(8, d)),
        (unit(3, d), unit(4, d), unit(5, d)),
        (unit(9, d), unit(10, d), unit(11, d)),
        hold,
        0.0,
        0.0,
        0.0,
    )


@analytic
def time_change(bodies: BodyArrays, i: int, rates: Travel) -> Change:
    """Change of body i by time with the reference motion; rates: derivatives of this by time."""
    zero, wheelset = (0.0, 0.0, 0.0), bodies.wheelset[i]
    spin = wheelset * rates.speed / bodies.radius
    rolling = wheelset * rates.acceleration / bodies.radius
    return Change(
        rates.distance, rates.speed, zero, zero, zero, (0.0, spin, 0.0), 0.0, rates.acceleration, rolling, rates.time
    )


@analytic
def frame_change(base: BodyBase, wheelset: float, rate: Array, c: Change) -> FrameChange:
    """Derivatives of the motion in the track frame; rate (6,) of the coordinates."""
    frame, section = base.solution.frame, base.solution.section
    frame_rate = add(scale(c.speed, section.rate), scale(frame.speed * c.distance, section.rate_slope))
    yaw_turn = scale(c.turn[2], VERTICAL)
    axle_turn = add(yaw_turn, scale(c.turn[0], frame.roll_axis))
    roll_axis, axle = cross(yaw_turn, frame.roll_axis), cross(axle_turn, frame.axle)
    return FrameChange(
        frame_rate,
        add(axle_turn, scale((1.0 - wheelset) * c.turn[1], frame.axle)),  # the axes of wheelsets do not spin
        scale(c.turn_rate[2], VERTICAL),
        add(scale(c.turn_rate[0], frame.roll_axis), scale(rate[3], roll_axis)),
        add(scale(c.turn_rate[1], frame.axle), scale(frame.spin, axle)),
        roll_axis,
        axle,
    )


@analytic
def store_motion_change(base: BodyBase, wheelset: float, c: Change, f: FrameChange, values: Array, d: int) -> None:
    """Fill column d of the derivatives (15, k) of the body's motion."""
    frame, section, s = base.solution.frame, base.solution.section, c.distance
    velocity = add(frame.offset_rate, cross(frame.frame_rate, frame.offset))
    velocity = (velocity[0] + frame.speed, velocity[1], velocity[2])
    moved = add(c.shift_rate, add(cross(f.frame_rate, frame.offset), cross(frame.frame_rate, c.shift)))
    moved = add((moved[0] + c.speed, moved[1], moved[2]), scale(s, cross(section.rate, velocity)))
    spins = 1.0 - wheelset
    rate = add(add(frame.frame_rate, base.yaw), add(base.roll, scale(spins, base.spin)))
    turned = add(add(f.frame_rate, f.yaw), add(f.roll, scale(spins, f.spin)))
    turned = add(turned, scale(s, cross(section.rate, rate)))
    place = add(c.shift, scale(s, cross(section.rate, frame.offset)))
    position = rotate(section.axes, (place[0] + s, place[1], place[2]))
    turn = rotate(section.axes, add(scale(s, section.rate), f.body_turn))
    velocity, rate = rotate(section.axes, moved), rotate(section.axes, turned)
    for k in range(3):
        values[k, d], values[3 + k, d] = position[k], turn[k]
        values[6 + k, d], values[9 + k, d] = velocity[k], rate[k]
    values[DISTANCE, d], values[SPIN, d], values[TIME, d] = s, c.turn_rate[1], c.time


class Right(NamedTuple):
    """Changes of the right-hand sides of a body's equations at given accelerations.

    Parameters:
        force: N in the track frame, less that of mass times accelerations.
        moment: N m in the body's axes, likewise.
        force_bend, moment_bend: N and N m, by turning directions, of what holds coordinates along these.
    """

    force: Vector
    moment: Vector
    force_bend: Vector
    moment_bend: Vector


@analytic
def solved(change: Acceleration, right: Vector, bend: Vector, held: tuple[int, int, int], nominal: Vector) -> Vector:
    """Changes of the accelerations that belong to those of a right-hand side; nominal: of held coordinates."""
    p = projected(change.directions, right, held, nominal)
    bends = ((1.0 - held[0]) * bend[0], (1.0 - held[1]) * bend[1], (1.0 - held[2]) * bend[2])
    return rotate(change.inverse, subtract(p, bends))


@analytic
def store_solved(
    bodies: BodyArrays, i: int, base: BodyBase, right: Right, path: float, rolling: float, values: Array, d: int
) -> None:
    """Fill column d of the derivatives (6, k) of the accelerations of body i less nominal ones, path and rolling."""
    inertia = (bodies.inertia[i, 0], bodies.inertia[i, 1], bodies.inertia[i, 2])
    held = (bodies.held[i, 0], bodies.held[i, 1], bodies.held[i, 2])
    x = solved(base.solution.linear, right.force, right.force_bend, held, (path, 0.0, 0.0))
    gyration = multiply(inertia, rotate_back(base.solution.frame.rotation, scale(x[0], base.solution.section.rate)))
    held = (bodies.held[i, 3], bodies.held[i, 4], bodies.held[i, 5])
    y = solved(base.solution.angular, subtract(right.moment, gyration), right.moment_bend, held, (0.0, rolling, 0.0))
    values[0, d], values[1, d], values[2, d] = x[0] - path, x[1], x[2]
    values[3, d], values[4, d], values[5, d] = y[0], y[1] - rolling, y[2]


@analytic
def store_wrench_response(bodies: BodyArrays, i: int, base: BodyBase, values: Array) -> None:
    """Fill the derivatives (6, 6) of the accelerations of body i by force and moment in its track frame."""
    zero = (0.0, 0.0, 0.0)
    for d in range(3):
        along = (unit(0, d), unit(1, d), unit(2, d))
        store_solved(bodies, i, base, Right(along, zero, zero, zero), 0.0, 0.0, values, d)
        moment = rotate_back(base.solution.frame.rotation, along)
        store_solved(bodies, i, base, Right(zero, moment, zero, zero), 0.0, 0.0, values, 3 + d)


@analytic
def within(frame: FrameMotion, f: FrameChange, vector: Vector, change: Vector) -> Vector:
    """Change, in the body's axes, of a vector with a change in the track frame."""
    return rotate_back(frame.rotation, subtract(change, cross(f.body_turn, vector)))


@analytic
def store_acceleration_change(
    bodies: BodyArrays, i: int, base: BodyBase, c: Change, f: FrameChange, values: Array, d: int
) -> None:
    """Fill column d of the derivatives (6, k) of the accelerations of body i less nominal ones, at constant forces and
    moments of suspension and loads in common axes, and of the contacts in the track frame.
    """
    frame, section = base.solution.frame, base.solution.section
    s, rate = c.distance, frame.frame_rate
    mass, inertia = bodies.mass[i], (bodies.inertia[i, 0], bodies.inertia[i, 1], bodies.inertia[i, 2])
    # Translation: what the rotation of the sections adds to the accelerations, and the force in turning axes.
    slope, slope_change = section.rate_slope, scale(s, base.curvature)
    speed, squared = frame.speed, frame.speed * frame.speed
    inertial = scale(2.0 * speed * c.speed, cross(slope, frame.offset))
    inertial = add(inertial, scale(squared, add(cross(slope_change, frame.offset), cross(slope, c.shift))))
    inertial = add(inertial, cross(f.frame_rate, cross(rate, frame.offset)))
    inertial = add(inertial, cross(rate, add(cross(f.frame_rate, frame.offset), cross(rate, c.shift))))
    coriolis = add(cross(f.frame_rate, frame.offset_rate), cross(rate, c.shift_rate))
    inertial = add(inertial, scale(2.0, coriolis))
    turning = (c.speed * rate[2] + speed * f.frame_rate[2], c.speed * rate[1] + speed * f.frame_rate[1])
    inertial = add(inertial, (0.0, turning[0], -turning[1]))
    along = add(scale(s, cross(slope, frame.offset)), cross(section.rate, c.shift))
    inertial = add(inertial, scale(base.solution.linear.values[0], along))
    force = subtract((c.hold, 0.0, 0.0), scale(s, cross(section.rate, base.solution.force)))
    right = subtract(force, scale(mass, inertial))
    # Rotation in the body's axes.
    before_roll, path = add(rate, base.yaw), base.solution.linear.values[0]
    before_roll_change = add(f.frame_rate, f.yaw)
    before_spin, before_spin_change = add(before_roll, base.roll), add(before_roll_change, f.roll)
    bias = add(scale(path, section.rate), scale(squared, slope))
    bias = add(bias, cross(rate, base.yaw))
    bias = add(bias, add(cross(before_roll, base.roll), cross(before_spin, base.spin)))
    change = add(scale(path * s + 2.0 * speed * c.speed, slope), scale(squared, slope_change))
    change = add(change, add(cross(f.frame_rate, base.yaw), cross(rate, f.yaw)))
    change = add(change, add(cross(before_roll_change, base.roll), cross(before_roll, f.roll)))
    change = add(change, add(cross(before_spin_change, base.spin), cross(before_spin, f.spin)))
    whole = add(before_spin, base.spin)
    angular = rotate_back(frame.rotation, whole)
    angular_change = within(frame, f, whole, add(before_spin_change, f.spin))
    moment = within(frame, f, base.solution.whole, scale(-s, cross(section.rate, base.solution.moment)))
    gyroscopic = cross(angular_change, multiply(inertia, angular))
    gyroscopic = add(gyroscopic, cross(angular, multiply(inertia, angular_change)))
    about = subtract(subtract(moment, gyroscopic), multiply(inertia, within(frame, f, bias, change)))
    x = base.solution.angular.values
    roll, pitch = within(frame, f, frame.roll_axis, f.roll_axis), within(frame, f, frame.axle, f.axle)
    yaw = within(frame, f, VERTICAL, (0.0, 0.0, 0.0))
    momenta = add(add(scale(x[0], roll), scale(x[1], pitch)), scale(x[2], yaw))
    about = subtract(about, multiply(inertia, momenta))
    bends = dot(along, base.solution.linear.misfit), 0.0, 0.0
    misfit = base.solution.angular.misfit
    turned = dot(roll, misfit), dot(pitch, misfit), dot(yaw, misfit)
    store_solved(bodies, i, base, Right(right, about, bends, turned), c.path, c.rolling, values, d)
