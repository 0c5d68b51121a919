"""Compiled force of one wheel on one rail from a table, and its derivative.

The interpolants have closed derivatives by their variables. The algebra between them is written once, for real and for
complex numbers: f(x + i h) = f(x) + i h f'(x) + O(h^2) gives its derivative. It works with tuples, which stay in
registers; small arrays would be allocated.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.models.table.interpolation import Grid, fast, nodes_of
from wheelrail.contact.models.table.lookup import LEVEL, LONGITUDINAL, contact_at, friction_at
from wheelrail.support.arrays import Array

Number = Any  # real or complex
Vector = tuple[Number, Number, Number]
Motion = tuple[Vector, Vector, Vector]  # of a body: velocity m/s, angular velocity rad/s, reference m
Friction = tuple[Grid, float]  # of a `FrictionTable`, and its coefficient
Place = tuple[float, float]  # radius, and nominal lateral position of the tread from the rail's origin, m
Pose = tuple[Vector, Vector, Vector]  # of the wheel: origin m, lateral and vertical axis
ARM = 0.01  # m, of the moments of friction
SCALE = 2e-3, 1e5  # creepage that about saturates a wheel with friction 0.3, at a load, N
STEP = 1e-30  # of complex arguments: their squares vanish, and derivatives are exact to round-off


@fast
def vector(values: Array) -> Vector:
    """Numbers of an array (3,)."""
    return values[0], values[1], values[2]


@fast
def unpacked(pose: tuple[Array, Array], twists: tuple[Array, ...]) -> tuple[Pose, Motion, Motion]:
    """Pose, and motion of wheel and rail, see `table_force`."""
    origin, rotation = pose
    velocity, rate, reference, rail_velocity, rail_rate, rail_reference = twists
    return (
        (vector(origin), vector(rotation[:, 1]), vector(rotation[:, 2])),
        (vector(velocity), vector(rate), vector(reference)),
        (vector(rail_velocity), vector(rail_rate), vector(rail_reference)),
    )


@fast
def tread_position(pose: Pose, place: Place) -> tuple[Vector, tuple[Number, Number, Number, Number]]:
    """Tread in the rail's axes; its lateral position from the nominal one, sine of roll, tangent of yaw and height."""
    (x, y, z), axle, up = pose
    radius, lateral = place
    tread = x - radius * up[0], y - radius * up[1], z - radius * up[2]
    return tread, (tread[1] - lateral, axle[2], -axle[0] / axle[1], tread[2])


@fast
def without_friction(tread: Vector, contact: NDArray[Any]) -> tuple[Number, Vector, Vector, Vector]:
    """Vertical load N, point of the resultant m, resultant N and couple about the point N m.

    Parameters:
        tread: position, m.
        contact: values (9,) of `contact_at`.
    """
    load = contact[0] * np.sqrt(contact[0])
    point = tread[0] + contact[1], tread[1] + contact[2], tread[2] + contact[3]
    couple = load * contact[6], load * contact[7], load * contact[8]
    return load, point, (load * contact[5], load * contact[4], load), couple


@fast
def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@fast
def velocity_at(point: Vector, motion: Motion) -> Vector:
    """Velocity, m/s, of a body's material at a point, m."""
    velocity, rate, reference = motion
    x, y, z = cross(rate, (point[0] - reference[0], point[1] - reference[1], point[2] - reference[2]))
    return velocity[0] + x, velocity[1] + y, velocity[2] + z


@fast
def scale_of_creepage(level: Number, coefficient: float) -> Number:
    """Creepage that saturates a wheel, about: proportional to friction and to the cube root of the load."""
    return SCALE[0] * coefficient / 0.3 * np.sqrt(level / SCALE[1] ** (2.0 / 3.0))


@fast
def normal_direction(resultant: Vector) -> tuple[Number, Number]:
    """Lateral and vertical component of the normal of a force."""
    length = np.sqrt(resultant[1] * resultant[1] + resultant[2] * resultant[2])
    return resultant[1] / length, resultant[2] / length


@fast
def friction_variables(
    friction: Friction, level: Number, point: Vector, resultant: Vector, wheel: Motion, rail: Motion
) -> tuple[Number, tuple[Number, Number, Number]]:
    """Rolling speed m/s; level, longitudinal and lateral coordinate of a `FrictionTable`.

    Below the smallest level its values are those of the smallest, beyond the largest creepages those of the same
    direction of slip; at speed 0 creepages are not finite.

    Parameters:
        friction: table.
        level, point, resultant: without friction, the point m and the force N.
        wheel, rail: motion.
    """
    grid, coefficient = friction
    own, other = velocity_at(point, wheel), velocity_at(point, rail)
    speed, (n_y, n_z) = -0.5 * (own[0] + other[0]), normal_direction(resultant)
    unit = speed * scale_of_creepage(level, coefficient)
    u, v = (own[0] - other[0]) / unit, ((own[1] - other[1]) * n_z - (own[2] - other[2]) * n_y) / unit
    largest = np.sinh(nodes_of(grid, LONGITUDINAL)[-1])
    if max(abs(u.real), abs(v.real)) > largest:
        edge = u if abs(u.real) > abs(v.real) else v
        factor = largest / (edge if edge.real > 0.0 else -edge)
        u, v = u * factor, v * factor
    lowest = nodes_of(grid, LEVEL)[0]
    if level.real < lowest:
        level = lowest + 0.0 * level
    return speed, (level, np.arcsinh(u), np.arcsinh(v))


