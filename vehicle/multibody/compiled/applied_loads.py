"""Torques on wheelsets and forces on bodies in compiled code.

Definition: `wheelrail.vehicle.multibody.applied_forces`, and docs/theory/multibody.md.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import unchecked
from wheelrail.vehicle.multibody.compiled.bodies import BodyArrays, Motion, Travel, motion_in
from wheelrail.vehicle.multibody.compiled.vectors import (
    Vector,
    add,
    analytic,
    cross,
    dot,
    load,
    rotate,
    scale,
    store,
    subtract,
)


class LoadArrays(NamedTuple):
    """Torques (p,), forces (f,) and their tables (t,).

    Parameters:
        wheelset, reaction: (p,) indices of the bodies.
        brake: (p,) 1 for friction brakes, otherwise 0.
        torque: (p,) tables.
        release: rad/s, rate of rotation from which on friction brakes have their full torque.
        body: (f,) indices.
        arm: (f, 3) m, from the centre of mass, in the body's axes.
        force: (f, 3) tables of the components.
        starts: (t + 1,) of the points of each table.
        by_distance: (t,) 1 for tables over distance, 0 for those over time.
        abscissae, values: of all points.
    """

    wheelset: Nodes
    reaction: Nodes
    brake: Nodes
    torque: Nodes
    release: float
    body: Nodes
    arm: Array
    force: Nodes
    starts: Nodes
    by_distance: Nodes
    abscissae: Array
    values: Array


@analytic
def table_piece(loads: LoadArrays, table: int, time: float, distance: float) -> tuple[int, float, float]:
    """Point of a table before a time s or a distance m, or its first one; the distance from it, and the slope."""
    at = distance if loads.by_distance[table] == 1 else time
    i, last, slope = loads.starts[table], loads.starts[table + 1] - 1, 0.0
    while i < last and at >= loads.abscissae[i + 1]:
        i += 1
    if i < last and at >= loads.abscissae[i]:
        slope = (loads.values[i + 1] - loads.values[i]) / (loads.abscissae[i + 1] - loads.abscissae[i])
    return i, at - loads.abscissae[i], slope


@analytic
def table_value(loads: LoadArrays, table: int, time: float, distance: float) -> float:
    """Value of a table at a time s and a distance m; constant before its first and behind its last point."""
    i, beyond, slope = table_piece(loads, table, time, distance)
    value: float = loads.values[i] + slope * beyond
    return value


@analytic
def axle_spin(bodies: BodyArrays, i: int, travel: Travel, state: Array, wheelset: Motion, other: Motion) -> float:
    """Rate of rotation rad/s of wheelset i about its axle, relative to another body."""
    own = state[6 * len(bodies.mass) + 6 * i + 4] + travel.speed / bodies.radius
    spin: float = own + dot(subtract(wheelset.rate, other.rate), wheelset.axes[1])
    return spin


@analytic
def axle_torque(bodies: BodyArrays, loads: LoadArrays, p: int, travel: Travel, state: Array, motions: Array) -> Vector:
    """Torque N m on a wheelset, in common axes; parameters as for `add_loads`."""
    i = loads.wheelset[p]
    wheelset, other = motion_in(motions[i]), motion_in(motions[loads.reaction[p]])
    size = table_value(loads, loads.torque[p], travel.time, travel.distance + state[6 * i])
    if loads.brake[p] == 1:
        spin = axle_spin(bodies, i, travel, state, wheelset, other)
        if spin > loads.release:
            size = -size
        elif spin > -loads.release:
            size = -size * spin / loads.release
    return scale(size, wheelset.axes[1])


@analytic
def body_force(loads: LoadArrays, f: int, travel: Travel, state: Array, rows: Array) -> Vector:
    """Force N on a body, in common axes; parameters as for `add_loads`."""
    i = loads.body[f]
    distance = travel.distance + state[6 * i]
    x = table_value(loads, loads.force[f, 0], travel.time, distance)
    y = table_value(loads, loads.force[f, 1], travel.time, distance)
    z = table_value(loads, loads.force[f, 2], travel.time, distance)
    return rotate((load(rows[i, 1]), load(rows[i, 2]), load(rows[i, 3])), (x, y, z))


@analytic
def force_moment(bodies: BodyArrays, loads: LoadArrays, f: int, motion: Motion, force: Vector) -> Vector:
    """Moment N m of a force about the centre of its body; on a wheelset, whose bearings turn, none about the axle."""
    arm = (loads.arm[f, 0], loads.arm[f, 1], loads.arm[f, 2])
    moment = cross(rotate(motion.axes, arm), force)
    if bodies.wheelset[loads.body[f]] > 0.0:
        moment = subtract(moment, scale(dot(moment, motion.axes[1]), motion.axes[1]))
    return moment


@unchecked
def add_loads(
    bodies: BodyArrays,
    loads: LoadArrays,
    travel: Travel,
    state: Array,
    rows: Array,
    motions: Array,
    total: Array,
) -> None:
    """Add the forces and moments of all loads.

    Parameters:
        bodies, loads: of the vehicle.
        travel: reference motion.
        state: (12 n + m,) with held coordinates.
        rows: (n, 6, 3), sections of the track at the bodies.
        motions: (n, 6, 3) of the bodies.
        total: (n, 2, 3) forces N and moments N m on the bodies, in common axes.

    Those of a body are added first: a pair at both sides then has the mirrored sum in the mirrored motion, bit for bit.
    """
    if len(loads.wheelset) + len(loads.body) == 0:
        return
    own = np.zeros_like(total)
    for p in range(len(loads.wheelset)):
        torque = axle_torque(bodies, loads, p, travel, state, motions)
        i, j = loads.wheelset[p], loads.reaction[p]
        store(own[i, 1], add(load(own[i, 1]), torque))
        store(own[j, 1], subtract(load(own[j, 1]), torque))
    for f in range(len(loads.body)):
        i = loads.body[f]
        force = body_force(loads, f, travel, state, rows)
        moment = force_moment(bodies, loads, f, motion_in(motions[i]), force)
        store(own[i, 0], add(load(own[i, 0]), force))
        store(own[i, 1], add(load(own[i, 1]), moment))
    for i in range(len(total)):
        for part in range(2):
            for d in range(3):
                total[i, part, d] += own[i, part, d]
