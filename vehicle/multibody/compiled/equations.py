"""Accelerations of all bodies of a vehicle in compiled code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import unchecked
from wheelrail.vehicle.multibody.compiled.applied_loads import LoadArrays, add_loads
from wheelrail.vehicle.multibody.compiled.bodies import (
    Acceleration,
    BodyArrays,
    FrameMotion,
    Travel,
    frame_motion,
    motion_in,
    motion_of,
    rotation,
    translation,
)
from wheelrail.vehicle.multibody.compiled.elements import ElementArrays, element_state, element_wrench, spring_moment
from wheelrail.vehicle.multibody.compiled.sections import Section, TrackArrays, section_at, section_of, store_section
from wheelrail.vehicle.multibody.compiled.vectors import Vector, add, analytic, dot, load, rotate_back, scale, store


class VehicleArrays(NamedTuple):
    """Bodies, elements and track of a vehicle, and torques and forces on it."""

    bodies: BodyArrays
    elements: ElementArrays
    track: TrackArrays
    loads: LoadArrays


@analytic
def store_solved(values: Array, solved: Acceleration, nominal: Vector, held: Nodes) -> None:
    """Fill three values: second derivatives less nominal ones, reactions where coordinates are held."""
    for k in range(3):
        values[k] = solved.values[k] - nominal[k] if held[k] == 0 else dot(solved.directions[k], solved.misfit)


@analytic
def add_to(values: Array, vector: Vector) -> None:
    """Add to three values."""
    store(values, add(load(values), vector))


@analytic
def near(distance: float, state: Array) -> float:
    """Distance m of the common axes: that of the reference motion, from which a vehicle that runs free drifts far away,
    to the nearest 100 m.
    """
    place: float = distance + 100.0 * np.floor(0.01 * state[0] + 0.5)
    return place


@unchecked
def sections(vehicle: VehicleArrays, distance: float, reference: float, state: Array) -> Array:
    """Track sections (n, 6, 3) at the bodies: position m, axes, rotation per length rad/m and its derivative rad/m2.

    Parameters:
        vehicle: bodies and track.
        distance: of the reference motion, m.
        reference: distance of the common axes, m.
        state: (12 n + m,) with held coordinates.
    """
    result = np.empty((len(vehicle.bodies.mass), 6, 3))
    for i in range(len(result)):
        at = distance + vehicle.bodies.place[i] + state[6 * i]
        store_section(section_at(vehicle.track, at, reference), result[i])
    return result


@unchecked
def motions_of(vehicle: VehicleArrays, rows: Array, travel: Travel, state: Array) -> Array:
    """Motions (n, 6, 3) of the bodies, see `motion_in`; parameters as for `accelerations`."""
    result = np.empty((len(rows), 6, 3))
    for i in range(len(rows)):
        store_motion(vehicle, rows[i], travel, state, i, result[i])
    return result


@analytic
def store_motion(vehicle: VehicleArrays, rows: Array, travel: Travel, state: Array, i: int, values: Array) -> None:
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


@unchecked
def suspension(vehicle: VehicleArrays, motions: Array, series: Array, series_rate: Array) -> Array:
    """Forces and moments (n, 2, 3) N and N m of elements and rotational springs on the bodies, in common axes.

    Parameters:
        vehicle: elements.
        motions: (n, 6, 3), see `motion_in`.
        series, series_rate: (m,) spring deflections m of Maxwell elements, and their rates m/s, which are filled.

    Forces of elements that are mirror images of each other are added first: the sums of the mirrored motion are the
    mirrored sums, bit for bit.
    """
    total = np.zeros((len(motions), 2, 3))
    elements, wheelset = vehicle.elements, vehicle.bodies.wheelset
    for p in range(len(elements.pairs)):
        upper, lower = elements.upper[elements.pairs[p, 0]], elements.lower[elements.pairs[p, 0]]
        ends = motion_in(motions[upper]), motion_in(motions[lower])
        force: Vector = (0.0, 0.0, 0.0)
        on_upper, on_lower = force, force
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


@unchecked
def element_states(vehicle: VehicleArrays, travels: Array, states: Array) -> Array:
    """Deflections m and forces N (r, 2, e, 3) of the elements on their upper bodies, in the elements' axes.

    Parameters:
        vehicle: bodies, elements and track.
        travels: (r, 4) distance m, speed m/s and acceleration m/s2 of the reference motion, and time s.
        states: (r, 12 n + m) with held coordinates.
    """
    elements, c = vehicle.elements, 12 * len(vehicle.bodies.mass)
    result = np.empty((len(states), 2, len(elements.upper), 3))
    rate = np.empty(states.shape[1] - c)
    for i in range(len(states)):
        travel = Travel(travels[i, 0], travels[i, 1], travels[i, 2], travels[i, 3])
        rows = sections(vehicle, travel.distance, near(travel.distance, states[i]), states[i])
        motions = motions_of(vehicle, rows, travel, states[i])
        for e in range(len(elements.upper)):
            upper, lower = motion_in(motions[elements.upper[e]]), motion_in(motions[elements.lower[e]])
            state = element_state(elements, e, upper, lower, states[i, c:], rate)
            for j in range(3):
                result[i, 0, e, j], result[i, 1, e, j] = state.deflection[j], state.force[j]
    return result


@unchecked
def accelerations(vehicle: VehicleArrays, rows: Array, travel: Travel, state: Array, wrenches: Array) -> Array:
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
    result = np.empty(len(state) - 6 * n)
    motions = motions_of(vehicle, rows, travel, state)
    total = suspension(vehicle, motions, state[12 * n :], result[6 * n :])
    add_loads(vehicle.bodies, vehicle.loads, travel, state, rows, motions, total)
    for i in range(n):
        body = solved_body(vehicle.bodies, rows[i], travel, state, total[i], wrenches[i], i)
        values, along, held = result[6 * i : 6 * i + 6], travel.acceleration, vehicle.bodies.held[i]
        rolling = vehicle.bodies.wheelset[i] * along / vehicle.bodies.radius
        store_solved(values[:3], body.linear, (along, 0.0, 0.0), held[:3])
        store_solved(values[3:], body.angular, (0.0, rolling, 0.0), held[3:])
    return result


class BodySolution(NamedTuple):
    """Accelerations of a body and what they follow from, in its track frame.

    Parameters:
        section: of the track, at the body.
        frame: motion in the frame.
        force, moment: N and N m of suspension, gravity and loads.
        whole: N m, this moment with that of the contacts.
        linear, angular: accelerations.
    """

    section: Section
    frame: FrameMotion
    force: Vector
    moment: Vector
    whole: Vector
    linear: Acceleration
    angular: Acceleration


@analytic
def solved_body(
    bodies: BodyArrays, rows: Array, travel: Travel, state: Array, total: Array, wrench: Array, i: int
) -> BodySolution:
    """Accelerations of body i.

    Parameters:
        bodies: of the vehicle.
        rows: (6, 3), section of the track at the body.
        travel: reference motion.
        state: (12 n + m,) with held coordinates.
        total, wrench: (2, 3) force and moment of suspension and loads, in common axes, and of contacts, in the track
            frame.
        i: number of the body.
    """
    c, along = 6 * len(bodies.mass), travel.acceleration
    section, q, rate = section_of(rows), state[6 * i : 6 * i + 6], state[c + 6 * i : c + 6 * i + 6]
    force, hold = load(total[0]), 0.0
    force = rotate_back(section.axes, (force[0], force[1], force[2] - bodies.gravity * bodies.mass[i]))
    moment = rotate_back(section.axes, load(total[1]))
    if bodies.kept == i:
        hold = -bodies.hold_stiffness * q[0] - bodies.hold_damping * rate[0]
    whole, frame = add(moment, load(wrench[1])), frame_motion(bodies, i, travel, section, q, rate)
    linear = translation(bodies, i, section, frame, add(add(force, load(wrench[0])), (hold, 0.0, 0.0)), along)
    rolling = bodies.wheelset[i] * along / bodies.radius
    angular = rotation(bodies, i, section, frame, rate, whole, linear.values[0], rolling)
    return BodySolution(section, frame, force, moment, whole, linear, angular)
