"""Compiled look-up of the contact force of one wheel on one rail in a table."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.models.table.interpolation import Stencil, fast, stencil
from wheelrail.support.arrays import Array

Vector = tuple[complex, complex, complex]
Plane = tuple[NDArray[np.int64], NDArray[Any]]  # numbers of rows, and their weights
POINT, DIRECTION, COUPLE = 1, 4, 6  # first columns of the values of `NormalTable`, after the height
COLUMNS = 9


class NormalTable(NamedTuple):
    """Contact without friction.

    Parameters:
        y, roll, yaw: nodes m, rad, rad.
        level: nodes of (vertical load / N)^(2/3) from 0.
        rows: (y * roll * yaw, level * 9): height m of the tread above the nominal one; point of the resultant from the
            tread, m; lateral force, longitudinal force over the vertical one; moment about that point over it, m.

    The tread is the lowest point of the rolling circle, (0, 0, -radius) in the axes of the wheel without spin.
    """

    y: Array
    roll: Array
    yaw: Array
    level: Array
    rows: Array


class FrictionTable(NamedTuple):
    """Change of force and moment by friction.

    Parameters:
        y, roll, yaw, level: nodes as for `NormalTable`.
        longitudinal, lateral: nodes of asinh(creepage / scale), see `scale_of_creepage`.
        rows: (y * roll * yaw * level * longitudinal * lateral, 6): change of force along x, along the lateral tangent
            and along the normal, and of the moment about the same point in the axes of the track over `ARM`, all over
            friction coefficient times vertical load.
        coefficient: of friction; 0: the values are not read.
    """

    y: Array
    roll: Array
    yaw: Array
    level: Array
    longitudinal: Array
    lateral: Array
    rows: Array
    coefficient: float


ARM = 0.01  # m, of the moments of friction
SCALE = 2e-3, 1e5  # creepage that about saturates a wheel with friction 0.3, at a load, N


@fast
def tread_position(
    origin: Array, rotation: Array, radius: float, lateral: float
) -> tuple[complex, complex, complex, complex]:
    """Lateral position from the nominal one, height, sine of roll and tangent of yaw of a pose."""
    y = origin[1] - radius * rotation[1, 2] - lateral
    z = origin[2] - radius * rotation[2, 2]
    return y, z, rotation[2, 1], -rotation[0, 1] / rotation[1, 1]


@fast
def position_weights(table: NormalTable, y: complex, roll: complex, yaw: complex) -> Plane:
    """Numbers (n,) of the rows around a position, and their weights (n,)."""
    first_y, start_y, stop_y, weights_y = stencil(table.y, y)
    first_roll, start_roll, stop_roll, weights_roll = stencil(table.roll, roll)
    first_yaw, start_yaw, stop_yaw, weights_yaw = stencil(table.yaw, yaw)
    size = (stop_y - start_y) * (stop_roll - start_roll) * (stop_yaw - start_yaw)
    rows, weights = np.empty(size, np.int64), np.full(size, 0.0 * (y + roll + yaw))
    n = 0
    for i in range(start_y, stop_y):
        for j in range(start_roll, stop_roll):
            for k in range(start_yaw, stop_yaw):
                rows[n] = ((first_y + i) * len(table.roll) + first_roll + j) * len(table.yaw) + first_yaw + k
                weights[n] = weights_y[i] * weights_roll[j] * weights_yaw[k]
                n += 1
    return rows, weights


@fast
def heights_at(table: NormalTable, around: Plane) -> Array:
    """Heights (levels,) m of the tread at a position, from `position_weights`."""
    rows, weights = around
    heights = np.zeros(len(table.level), dtype=weights.dtype)
    for n in range(len(rows)):
        row, weight = rows[n], weights[n]
        for k in range(len(heights)):
            heights[k] += weight * table.rows[row, k * COLUMNS]
    return heights


@fast
def add_level(table: NormalTable, around: Plane, level: int, factor: complex, total: Array) -> None:
    """Add the values (9,) of one level at a position, times a factor, to a total; sums are kept in registers."""
    rows, weights = around
    first, values, zero = level * COLUMNS, table.rows, 0.0 * factor
    s0, s1, s2, s3, s4, s5, s6, s7, s8 = zero, zero, zero, zero, zero, zero, zero, zero, zero
    for n in range(len(rows)):
        row, weight = rows[n], weights[n]
        s0 += weight * values[row, first]
        s1 += weight * values[row, first + 1]
        s2 += weight * values[row, first + 2]
        s3 += weight * values[row, first + 3]
        s4 += weight * values[row, first + 4]
        s5 += weight * values[row, first + 5]
        s6 += weight * values[row, first + 6]
        s7 += weight * values[row, first + 7]
        s8 += weight * values[row, first + 8]
    for k, value in enumerate((s0, s1, s2, s3, s4, s5, s6, s7, s8)):
        total[k] += factor * value


@fast
def contact_at(table: NormalTable, y: complex, z: complex, roll: complex, yaw: complex) -> tuple[complex, Array, Array]:
    """Level, values (9,) at a position, and heights (levels,) m of the tread there.

    The level is negative without contact, and grows linearly beyond the last one.
    """
    around = position_weights(table, y, roll, yaw)
    heights = heights_at(table, around)
    values, zero = np.zeros(COLUMNS, dtype=heights.dtype), 0.0 * z
    if z.real >= heights[0].real:
        add_level(table, around, 0, zero + 1.0, values)
        return heights[0] - z, values, heights
    if z.real <= heights[-1].real:
        add_level(table, around, len(heights) - 1, zero + 1.0, values)
        return table.level[-1] * (1.0 + (heights[-1] - z) / (heights[0] - heights[-1])), values, heights
    first, start, stop, weights = stencil(-heights, -z)
    level = zero
    for k in range(start, stop):
        level = level + weights[k] * table.level[first + k]
        add_level(table, around, first + k, weights[k], values)
    return level, values, heights


@fast
def friction_at(
    table: FrictionTable, y: complex, roll: complex, yaw: complex, level: complex, creepage: tuple[complex, complex]
) -> Array:
    """Values (6,) of a `FrictionTable`; beyond its largest creepages those of the same direction of slip.

    Parameters:
        table: of friction.
        y, roll, yaw, level: of the contact.
        creepage: longitudinal and lateral over `scale_of_creepage`.
    """
    u, v = creepage
    largest = np.sinh(table.longitudinal[-1])
    if max(abs(u.real), abs(v.real)) > largest:
        edge = u if abs(u.real) > abs(v.real) else v
        factor = largest / (edge if edge.real > 0.0 else -edge)
        u, v = u * factor, v * factor
    a, b = np.arcsinh(u), np.arcsinh(v)
    if level.real < table.level[0]:
        level = table.level[0] + 0.0 * level
    first_y, start_y, stop_y, weights_y = stencil(table.y, y)
    first_roll, start_roll, stop_roll, weights_roll = stencil(table.roll, roll)
    first_yaw, start_yaw, stop_yaw, weights_yaw = stencil(table.yaw, yaw)
    first_level, start_level, stop_level, weights_level = stencil(table.level, level)
    total = np.full(6, 0.0 * (y + roll + yaw + level + a + b))
    plane = creepage_weights(stencil(table.longitudinal, a), stencil(table.lateral, b), len(table.lateral))
    size = len(table.longitudinal) * len(table.lateral)
    for i in range(start_y, stop_y):
        row_y = (first_y + i) * len(table.roll)
        for j in range(start_roll, stop_roll):
            row_roll = (row_y + first_roll + j) * len(table.yaw)
            for k in range(start_yaw, stop_yaw):
                position = weights_y[i] * weights_roll[j] * weights_yaw[k]
                row_yaw = (row_roll + first_yaw + k) * len(table.level)
                for m in range(start_level, stop_level):
                    add_plane(table.rows, (row_yaw + first_level + m) * size, plane, position * weights_level[m], total)
    return total


@fast
def creepage_weights(along_a: Stencil, along_b: Stencil, size_b: int) -> Plane:
    """Numbers (n,) of the rows around a pair of creepages, from that of the first pair of nodes, and weights (n,)."""
    first_a, start_a, stop_a, weights_a = along_a
    first_b, start_b, stop_b, weights_b = along_b
    rows = np.empty((stop_a - start_a) * (stop_b - start_b), np.int64)
    weights = np.full(len(rows), 0.0 * (weights_a[0] + weights_b[0]))
    n = 0
    for i in range(start_a, stop_a):
        for j in range(start_b, stop_b):
            rows[n], weights[n] = (first_a + i) * size_b + first_b + j, weights_a[i] * weights_b[j]
            n += 1
    return rows, weights


@fast
def add_plane(values: Array, first: int, plane: Plane, factor: complex, total: Array) -> None:
    """Add the interpolant over both creepages, times a factor, to a total (6,); sums are kept in registers."""
    rows, weights = plane
    zero = 0.0 * factor
    s0, s1, s2, s3, s4, s5 = zero, zero, zero, zero, zero, zero
    for n in range(len(rows)):
        row, weight = first + rows[n], weights[n]
        s0 += weight * values[row, 0]
        s1 += weight * values[row, 1]
        s2 += weight * values[row, 2]
        s3 += weight * values[row, 3]
        s4 += weight * values[row, 4]
        s5 += weight * values[row, 5]
    total[0] += factor * s0
    total[1] += factor * s1
    total[2] += factor * s2
    total[3] += factor * s3
    total[4] += factor * s4
    total[5] += factor * s5


@fast
def cross(a: Vector, b: Vector) -> Vector:
    """Vector product; tuples stay in registers where small arrays would be allocated."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@fast