@fast
def with_friction(resultant: Vector, couple: Vector, change: NDArray[Any], bound: Number) -> tuple[Vector, Vector]:
    """Force N and couple N m with the changes (6,) by friction times a bound N."""
    n_y, n_z = normal_direction(resultant)
    arm = ARM * bound
    force = (
        resultant[0] + bound * change[0],
        resultant[1] + bound * (n_z * change[1] + n_y * change[2]),
        resultant[2] + bound * (n_z * change[2] - n_y * change[1]),
    )
    return force, (couple[0] + arm * change[3], couple[1] + arm * change[4], couple[2] + arm * change[5])


@fast
def about_origin(force: Vector, couple: Vector, point: Vector) -> tuple[Number, ...]:
    """Force N, and moment N m about the rail's origin, of a force at a point and a couple."""
    x, y, z = cross(point, force)
    return force[0], force[1], force[2], couple[0] + x, couple[1] + y, couple[2] + z


@fast
def table_force(
    normal: Grid, friction: Friction, place: Place, pose: tuple[Array, Array], twists: tuple[Array, ...]
) -> Array:
    """Numbers (19,) of a `wheelrail.contact.models.table.force_table.TableForce`.

    Parameters:
        normal: of a `NormalTable`.
        friction: of a `FrictionTable`, with its coefficient.
        place: of the tread.
        pose: origin (3,) m and rotation (3, 3) of the wheel.
        twists: velocity, angular velocity and reference (3,) of the wheel, then of the rail, m/s, rad/s, m.

    Force is zero at negative levels and speeds; without friction and without contact the speed is 1.
    """
    place_of_wheel, wheel, rail = unpacked(pose, twists)
    tread, position = tread_position(place_of_wheel, place)
    depth, values = contact_at(normal, position, False)
    contact, speed, out = values[0], 1.0, np.zeros(19)
    level = contact[0]
    if level > 0.0:
        load, point, resultant, couple = without_friction(tread, contact)
        force = resultant
        if friction[1] > 0.0:
            speed, own = friction_variables(friction, level, point, resultant, wheel, rail)
            if speed > 0.0:
                change = friction_at(friction[0], position[:3] + own, False)[0]
                force, couple = with_friction(resultant, couple, change, friction[1] * load)
        if speed > 0.0:
            for k, value in enumerate(about_origin(force, couple, point)):
                out[k] = value
        for k in range(3):
            out[13 + k], out[16 + k] = point[k], resultant[k]
    for k in range(4):
        out[6 + k] = position[k]
    out[10], out[11], out[12] = level, depth, speed
    return out


@fast
def moved(values: Array, at: tuple[Number, ...]) -> NDArray[np.complex128]:
    """Values (n,), with their derivatives times the imaginary parts of m arguments as imaginary parts.

    Parameters:
        values: (1 + m, n), the first row values, the others derivatives.
        at: arguments.
    """
    out: NDArray[np.complex128] = values[0] + 0j
    for k in range(len(at)):
        for column in range(len(out)):
            out[column] += 1j * (values[1 + k, column] * at[k].imag)
    return out


@fast
def table_derivative(
    normal: Grid, friction: Friction, place: Place, pose: tuple[Array, Array], twists: tuple[Array, ...]
) -> Array:
    """Derivative (6, 12) of force and moment, see `wheelrail.contact.results.result.ContactResult.tangent`.

    Parameters: as for `table_force`, which gives the values; zero where there is no contact or speed.
    """
    columns = np.zeros((6, 12))
    place_of_wheel, wheel, rail = unpacked(pose, twists)
    tread, position = tread_position(place_of_wheel, place)
    _, contact = contact_at(normal, position, True)
    if not contact[0, 0] > 0.0:
        return columns
    change = np.zeros((7, 6))
    if friction[1] > 0.0:
        _, point, resultant, _ = without_friction(tread, contact[0])
        speed, own = friction_variables(friction, contact[0, 0], point, resultant, wheel, rail)
        if not speed > 0.0:
            return columns
        change = friction_at(friction[0], position[:3] + own, True)
    for k in range(12):
        stepped_place, stepped_wheel, stepped_rail = stepped(place_of_wheel, wheel, rail, k)
        tread_k, position_k = tread_position(stepped_place, place)
        contact_k = moved(contact, position_k)
        load, point_k, resultant_k, couple = without_friction(tread_k, contact_k)
        force = resultant_k
        if friction[1] > 0.0:
            _, own_k = friction_variables(friction, contact_k[0], point_k, resultant_k, stepped_wheel, stepped_rail)
            force, couple = with_friction(
                resultant_k, couple, moved(change, position_k[:3] + own_k), friction[1] * load
            )
        for row, value in enumerate(about_origin(force, couple, point_k)):
            columns[row, k] = value.imag / STEP
    return columns


@fast
def plus(values: Vector, change: Vector) -> Vector:
    """Sum of two vectors."""
    return values[0] + change[0], values[1] + change[1], values[2] + change[2]


@fast
def stepped(pose: Pose, wheel: Motion, rail: Motion, k: int) -> tuple[Pose, Motion, Motion]:
    """Pose, and motion of wheel and rail, with an imaginary step along change k of `ContactResult.tangent`."""
    step, none, axis = 1j * STEP, (0j, 0j, 0j), k % 3
    change = (step if axis == 0 else 0j, step if axis == 1 else 0j, step if axis == 2 else 0j)
    move, turn = change if k < 3 else none, change if 3 <= k < 6 else none
    origin, axle, up = pose
    velocity, rate, reference = wheel
    arm = reference[0] - origin[0], reference[1] - origin[1], reference[2] - origin[2]
    return (
        (plus(origin, move), plus(axle, cross(turn, axle)), plus(up, cross(turn, up))),
        (
            plus(velocity, change if 6 <= k < 9 else none),
            plus(rate, change if k >= 9 else none),
            plus(plus(reference, move), cross(turn, arm)),
        ),
        (plus(rail[0], none), plus(rail[1], none), plus(rail[2], none)),
    )
