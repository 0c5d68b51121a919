"""Exact derivatives of the accelerations of all bodies of a vehicle, in closed form and compiled.

A body's equations depend on its own coordinates and on forces and moments, which depend on the motions of few bodies:
the derivatives by these are products of small matrices.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import unchecked
from wheelrail.vehicle.multibody.compiled.applied_loads import add_loads
from wheelrail.vehicle.multibody.compiled.bodies import Travel
from wheelrail.vehicle.multibody.compiled.body_derivatives import (
    COMPONENTS,
    body_base,
    coordinate_change,
    frame_change,
    store_acceleration_change,
    store_motion_change,
    store_wrench_response,
    time_change,
)
from wheelrail.vehicle.multibody.compiled.element_derivatives import MOTIONS, SuspensionSlopes, add_suspension
from wheelrail.vehicle.multibody.compiled.equations import (
    VehicleArrays,
    motions_of,
    near,
    sections,
    solved_body,
    suspension,
)
from wheelrail.vehicle.multibody.compiled.load_derivatives import add_load_slopes
from wheelrail.vehicle.multibody.compiled.sections import rate_curvature
from wheelrail.vehicle.multibody.compiled.vectors import analytic

DIRECTIONS = 13  # the coordinates of a body, their rates, and time
BY_TIME = 12


class VehicleDerivatives(NamedTuple):
    """Derivatives of r of the accelerations (6 n,) of the coordinates and of the rates (m,) of Maxwell elements.

    Parameters:
        by_state: (r, k), by k of the coordinates (6 n,), their rates, and the springs' deflections (m,).
        by_wrench: (6, r), by a component of force or moment on each wheelset, in its track frame.
        by_time: (r,), with the reference motion.
    """

    by_state: Array
    by_wrench: Array
    by_time: Array


class BodySlopes(NamedTuple):
    """Derivatives of the bodies, each by its own coordinates, their rates and time.

    Parameters:
        motion: (n, 15, 13), of the components of the motions.
        acceleration: (n, 6, 13), of the accelerations at constant forces and moments.
        by_wrench: (n, 6, 6), of the accelerations by force and moment in the track frame.
        by_common: (n, 6, 6), the same in common axes.
    """

    motion: Array
    acceleration: Array
    by_wrench: Array
    by_common: Array


@unchecked
def derivatives(
    vehicle: VehicleArrays, travel: Travel, rates: Travel, state: Array, columns: Nodes, wrenches: Array
) -> VehicleDerivatives:
    """Derivatives of `accelerations` at a state.

    Parameters:
        vehicle: bodies, elements, track and loads.
        travel, rates: reference motion, and its derivative by time.
        state: (12 n + m,) with held coordinates.
        columns: (k,) indices of free coordinates, of their rates and of Maxwell elements among all; the rates of the
            last two are those whose derivatives are taken.
        wrenches: (n, 2, 3) N and N m, of contacts, in the bodies' track frames.
    """
    n, m = len(vehicle.bodies.mass), len(vehicle.elements.series_stiffness)
    rows = sections(vehicle, travel.distance, near(travel.distance, state), state)
    motions, series, series_rates = motions_of(vehicle, rows, travel, state), state[12 * n :], np.empty(m)
    total = suspension(vehicle, motions, series, series_rates)
    add_loads(vehicle.bodies, vehicle.loads, travel, state, rows, motions, total)
    slopes = SuspensionSlopes(
        np.zeros((n, n, 6, COMPONENTS)),
        np.zeros((n, n), np.int64),
        np.empty((m, 2, MOTIONS)),
        np.empty((m, 2, 6)),
        np.empty(m),
    )
    add_suspension(vehicle.elements, vehicle.bodies.wheelset, motions, series, series_rates, slopes)
    add_load_slopes(vehicle.bodies, vehicle.loads, travel, state, rows, motions, slopes)
    own = body_slopes(vehicle, travel, rates, state, rows, total, wrenches)
    by_state, by_time = np.zeros((6 * n + m, 12 * n + m)), np.zeros(6 * n + m)
    block = np.empty((6, DIRECTIONS))
    for i in range(n):
        for j in range(n):
            if i == j:
                block[:] = own.acceleration[i]
            elif slopes.coupled[i, j] == 1:
                block[:] = 0.0
            else:
                continue
            if slopes.coupled[i, j] == 1:
                add_product(product_of(own.by_common[i], slopes.wrench[i, j]), own.motion[j], block)
            by_state[6 * i : 6 * i + 6, 6 * j : 6 * j + 6] = block[:, :6]
            by_state[6 * i : 6 * i + 6, 6 * (n + j) : 6 * (n + j) + 6] = block[:, 6:BY_TIME]
            for k in range(6):
                by_time[6 * i + k] += block[k, BY_TIME]
    add_maxwell(vehicle, slopes, own, by_state, by_time)
    return selected(vehicle, own, by_state, by_time, columns)


@unchecked
def selected(
    vehicle: VehicleArrays, own: BodySlopes, by_state: Array, by_time: Array, columns: Nodes
) -> VehicleDerivatives:
    """Derivatives (6 n + m, 12 n + m) and (6 n + m,) of all, without held coordinates; columns as for `derivatives`."""
    n, first = len(own.motion), 0
    while first < len(columns) and columns[first] < 6 * n:
        first += 1
    size = len(columns) - first
    result = VehicleDerivatives(np.empty((size, len(columns))), np.zeros((6, size)), np.empty(size))
    for r in range(size):
        row = columns[first + r] - 6 * n
        for k in range(len(columns)):
            result.by_state[r, k] = by_state[row, columns[k]]
        result.by_time[r] = by_time[row]
        if row < 6 * n:
            for d in range(6):
                result.by_wrench[d, r] = vehicle.bodies.wheelset[row // 6] * own.by_wrench[row // 6, row % 6, d]
    return result


@unchecked
def body_slopes(
    vehicle: VehicleArrays,
    travel: Travel,
    rates: Travel,
    state: Array,
    rows: Array,
    total: Array,
    wrenches: Array,
) -> BodySlopes:
    """Derivatives of all bodies.

    Parameters:
        vehicle, travel, rates, state, wrenches: as for `derivatives`.
        rows: (n, 6, 3), sections of the track at the bodies.
        total: (n, 2, 3), forces and moments of suspension and loads, in common axes.
    """
    bodies, n = vehicle.bodies, len(rows)
    motion, acceleration = np.empty((n, COMPONENTS, DIRECTIONS)), np.empty((n, 6, DIRECTIONS))
    by_wrench, by_common = np.empty((n, 6, 6)), np.zeros((n, 6, 6))
    for i in range(n):
        wheelset, rate = bodies.wheelset[i], state[6 * (n + i) : 6 * (n + i) + 6]
        solution = solved_body(bodies, rows[i], travel, state, total[i], wrenches[i], i)
        curvature = rate_curvature(vehicle.track, travel.distance + bodies.place[i] + state[6 * i])
        base = body_base(solution, curvature, rate)
        for d in range(DIRECTIONS):
            change = time_change(bodies, i, rates) if d == BY_TIME else coordinate_change(bodies, i, d)
            moved = frame_change(base, wheelset, rate, change)
            store_motion_change(base, wheelset, change, moved, motion[i], d)
            store_acceleration_change(bodies, i, base, change, moved, acceleration[i], d)
        store_wrench_response(bodies, i, base, by_wrench[i])
        for d in range(6):
            for k in range(6):
                for axis in range(3):
                    by_common[i, d, k] += by_wrench[i, d, 3 * (k // 3) + axis] * rows[i, 1 + axis, k % 3]
    return BodySlopes(motion, acceleration, by_wrench, by_common)


@unchecked
def product_of(a: Array, b: Array) -> Array:
    """Product of small matrices."""
    result = np.zeros((len(a), b.shape[1]))
    add_product(a, b, result)
    return result


@analytic
def add_product(a: Array, b: Array, result: Array) -> None:
    """Add the product of small matrices, of which the first has many zeros."""
    for d in range(len(a)):
        for k in range(len(b)):
            if a[d, k] != 0.0:
                for j in range(b.shape[1]):
                    result[d, j] += a[d, k] * b[k, j]


@analytic
def add_maxwell(
    vehicle: VehicleArrays, slopes: SuspensionSlopes, own: BodySlopes, by_state: Array, by_time: Array
) -> None:
    """Add the rows and columns of Maxwell elements to the derivatives of all coordinates."""
    elements, n = vehicle.elements, len(own.motion)
    for e in range(len(elements.upper)):
        for j in range(3):
            m = elements.series[e, j]
            if m < 0:
                continue
            row, column = by_state[6 * n + m], 12 * n + m
            row[column] = slopes.decay[m]
            for side in range(2):
                i = elements.upper[e] if side == 0 else elements.lower[e]
                for k in range(MOTIONS):
                    size, motion = slopes.rate[m, side, k], own.motion[i, k]
                    for d in range(6):
                        row[6 * i + d] += size * motion[d]
                        row[6 * (n + i) + d] += size * motion[6 + d]
                    by_time[6 * n + m] += size * motion[BY_TIME]
                for d in range(6):
                    for k in range(6):
                        by_state[6 * i + d, column] += own.by_common[i, d, k] * slopes.series[m, side, k]