def velocity_at(point: Array, velocity: NDArray[Any], rate: NDArray[Any], reference: NDArray[Any]) -> Vector:
    """Velocity, m/s, of a body's material at a point, m, from that at a reference and the angular velocity, rad/s."""
    arm = point[0] - reference[0], point[1] - reference[1], point[2] - reference[2]
    x, y, z = cross((rate[0], rate[1], rate[2]), arm)
    return velocity[0] + x, velocity[1] + y, velocity[2] + z


@fast
def scale_of_creepage(level: complex, coefficient: float) -> complex:
    """Creepage that saturates a wheel, about: proportional to friction and to the cube root of the load."""
    scale: complex = SCALE[0] * coefficient / 0.3 * np.sqrt(level / SCALE[1] ** (2.0 / 3.0))
    return scale


@fast
def table_force(
    normal: NormalTable,
    friction: FrictionTable,
    place: tuple[float, float],
    pose: tuple[NDArray[Any], NDArray[Any]],
    twists: tuple[NDArray[Any], ...],
) -> tuple[NDArray[Any], complex, complex, float, NDArray[Any], NDArray[Any]]:
    """Force and moment (6,) about the rail's origin, level, depth below the height of first contact, rolling speed,
    and point (3,) and force (3,) of the contact without friction.

    Parameters:
        normal, friction: tables.
        place: radius, and nominal lateral position of the tread from the rail's origin, m.
        pose: origin (3,) m and rotation (3, 3) of the wheel.
        twists: velocity, angular velocity and reference (3,) of the wheel, then of the rail, m/s, rad/s, m.

    Arrays are all real or all complex. Force is zero at negative levels and speeds; without friction the speed is 1.
    """
    origin, rotation = pose
    radius, lateral = place
    y, z, roll, yaw = tread_position(origin, rotation, radius, lateral)
    level, values, heights = contact_at(normal, y, z, roll, yaw)
    depth = heights[0] - z
    point = np.empty(3, dtype=origin.dtype)
    for k in range(3):
        point[k] = origin[k] - radius * rotation[k, 2] + values[POINT + k]
    total, resultant, speed = np.zeros(6, dtype=origin.dtype), np.zeros(3, dtype=origin.dtype), 1.0
    if level.real <= 0.0:
        return total, level, depth, speed, point, resultant
    load = level * np.sqrt(level)
    x, y_force, z_force = load * values[DIRECTION + 1], load * values[DIRECTION], load
    resultant[0], resultant[1], resultant[2] = x, y_force, z_force
    for k in range(3):
        total[3 + k] = load * values[COUPLE + k]
    if friction.coefficient > 0.0:
        wheel, rail = (
            velocity_at(point, twists[0], twists[1], twists[2]),
            velocity_at(point, twists[3], twists[4], twists[5]),
        )
        rolling = -0.5 * (wheel[0] + rail[0])
        speed = rolling.real
        if not speed > 0.0:
            total[:] = 0.0
            return total, level, depth, speed, point, resultant
        length = np.sqrt(y_force * y_force + z_force * z_force)
        n_y, n_z = y_force / length, z_force / length
        unit = rolling * scale_of_creepage(level, friction.coefficient)
        slip = wheel[0] - rail[0], wheel[1] - rail[1], wheel[2] - rail[2]
        creepage = slip[0] / unit, (slip[1] * n_z - slip[2] * n_y) / unit
        change, bound = friction_at(friction, y, roll, yaw, level, creepage), friction.coefficient * load
        x += bound * change[0]
        y_force += bound * (n_z * change[1] + n_y * change[2])
        z_force += bound * (n_z * change[2] - n_y * change[1])
        for k in range(3):
            total[3 + k] += ARM * bound * change[3 + k]
    moment = cross((point[0], point[1], point[2]), (x, y_force, z_force))
    total[0], total[1], total[2] = x, y_force, z_force
    for k in range(3):
        total[3 + k] += moment[k]
    return total, level, depth, speed, point, resultant
