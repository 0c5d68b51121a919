"""Accelerations of all bodies of a vehicle in compiled code, and their exact derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Complex, Nodes
from wheelrail.vehicle.multibody.compiled.bodies import (
    Acceleration,
    BodyArrays,
    Motion,
    Travel,
    frame_motion,
    motion_of,
    rotation,
    translation,
)
from wheelrail.vehicle.multibody.compiled.elements import ElementArrays, element_state, element_wrench, spring_moment
from wheelrail.vehicle.multibody.compiled.sections import Section, TrackArrays, section_at
from wheelrail.vehicle.multibody.compiled.vectors import Vector, add, analytic, rotate_back, scale

STEP = 1e-20  # imaginary part of a perturbed component; its square is lost in the real parts


class VehicleArrays(NamedTuple):
    """Bodies, elements and track of a vehicle."""

    bodies: BodyArrays
    elements: ElementArrays
    track: TrackArrays


@analytic
def store(values: Complex, vector: Vector) -> None:
    """Fill three values."""
    values[0], values[1], values[2] = vector


@analytic
def load(values: Complex) -> Vector:
    return values[0], values[1], values[2]


@analytic
def store_solved(values: Complex, solved: Acceleration, nominal: Vector, held: Nodes) -> None:
    """Fill three values: second derivatives less nominal ones, reactions where coordinates are held."""
    for k in range(3):
        values[k] = solved.reactions[k] if held[k] else solved.values[k] - nominal[k]


@analytic
def add_to(values: Complex, vector: Vector) -> None:
    """Add to three values."""
    store(values, add(load(values), vector))


@analytic
def section_of(rows: Complex) -> Section:
    """Section of rows (6, 3), see `sections`."""
    return Section(load(rows[0]), (load(rows[1]), load(rows[2]), load(rows[3])), load(rows[4]), load(rows[5]))


@analytic
def motion_in(rows: Complex) -> Motion:
    """Motion of rows (6, 3): position, velocity, axes, angular velocity."""
    return Motion(load(rows[0]), load(rows[1]), (load(rows[2]), load(rows[3]), load(rows[4])), load(rows[5]))


@analytic
def sections(vehicle: VehicleArrays, distance: complex, reference: complex, state: Complex) -> Complex:
    """Track sections (n, 6, 3) at the bodies: position m, axes, rotation per length rad/m and its derivative rad/m2.

    Parameters:
        vehicle: bodies and track.
        distance: of the reference motion, m.
        reference: distance of the common axes, m.
        state: (12 n + m,) with held coordinates.
    """
    result = np.empty((len(vehicle.bodies.mass), 6, 3), np.complex128)
    for i in range(len(result)):
        store_section(vehicle, distance, reference, state, i, result[i])
    return result


@analytic
def store_section(
    vehicle: VehicleArrays, distance: complex, reference: complex, state: Complex, i: int, rows: Complex
) -> None:
    """Fill the track section (6, 3) at body i; parameters as for `sections`."""
    section = section_at(vehicle.track, distance + vehicle.bodies.place[i] + state[6 * i], reference)
    store(rows[0], section.position)
    for k in range(3):
        store(rows[1 + k], section.axes[k])
    store(rows[4], section.rate)
    store(rows[5], section.rate_slope)


@analytic
def motions_of(vehicle: VehicleArrays, rows: Complex, travel: Travel, state: Complex) -> Complex:
    """Motions (n, 6, 3) of the bodies, see `motion_in`; parameters as for `accelerations`."""
    result = np.empty((len(rows), 6, 3), np.complex128)
    for i in range(len(rows)):
        store_motion(vehicle, rows[i], travel, state, i, result[i])
    return result


@analytic
def store_motion(
    vehicle: VehicleArrays, rows: Complex, travel: Travel, state: Complex, i: int, values: Complex
) -> None:
    """Fill the motion (6, 3) of body i from its section (6, 3); other parameters as for `accelerations`."""
    c = 6 * len(vehicle.bodies.mass)
    section, rate = section_of(rows), state[c + 6 * i : c + 6 * i + 6]
    frame = frame_motion(vehicle.bodies, i, travel, section, state[6 * i : 6 * i + 6], rate)
    motion = motion_of(vehicle.bodies, i, section, frame, rate)
    store(values[0], motion.position)
    store(values[1], motion.velocity)
    for k in range(3):
        store(values[2 + k], motion.axes[k])
    store(values[5], motion.rate)


@analytic
def suspension(vehicle: VehicleArrays, motions: Complex, series: Complex, series_rate: Complex, body: int) -> Complex:
    """Forces and moments (n, 2, 3) N and N m of elements and rotational springs on the bodies, in common axes.

    Parameters:
        vehicle: elements.
        motions: (n, 6, 3), see `motion_in`.
        series, series_rate: (m,) spring deflections m of Maxwell elements, and their rates m/s, which are filled.
        body: whose elements are taken; negative: all.
    """
    total = np.zeros((len(motions), 2, 3), np.complex128)
    add_suspension(vehicle, motions, series, series_rate, body, total)
    return total


@analytic
def add_suspension(
    vehicle: VehicleArrays, motions: Complex, series: Complex, series_rate: Complex, body: int, total: Complex
) -> None:
    """Add to forces and moments (n, 2, 3); other parameters as for `suspension`.

    Forces of elements that are mirror images of each other are added first: the sums of the mirrored motion are the
    mirrored sums, bit for bit.
    """
    elements, wheelset = vehicle.elements, vehicle.bodies.wheelset
    for p in range(len(elements.pairs)):
        upper, lower = elements.upper[elements.pairs[p, 0]], elements.lower[elements.pairs[p, 0]]
        if body >= 0 and upper != body and lower != body:
            continue
        ends = motion_in(motions[upper]), motion_in(motions[lower])
        zero = 0.0 * ends[0].position[0]
        force, on_upper, on_lower = (zero, zero, zero), (zero, zero, zero), (zero, zero, zero)
        for k in range(2):
            e = elements.pairs[p, k]
            if e >= 0:
                wrench = element_wrench(elements, e, ends[0], ends[1], wheelset[lower], series, series_rate)
                force, on_upper = add(force, wrench.force), add(on_upper, wrench.on_upper)
                on_lower = add(on_lower, wrench.on_lower)
        add_to(total[upper, 0], force)
        add_to(total[upper, 1], on_upper)
        add_to(total[lower, 0], scale(-1.0, force))
        add_to(total[lower, 1], scale(-1.0, on_lower))
    for r in range(len(elements.spring_upper)):
        upper, lower = elements.spring_upper[r], elements.spring_lower[r]
        if body < 0 or upper == body or lower == body:
            moment = spring_moment(elements, r, motion_in(motions[upper]), motion_in(motions[lower]))
            add_to(total[upper, 1], moment)
            add_to(total[lower, 1], scale(-1.0, moment))


@analytic
def element_states(vehicle: VehicleArrays, travels: Complex, states: Complex) -> Array:
    """Deflections m and forces N (r, 2, e, 3) of the elements on their upper bodies, in the elements' axes.

    Parameters:
        vehicle: bodies, elements and track.
        travels: (r, 3) distance m, speed m/s and acceleration m/s2 of the reference motion.
        states: (r, 12 n + m) with held coordinates.
    """
    elements, c = vehicle.elements, 12 * len(vehicle.bodies.mass)
    result = np.empty((len(states), 2, len(elements.upper), 3))
    rate = np.empty(states.shape[1] - c, np.complex128)
    for i in range(len(states)):
        travel = Travel(travels[i, 0], travels[i, 1], travels[i, 2])
        rows = sections(vehicle, travel.distance, travel.distance, states[i])
        motions = motions_of(vehicle, rows, travel, states[i])
        for e in range(len(elements.upper)):
            upper, lower = motion_in(motions[elements.upper[e]]), motion_in(motions[elements.lower[e]])
            state = element_state(elements, e, upper, lower, states[i, c:], rate)
            for j in range(3):
                result[i, 0, e, j], result[i, 1, e, j] = state.deflection[j].real, state.force[j].real
    return result


@analytic
def accelerations(vehicle: VehicleArrays, rows: Complex, travel: Travel, state: Complex, wrenches: Complex) -> Complex:
    """Accelerations (6 n,) of the coordinates, then the rates (m,) m/s of the springs of Maxwell elements.

    Parameters:
        vehicle: bodies and elements.
        rows: (n, 6, 3), see `sections`.
        travel: reference motion.
        state: (12 n + m,) with held coordinates.
        wrenches: (n, 2, 3) N and N m, contact forces and moments about the bodies' centres, in their track frames.

    In place of the accelerations of held coordinates, which are zero, stand the generalised forces N or N m of their
    constraints.
    """
    n = len(vehicle.bodies.mass)
    result = np.empty(len(state) - 6 * n, np.complex128)
    motions = motions_of(vehicle, rows, travel, state)
    total = suspension(vehicle, motions, state[12 * n :], result[6 * n :], -1)
    for i in range(n):
        store_accelerations(vehicle, rows[i], travel, state, total[i], wrenches[i], i, result[6 * i : 6 * i + 6])
    return result


@analytic
def store_accelerations(
    vehicle: VehicleArrays,
    rows: Complex,
    travel: Travel,
    state: Complex,
    total: Complex,
    wrench: Complex,
    i: int,
    values: Complex,
) -> None:
    """Fill the accelerations (6,) of the coordinates of body i, or reactions where they are held.

    Parameters:
        vehicle: bodies.
        rows: (6, 3), section of the track at the body.
        travel: reference motion.
        state: (12 n + m,) with held coordinates.
        total, wrench: (2, 3) force and moment of the suspension, in common axes, and of contacts, in the track frame.
        i: number of the body.
        values: filled.
    """
    bodies, c, along = vehicle.bodies, 6 * len(vehicle.bodies.mass), travel.acceleration
    zero, rolling = 0.0 * along, bodies.wheelset[i] * along / bodies.radius
    section, q, rate = section_of(rows), state[6 * i : 6 * i + 6], state[c + 6 * i : c + 6 * i + 6]
    force = load(total[0])
    force = (force[0], force[1], force[2] - bodies.gravity * bodies.mass[i])
    if bodies.kept == i:
        size = -bodies.hold_stiffness * q[0] - bodies.hold_damping * rate[0]
        force = add(force, scale(size, section.axes[0]))
    force = add(rotate_back(section.axes, force), load(wrench[0]))
    moment = add(rotate_back(section.axes, load(total[1])), load(wrench[1]))
    frame = frame_motion(bodies, i, travel, section, q, rate)
    linear = translation(bodies, i, section, frame, force, along)
    angular = rotation(bodies, i, section, frame, rate, moment, linear.values[0], rolling)
    store_solved(values[:3], linear, (along, zero, zero), bodies.held[i, :3])
    store_solved(values[3:], angular, (zero, rolling, zero), bodies.held[i, 3:])


@analytic
def derivatives(
    vehicle: VehicleArrays, travel: Travel, rates: Travel, state: Complex, columns: Nodes, wrenches: Complex
) -> Array:
    """Derivatives (s + 7, 6 n + m) of the accelerations at a real state by complex steps, exact but for round-off.

    Parameters:
        vehicle: bodies, elements and track.
        travel, rates: reference motion, and its derivative by time.
        state: (12 n + m,) with held coordinates.
        columns: (s,) indices of its components by which the derivatives are taken.
        wrenches: (n, 2, 3) N and N m, see `accelerations`.

    Rows: by these components; by the three forces and moments on the wheelsets, on all at once; by time.
    Of an analytic function f, f(x + i h) = f(x) + i h f'(x) for small h, without cancellation; W. Squire, G. Trapp,
    SIAM Review 40 (1998) 110-112, doi:10.1137/S003614459631241X.
    """
    n, size = len(vehicle.bodies.mass), len(columns)
    c, step, reference = 6 * n, STEP * 1j, travel.distance
    result, rows = np.zeros((size + 7, len(state) - c)), sections(vehicle, travel.distance, travel.distance, state)
    motions, rates_of = motions_of(vehicle, rows, travel, state), np.zeros(len(state) - 2 * c, np.complex128)
    total = suspension(vehicle, motions, state[2 * c :], rates_of, -1)
    responses = wrench_responses(vehicle, rows, travel, state, total, wrenches)
    for i in range(n):
        for d in range(6):
            result[size + d, 6 * i : 6 * i + 6] = vehicle.bodies.wheelset[i] * responses[i, d]
    own_rows, own_motion, values = rows.copy(), motions.copy(), np.empty(6, np.complex128)
    point, change = state.copy(), np.empty_like(total)
    for k in range(size):
        column = columns[k]
        point[column] += step
        moves = column < 2 * c
        body = column % c // 6 if moves else upper_of_series(vehicle.elements, column - 2 * c)
        # one body moves, or a spring of a Maxwell element on it: its elements, it and its neighbours feel it
        if column < c and column % 6 == 0:
            store_section(vehicle, travel.distance, reference, point, body, own_rows[body])
        if moves:
            store_motion(vehicle, own_rows[body], travel, point, body, own_motion[body])
        rates_of[:], change[:] = 0.0, 0.0
        add_suspension(vehicle, own_motion, point[2 * c :], rates_of, body, change)
        for i in range(n):
            if i != body or not moves:
                add_response(responses[i], section_of(rows[i]), change[i], result[k, 6 * i : 6 * i + 6])
        if moves:
            for d in range(3):
                change[body, 0, d] = complex(total[body, 0, d].real, change[body, 0, d].imag)
                change[body, 1, d] = complex(total[body, 1, d].real, change[body, 1, d].imag)
            store_accelerations(vehicle, own_rows[body], travel, point, change[body], wrenches[body], body, values)
            for d in range(6):
                result[k, 6 * body + d] = values[d].imag / STEP
        for m in range(len(rates_of)):
            result[k, c + m] = rates_of[m].imag / STEP
        own_rows[body], own_motion[body], point[column] = rows[body], motions[body], state[column]
    at = Travel(
        travel.distance + step * rates.distance,
        travel.speed + step * rates.speed,
        travel.acceleration + step * rates.acceleration,
    )
    rate = accelerations(vehicle, sections(vehicle, at.distance, reference, point), at, point, wrenches)
    for j in range(len(rate)):
        result[size + 6, j] = rate[j].imag / STEP
    return result


@analytic
def upper_of_series(elements: ElementArrays, m: int) -> int:
    """Index of the upper body of Maxwell element m."""
    for e in range(len(elements.upper)):
        for j in range(3):
            if elements.series[e, j] == m:
                return int(elements.upper[e])
    return -1


@analytic
def wrench_responses(
    vehicle: VehicleArrays, rows: Complex, travel: Travel, state: Complex, total: Complex, wrenches: Complex
) -> Array:
    """Derivatives (n, 6, 6) of the accelerations of each body by the components of a force and a moment on it, in its
    track frame.

    Parameters:
        vehicle, travel, state, wrenches: as for `derivatives`.
        rows: (n, 6, 3), sections of the track at the bodies.
        total: (n, 2, 3), forces and moments of the suspension.
    """
    result, values = np.empty((len(rows), 6, 6)), np.empty(6, np.complex128)
    for i in range(len(rows)):
        wrench = wrenches[i].copy()
        for d in range(6):
            wrench[d // 3, d % 3] += STEP * 1j
            store_accelerations(vehicle, rows[i], travel, state, total[i], wrench, i, values)
            wrench[d // 3, d % 3] = wrenches[i, d // 3, d % 3]
            for j in range(6):
                result[i, d, j] = values[j].imag / STEP
    return result


@analytic
def add_response(response: Array, section: Section, change: Complex, row: Array) -> None:
    """Add the derivatives (6,) of a body's accelerations by what changes the force and moment on it.

    Parameters:
        response: (6, 6) of `wrench_responses`.
        section: of the track, at the body.
        change: (2, 3) complex step of the force and the moment, in common axes.
        row: added to.
    """
    for part in range(2):
        own = rotate_back(section.axes, load(change[part]))
        for d in range(3):
            size = own[d].imag / STEP
            if size != 0.0:
                for j in range(6):
                    row[j] += response[3 * part + d, j] * size
