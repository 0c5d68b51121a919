"""Accelerations of all bodies of a vehicle in compiled code, and their exact derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Complex, Nodes
from wheelrail.vehicle.multibody.compiled.applied_loads import LoadArrays, add_load_changes, add_loads
from wheelrail.vehicle.multibody.compiled.bodies import (
    Acceleration,
    BodyArrays,
    Travel,
    frame_motion,
    motion_in,
    motion_of,
    rotation,
    translation,
)
from wheelrail.vehicle.multibody.compiled.element_derivatives import add_changes, element_bases
from wheelrail.vehicle.multibody.compiled.elements import ElementArrays, element_state, element_wrench, spring_moment
from wheelrail.vehicle.multibody.compiled.sections import Section, TrackArrays, section_at
from wheelrail.vehicle.multibody.compiled.vectors import Vector, add, analytic, load, rotate_back, scale, store

STEP = 1e-20  # imaginary part of a perturbed component; its square is lost in the real parts


class VehicleArrays(NamedTuple):
    """Bodies, elements and track of a vehicle, and torques and forces on it."""

    bodies: BodyArrays
    elements: ElementArrays
    track: TrackArrays
    loads: LoadArrays


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
def near(distance: complex, state: Complex) -> complex:
    """Distance m of the common axes: that of the reference motion, from which a vehicle that runs free drifts far away,
    to the nearest 100 m.
    """
    place: complex = distance.real + 100.0 * np.floor(0.01 * state[0].real + 0.5) + 0.0j
    return place


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
def suspension(vehicle: VehicleArrays, motions: Complex, series: Complex, series_rate: Complex) -> Complex:
    """Forces and moments (n, 2, 3) N and N m of elements and rotational springs on the bodies, in common axes.

    Parameters:
        vehicle: elements.
        motions: (n, 6, 3), see `motion_in`.
        series, series_rate: (m,) spring deflections m of Maxwell elements, and their rates m/s, which are filled.

    Forces of elements that are mirror images of each other are added first: the sums of the mirrored motion are the
    mirrored sums, bit for bit.
    """
    total = np.zeros((len(motions), 2, 3), np.complex128)
    elements, wheelset = vehicle.elements, vehicle.bodies.wheelset
    for p in range(len(elements.pairs)):
        upper, lower = elements.upper[elements.pairs[p, 0]], elements.lower[elements.pairs[p, 0]]
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
        moment = spring_moment(elements, r, motion_in(motions[upper]), motion_in(motions[lower]))
        add_to(total[upper, 1], moment)
        add_to(total[lower, 1], scale(-1.0, moment))
    return total


@analytic
def element_states(vehicle: VehicleArrays, travels: Complex, states: Complex) -> Array:
    """Deflections m and forces N (r, 2, e, 3) of the elements on their upper bodies, in the elements' axes.

    Parameters:
        vehicle: bodies, elements and track.
        travels: (r, 4) distance m, speed m/s and acceleration m/s2 of the reference motion, and time s.
        states: (r, 12 n + m) with held coordinates.
    """
    elements, c = vehicle.elements, 12 * len(vehicle.bodies.mass)
    result = np.empty((len(states), 2, len(elements.upper), 3))
    rate = np.empty(states.shape[1] - c, np.complex128)
    for i in range(len(states)):
        travel = Travel(travels[i, 0], travels[i, 1], travels[i, 2], travels[i, 3])
        rows = sections(vehicle, travel.distance, near(travel.distance, states[i]), states[i])
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
        vehicle: bodies, elements and loads.
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
    total = suspension(vehicle, motions, state[12 * n :], result[6 * n :])
    add_loads(vehicle.bodies, vehicle.loads, travel, state, rows, motions, total)
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
        total, wrench: (2, 3) force and moment of suspension and loads, in common axes, and of contacts, in the track
            frame.
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
        vehicle: bodies, elements, track and loads.
        travel, rates: reference motion, and its derivative by time.
        state: (12 n + m,) with held coordinates.
        columns: (s,) indices of its components by which the derivatives are taken.
        wrenches: (n, 2, 3) N and N m, see `accelerations`.

    Rows: by these components; by the three forces and moments on the wheelsets, on all at once; by time.
    Of an analytic function f, f(x + i h) = f(x) + i h f'(x) for small h, without cancellation; W. Squire, G. Trapp,
    SIAM Review 40 (1998) 110-112, doi:10.1137/S003614459631241X.
    """
    n, size = len(vehicle.bodies.mass), len(columns)
    c, step, reference = 6 * n, STEP * 1j, near(travel.distance, state)
    result, rows = np.zeros((size + 7, len(state) - c)), sections(vehicle, travel.distance, reference, state)
    motions, rates_of = motions_of(vehicle, rows, travel, state), np.zeros(len(state) - 2 * c, np.complex128)
    total = suspension(vehicle, motions, state[2 * c :], rates_of)
    add_loads(vehicle.bodies, vehicle.loads, travel, state, rows, motions, total)
    responses = wrench_responses(vehicle, rows, travel, state, total, wrenches)
    for i in range(n):
        for d in range(6):
            result[size + d, 6 * i : 6 * i + 6] = vehicle.bodies.wheelset[i] * responses[i, d]
    bases = element_bases(vehicle.elements, vehicle.bodies.wheelset, motions, state[2 * c :], STEP)
    own_rows, own_motion, values = rows.copy(), motions.copy(), np.empty(6, np.complex128)
    point, change, own_rates = state.copy(), np.empty((n, 2, 3)), np.empty(len(state) - 2 * c)
    own_total = np.empty((2, 3), np.complex128)
    for k in range(size):
        column = columns[k]
        point[column] += step
        change[:], own_rates[:] = 0.0, 0.0
        if column >= 2 * c:  # the spring of a Maxwell element
            moved = suspension(vehicle, motions, point[2 * c :], rates_of)
            for i in range(n):
                for d in range(6):
                    change[i, d // 3, d % 3] = moved[i, d // 3, d % 3].imag / STEP
                add_response(responses[i], section_of(rows[i]), change[i], result[k, 6 * i : 6 * i + 6])
            for m in range(len(rates_of)):
                result[k, c + m] = rates_of[m].imag / STEP
            point[column] = state[column]
            continue
        body = column % c // 6  # moves: its elements, it and its neighbours feel it
        if column < c and column % 6 == 0:
            store_section(vehicle, travel.distance, reference, point, body, own_rows[body])
        store_motion(vehicle, own_rows[body], travel, point, body, own_motion[body])
        add_changes(vehicle.elements, bases, own_motion, body, STEP, change, own_rates)
        add_load_changes(vehicle.bodies, vehicle.loads, travel, point, own_rows, own_motion, body, STEP, change)
        for i in range(n):
            if i != body:
                add_response(responses[i], section_of(rows[i]), change[i], result[k, 6 * i : 6 * i + 6])
        for d in range(6):
            whole = total[body, d // 3, d % 3].real
            own_total[d // 3, d % 3] = complex(whole, STEP * change[body, d // 3, d % 3])
        store_accelerations(vehicle, own_rows[body], travel, point, own_total, wrenches[body], body, values)
        for d in range(6):
            result[k, 6 * body + d] = values[d].imag / STEP
        result[k, c:] = own_rates
        own_rows[body], own_motion[body], point[column] = rows[body], motions[body], state[column]
    at = Travel(
        travel.distance + step * rates.distance,
        travel.speed + step * rates.speed,
        travel.acceleration + step * rates.acceleration,
        travel.time + step * rates.time,
    )
    rate = accelerations(vehicle, sections(vehicle, at.distance, reference, point), at, point, wrenches)
    for j in range(len(rate)):
        result[size + 6, j] = rate[j].imag / STEP
    return result


@analytic
def wrench_responses(
    vehicle: VehicleArrays, rows: Complex, travel: Travel, state: Complex, total: Complex, wrenches: Complex
) -> Array:
    """Derivatives (n, 6, 6) of the accelerations of each body by the components of a force and a moment on it, in its
    track frame.

    Parameters:
        vehicle, travel, state, wrenches: as for `derivatives`.
        rows: (n, 6, 3), sections of the track at the bodies.
        total: (n, 2, 3), forces and moments of suspension and loads.
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
def add_response(response: Array, section: Section, change: Array, row: Array) -> None:
    """Add the derivatives (6,) of a body's accelerations by what changes the force and moment on it.

    Parameters:
        response: (6, 6) of `wrench_responses`.
        section: of the track, at the body.
        change: (2, 3) of the force and the moment, in common axes.
        row: added to.
    """
    for part in range(2):
        own = rotate_back(section.axes, (change[part, 0], change[part, 1], change[part, 2]))
        for d in range(3):
            size = own[d].real
            if size != 0.0:
                for j in range(6):
                    row[j] += response[3 * part + d, j] * size
