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
from wheelrail.vehicle.multibody.compiled.elements import ElementArrays, element_wrench, spring_moment
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
def store_acceleration(values: Complex, solved: Acceleration, nominal: Vector, held: Nodes) -> None:
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
    n = len(vehicle.bodies.mass)
    result = np.empty((n, 6, 3), np.complex128)
    for i in range(n):
        section = section_at(vehicle.track, distance + vehicle.bodies.place[i] + state[6 * i], reference)
        store(result[i, 0], section.position)
        for k in range(3):
            store(result[i, 1 + k], section.axes[k])
        store(result[i, 4], section.rate)
        store(result[i, 5], section.rate_slope)
    return result


@analytic
def motions_of(vehicle: VehicleArrays, rows: Complex, travel: Travel, state: Complex) -> Complex:
    """Motions (n, 6, 3) of the bodies, see `motion_in`; parameters as for `accelerations`."""
    n = len(vehicle.bodies.mass)
    result = np.empty((n, 6, 3), np.complex128)
    for i in range(n):
        section, rate = section_of(rows[i]), state[6 * n + 6 * i : 6 * n + 6 * i + 6]
        frame = frame_motion(vehicle.bodies, i, travel, section, state[6 * i : 6 * i + 6], rate)
        motion = motion_of(vehicle.bodies, i, section, frame, rate)
        store(result[i, 0], motion.position)
        store(result[i, 1], motion.velocity)
        for k in range(3):
            store(result[i, 2 + k], motion.axes[k])
        store(result[i, 5], motion.rate)
    return result


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
    elements, wheelset = vehicle.elements, vehicle.bodies.wheelset
    total = np.zeros((len(motions), 2, 3), np.complex128)
    for p in range(len(elements.pairs)):
        pair = np.zeros((3, 3), np.complex128)
        upper, lower = elements.upper[elements.pairs[p, 0]], elements.lower[elements.pairs[p, 0]]
        ends = motion_in(motions[upper]), motion_in(motions[lower])
        for k in range(2):
            e = elements.pairs[p, k]
            if e >= 0:
                wrench = element_wrench(elements, e, ends[0], ends[1], wheelset[lower], series, series_rate)
                for i in range(3):
                    add_to(pair[i], wrench[i])
        add_to(total[upper, 0], load(pair[0]))
        add_to(total[upper, 1], load(pair[1]))
        add_to(total[lower, 0], scale(-1.0, load(pair[0])))
        add_to(total[lower, 1], scale(-1.0, load(pair[2])))
    for r in range(len(elements.spring_upper)):
        upper, lower = elements.spring_upper[r], elements.spring_lower[r]
        moment = spring_moment(elements, r, motion_in(motions[upper]), motion_in(motions[lower]))
        add_to(total[upper, 1], moment)
        add_to(total[lower, 1], scale(-1.0, moment))
    return total


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
    bodies, n = vehicle.bodies, len(vehicle.bodies.mass)
    c, along = 6 * n, travel.acceleration
    zero, result = 0.0 * along, np.empty(len(state) - c, np.complex128)
    motions = motions_of(vehicle, rows, travel, state)
    total = suspension(vehicle, motions, state[2 * c :], result[c:])
    for i in range(n):
        section, q, rate = section_of(rows[i]), state[6 * i : 6 * i + 6], state[c + 6 * i : c + 6 * i + 6]
        force = load(total[i, 0])
        force = (force[0], force[1], force[2] - bodies.gravity * bodies.mass[i])
        if bodies.kept == i:
            size = -bodies.hold_stiffness * q[0] - bodies.hold_damping * rate[0]
            force = add(force, scale(size, section.axes[0]))
        force = add(rotate_back(section.axes, force), load(wrenches[i, 0]))
        moment = add(rotate_back(section.axes, load(total[i, 1])), load(wrenches[i, 1]))
        frame = frame_motion(bodies, i, travel, section, q, rate)
        linear, rolling = (
            translation(bodies, i, section, frame, force, along),
            bodies.wheelset[i] * along / bodies.radius,
        )
        angular = rotation(bodies, i, section, frame, rate, moment, linear.values[0], rolling)
        store_acceleration(result[6 * i : 6 * i + 3], linear, (along, zero, zero), bodies.held[i, :3])
        store_acceleration(result[6 * i + 3 : 6 * i + 6], angular, (zero, rolling, zero), bodies.held[i, 3:])
    return result


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
    c, step = 6 * n, STEP * 1j
    result, rows = np.empty((size + 7, len(state) - c)), sections(vehicle, travel.distance, travel.distance, state)
    for k in range(size + 7):
        point, contact, at, here = state.copy(), wrenches.copy(), travel, rows
        if k < size:
            point[columns[k]] += step
            if columns[k] < c and columns[k] % 6 == 0:  # moves a body along the track
                here = sections(vehicle, at.distance, travel.distance, point)
        elif k < size + 6:
            for i in range(n):
                contact[i, (k - size) // 3, (k - size) % 3] += vehicle.bodies.wheelset[i] * step
        else:
            at = Travel(
                travel.distance + step * rates.distance,
                travel.speed + step * rates.speed,
                travel.acceleration + step * rates.acceleration,
            )
            here = sections(vehicle, at.distance, travel.distance, point)
        rate = accelerations(vehicle, here, at, point, contact)
        for j in range(len(rate)):
            result[k, j] = rate[j].imag / STEP
    return result
