"""Derivatives of torques on wheelsets and of forces on bodies by the motions of the bodies, in compiled code."""

from __future__ import annotations

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.compiled.applied_loads import LoadArrays, axle_spin, table_piece, table_value
from wheelrail.vehicle.multibody.compiled.bodies import BodyArrays, Travel, motion_in
from wheelrail.vehicle.multibody.compiled.body_derivatives import DISTANCE, SPIN, TIME
from wheelrail.vehicle.multibody.compiled.element_derivatives import IDENTITY, SuspensionSlopes
from wheelrail.vehicle.multibody.compiled.sections import section_of
from wheelrail.vehicle.multibody.compiled.vectors import (
    Matrix,
    Vector,
    add,
    analytic,
    cross,
    crossing,
    dot,
    dyad,
    plus,
    product,
    rotate,
    scale,
    subtract,
    times,
)

TURN, RATE = 3, 9  # first components of the rotation and of the angular velocity of a body


@analytic
def add_matrix(values: Array, row: int, column: int, matrix: Matrix) -> None:
    """Add to rows and columns of values from a row and a column on."""
    for d in range(3):
        for k in range(3):
            values[row + d, column + k] += matrix[k][d]


@analytic
def add_column(values: Array, row: int, column: int, vector: Vector) -> None:
    """Add to three rows of a column."""
    for d in range(3):
        values[row + d, column] += vector[d]


@analytic
def add_torque(
    bodies: BodyArrays,
    loads: LoadArrays,
    p: int,
    travel: Travel,
    state: Array,
    motions: Array,
    result: SuspensionSlopes,
) -> None:
    """Add the derivatives of torque p; parameters as for `add_load_slopes`."""
    i, j, table = loads.wheelset[p], loads.reaction[p], loads.torque[p]
    wheelset, other, distance = motion_in(motions[i]), motion_in(motions[j]), travel.distance + state[6 * i]
    axle, difference = wheelset.axes[1], subtract(wheelset.rate, other.rate)
    size, factor, by_spin = table_value(loads, table, travel.time, distance), 1.0, 0.0
    if loads.brake[p] == 1:
        spin = axle_spin(bodies, i, travel, state, wheelset, other)
        factor = -1.0 if spin > 0.0 else 1.0
        if abs(spin) < loads.release:
            factor, by_spin = -spin / loads.release, -size / loads.release
    by_turn = times(-size * factor, crossing(axle))
    by_turn = plus(by_turn, times(by_spin, dyad(axle, cross(axle, difference))))
    slope = factor * table_piece(loads, table, travel.time, distance)[2]
    column = DISTANCE if loads.by_distance[table] == 1 else TIME
    for sign, body in ((1.0, i), (-1.0, j)):
        own, others = result.wrench[body, i], result.wrench[body, j]
        result.coupled[body, i] = result.coupled[body, j] = 1
        add_matrix(own, 3, TURN, times(sign, by_turn))
        add_matrix(own, 3, RATE, times(sign * by_spin, dyad(axle, axle)))
        add_column(own, 3, SPIN, scale(sign * by_spin, axle))
        add_column(own, 3, column, scale(sign * slope, axle))
        add_matrix(others, 3, RATE, times(-sign * by_spin, dyad(axle, axle)))


@analytic
def add_force(
    bodies: BodyArrays, loads: LoadArrays, f: int, travel: Travel, state: Array, rows: Array, motions: Array,
    result: SuspensionSlopes,
) -> None:  # fmt: skip
    """Add the derivatives of force f; parameters as for `add_load_slopes`."""
    i = loads.body[f]
    section, motion, distance = section_of(rows[i]), motion_in(motions[i]), travel.distance + state[6 * i]
    own, across = result.wrench[i, i], IDENTITY
    tables = (loads.force[f, 0], loads.force[f, 1], loads.force[f, 2])
    local = (
        table_value(loads, tables[0], travel.time, distance),
        table_value(loads, tables[1], travel.time, distance),
        table_value(loads, tables[2], travel.time, distance),
    )
    arm, force = rotate(motion.axes, (loads.arm[f, 0], loads.arm[f, 1], loads.arm[f, 2])), rotate(section.axes, local)
    by_turn, axle, moment = product(crossing(force), crossing(arm)), motion.axes[1], cross(arm, force)
    if bodies.wheelset[i] > 0.0:
        across = plus(IDENTITY, times(-1.0, dyad(axle, axle)))
        by_turn = plus(product(across, by_turn), times(dot(moment, axle), crossing(axle)))
        by_turn = plus(by_turn, times(-1.0, dyad(axle, cross(axle, moment))))
    result.coupled[i, i] = 1
    add_matrix(own, 3, TURN, by_turn)
    by_distance, by_time = rotate(section.axes, cross(section.rate, local)), scale(0.0, local)
    for k in range(3):
        change = scale(table_piece(loads, tables[k], travel.time, distance)[2], section.axes[k])
        if loads.by_distance[tables[k]] == 1:
            by_distance = add(by_distance, change)
        else:
            by_time = add(by_time, change)
    for column, change in ((DISTANCE, by_distance), (TIME, by_time)):
        add_column(own, 0, column, change)
        add_column(own, 3, column, rotate(across, cross(arm, change)))


@analytic
def add_load_slopes(
    bodies: BodyArrays,
    loads: LoadArrays,
    travel: Travel,
    state: Array,
    rows: Array,
    motions: Array,
    result: SuspensionSlopes,
) -> None:
    """Add the derivatives of the forces and moments of all loads; parameters as for
    `wheelrail.vehicle.multibody.compiled.applied_loads.add_loads`.
    """
    for p in range(len(loads.wheelset)):
        add_torque(bodies, loads, p, travel, state, motions, result)
    for f in range(len(loads.body)):
        add_force(bodies, loads, f, travel, state, rows, motions, result)
