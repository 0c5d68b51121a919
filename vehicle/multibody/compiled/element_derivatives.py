"""Derivatives of the forces of suspension elements by the motions of their bodies, in closed form and compiled.

With the rotation vectors t of a body and of the element's axes, changes of a vector a that turns with them are t x a.
Symbols: `wheelrail.vehicle.multibody.compiled.elements` and docs/theory/multibody.md.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import unchecked
from wheelrail.vehicle.multibody.compiled.bodies import Motion, motion_in
from wheelrail.vehicle.multibody.compiled.elements import ElementArrays, element_state, law_slope, spring_moment
from wheelrail.vehicle.multibody.compiled.sections import STEP
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
    relative_rotation,
    rotate,
    rotate_back,
    rotation_vector,
    scale,
    similar,
    subtract,
    times,
    transposed,
)

IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
NONE: Matrix = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
MOTIONS = 12  # components of the motion of a body: position, rotation, velocity and angular velocity


class Slopes(NamedTuple):
    """Derivatives of a vector by the position m, the rotation vector rad, the velocity m/s and the angular velocity
    rad/s of a body.
    """

    position: Matrix
    turn: Matrix
    velocity: Matrix
    rate: Matrix


class ElementBase(NamedTuple):
    """An element in the motion about which derivatives are taken: vectors in common axes.

    Parameters:
        axes: of the element.
        upper_arm, lower_arm: m, of its points from the centres of the bodies.
        gap: m, from the lower to the upper point.
        slip: m/s, rate of the gap in the element's axes.
        axes_rate: rad/s.
        force: N on the upper body.
        upper_lever, lower_lever: m, of the force from the centres of the bodies.
        stiffness, damping: N/m and N s/m, slopes of the force by gap and its rate.
        axle: of a lower body that is a wheelset, otherwise zero: it bears no moment about it.
        turns: derivatives of the rotation vector of the axes by those of the upper and the lower body.
    """

    axes: Matrix
    upper_arm: Vector
    lower_arm: Vector
    gap: Vector
    slip: Vector
    axes_rate: Vector
    force: Vector
    upper_lever: Vector
    lower_lever: Vector
    stiffness: Matrix
    damping: Matrix
    axle: Vector
    turns: tuple[Matrix, Matrix]


class SuspensionSlopes(NamedTuple):
    """Derivatives of forces and moments on n bodies, in common axes, and of the rates of m Maxwell elements.

    Parameters:
        wrench: (n, n, 6, k) N and N m on the first body by components of the motion of the second one.
        coupled: (n, n) 1 where these are not zero.
        rate: (m, 2, 12) 1/s, of the springs' deflections, by the motions of the upper and the lower body.
        series: (m, 2, 6) N/m and N, on the upper and the lower body by the deflections.
        decay: (m,) 1/s, of the rates by the deflections.
    """

    wrench: Array
    coupled: Nodes
    rate: Array
    series: Array
    decay: Array


@analytic
def axes_turns(turn: float, upper: Matrix, lower: Matrix) -> tuple[Matrix, Matrix]:
    """Derivatives of the rotation vector of axes that make a part of the rotation from the lower to the upper body, by
    those of the upper and the lower body.

    With the rotation vector p of the angle a from the lower to the upper body, the part t of the rotation turns with
    Q = t + f [p] + g [p]^2 of their difference, f = r sin((t - 1) a / 2) / a, g = (t - r cos((t - 1) a / 2)) / a^2 and
    r = sin(t a / 2) / sin(a / 2): exp(t p) and p have the same axis, across which both derivatives are complex numbers.
    """
    if turn == 0.0:
        return NONE, IDENTITY
    if turn == 1.0:
        return IDENTITY, NONE
    vector = rotation_vector(relative_rotation(lower, upper))
    angle = np.sqrt(dot(vector, vector))
    first, second = 0.5 * turn * (turn - 1.0), 0.0
    if angle > 1e-8:
        ratio, shift = np.sin(0.5 * turn * angle) / np.sin(0.5 * angle), 0.5 * (turn - 1.0) * angle
        first, second = ratio * np.sin(shift) / angle, (turn - ratio * np.cos(shift)) / (angle * angle)
    cross_vector = crossing(vector)
    inner = plus(times(turn, IDENTITY), times(first, cross_vector))
    inner = plus(inner, times(second, product(cross_vector, cross_vector)))
    by_upper = similar(lower, inner)
    return by_upper, plus(IDENTITY, times(-1.0, by_upper))


@analytic
def element_base(
    elements: ElementArrays, e: int, upper: Motion, lower: Motion, wheelset: float, series: Array, rates: Array
) -> ElementBase:
    """Element e in a motion of its bodies; parameters as for `wheelrail.vehicle.multibody.compiled.elements`."""
    turn, laws = elements.turn[e], elements.laws
    state = element_state(elements, e, upper, lower, series, rates)
    arms = (elements.upper_arm, elements.lower_arm)
    a_upper = rotate(upper.axes, (arms[0][e, 0], arms[0][e, 1], arms[0][e, 2]))
    a_lower = rotate(lower.axes, (arms[1][e, 0], arms[1][e, 1], arms[1][e, 2]))
    axes_rate = add(scale(1.0 - turn, lower.rate), scale(turn, upper.rate))
    gap_rate = subtract(
        add(upper.velocity, cross(upper.rate, a_upper)), add(lower.velocity, cross(lower.rate, a_lower))
    )
    slip = subtract(gap_rate, cross(axes_rate, state.gap))
    rate, stiffness, damping = rotate_back(state.axes, slip), NONE, NONE
    for j in range(3):
        by_value, by_rate = -elements.spring[e, j], -elements.damper[e, j]
        if elements.spring_law[e, j] >= 0:
            by_value -= law_slope(laws, elements.spring_law[e, j], state.deflection[j])
        if elements.damper_law[e, j] >= 0:
            by_rate -= law_slope(laws, elements.damper_law[e, j], rate[j])
        along = dyad(state.axes[j], state.axes[j])
        stiffness, damping = plus(stiffness, times(by_value, along)), plus(damping, times(by_rate, along))
    point = add(state.place, scale(1.0 - turn, state.gap))
    return ElementBase(
        state.axes,
        a_upper,
        a_lower,
        state.gap,
        slip,
        axes_rate,
        rotate(state.axes, state.force),
        subtract(point, upper.position),
        subtract(point, lower.position),
        stiffness,
        damping,
        scale(wheelset, lower.axes[1]),
        axes_turns(turn, upper.axes, lower.axes),
    )


@analytic
def force_slopes(
    base: ElementBase, turn: float, is_upper: bool, body_rate: Vector, stiffness: Matrix, damping: Matrix, force: Vector
) -> Slopes:
    """Derivatives of a force by the motion of a body of an element.

    Parameters:
        base: the element.
        turn: part of the rotation from the lower to the upper body that its axes make.
        is_upper: whether it is the upper body.
        body_rate: rad/s, of the body.
        stiffness, damping: slopes of the force by the gap and its rate in the element's axes.
        force: turns with these.
    """
    sign, arm, share, turned = -1.0, base.lower_arm, 1.0 - turn, base.turns[1]
    if is_upper:
        sign, arm, share, turned = 1.0, base.upper_arm, turn, base.turns[0]
    by_gap = plus(stiffness, times(-1.0, product(damping, crossing(base.axes_rate))))
    by_arm = product(plus(by_gap, product(damping, crossing(body_rate))), crossing(arm))
    by_axes = plus(product(stiffness, crossing(base.gap)), product(damping, crossing(base.slip)))
    by_axes = plus(by_axes, times(-1.0, crossing(force)))
    lever = subtract(scale(share, base.gap), scale(sign, arm))
    return Slopes(
        times(sign, by_gap),
        plus(times(-sign, by_arm), product(by_axes, turned)),
        times(sign, damping),
        product(damping, crossing(lever)),
    )


@analytic
def moment_slopes(base: ElementBase, turn: float, is_upper: bool, own: bool, lever: Vector, forces: Slopes) -> Slopes:
    """Derivatives of the moment of the force of an element about the centre of a body.

    Parameters:
        base, turn, is_upper: as for `force_slopes`.
        own: whether the moment is about the centre of the body that moves.
        lever: m, of the force.
        forces: derivatives of the force.
    """
    part, arm = (1.0 - turn, base.upper_arm) if is_upper else (turn, base.lower_arm)
    force, levers = crossing(base.force), crossing(lever)
    return Slopes(
        plus(times((1.0 if own else 0.0) - part, force), product(levers, forces.position)),
        plus(times(part, product(force, crossing(arm))), product(levers, forces.turn)),
        product(levers, forces.velocity),
        product(levers, forces.rate),
    )


@analytic
def without_axle(base: ElementBase, moments: Slopes, moves: bool) -> Slopes:
    """Derivatives of a moment on the lower body without its part about an axle; moves: whether that body does."""
    axle, moment = base.axle, cross(base.lower_lever, base.force)
    across = plus(IDENTITY, times(-1.0, dyad(axle, axle)))
    turn = product(across, moments.turn)
    if moves:
        bent = plus(times(dot(moment, axle), crossing(axle)), times(-1.0, dyad(axle, cross(axle, moment))))
        turn = plus(turn, bent)
    return Slopes(
        product(across, moments.position),
        turn,
        product(across, moments.velocity),
        product(across, moments.rate),
    )


@analytic
def add_slopes(values: Array, first: int, slopes: Slopes) -> None:
    """Add to three rows (3, 12) of values from a first one on."""
    for d in range(3):
        for k in range(3):
            values[first + d, k] += slopes.position[k][d]
            values[first + d, 3 + k] += slopes.turn[k][d]
            values[first + d, 6 + k] += slopes.velocity[k][d]
            values[first + d, 9 + k] += slopes.rate[k][d]


@analytic
def add_element(base: ElementBase, turn: float, upper: Motion, lower: Motion, values: Array) -> None:
    """Add the derivatives of force and moments (2, 9, 12) by the motions of the upper and the lower body."""
    for side in range(2):
        is_upper = side == 0
        body_rate = upper.rate if is_upper else lower.rate
        forces = force_slopes(base, turn, is_upper, body_rate, base.stiffness, base.damping, base.force)
        add_slopes(values[side], 0, forces)
        add_slopes(values[side], 3, moment_slopes(base, turn, is_upper, is_upper, base.upper_lever, forces))
        on_lower = moment_slopes(base, turn, is_upper, not is_upper, base.lower_lever, forces)
        add_slopes(values[side], 6, without_axle(base, on_lower, not is_upper))


@unchecked
def fill_series(
    elements: ElementArrays,
    e: int,
    base: ElementBase,
    upper: Motion,
    lower: Motion,
    series: Array,
    result: SuspensionSlopes,
) -> None:
    """Fill the derivatives of and by the Maxwell elements of element e; parameters as for `element_base`."""
    zero, turn = (0.0, 0.0, 0.0), elements.turn[e]
    own, rates = transposed(base.axes), np.zeros((3, MOTIONS))
    for j in range(3):
        m = elements.series[e, j]
        if m < 0:
            continue
        for side in range(2):
            rates[:] = 0.0
            body_rate = upper.rate if side == 0 else lower.rate
            add_slopes(rates, 0, force_slopes(base, turn, side == 0, body_rate, NONE, own, zero))
            result.rate[m, side] = rates[j]
        stiffness = elements.series_stiffness[m]
        force = scale(-stiffness, base.axes[j])
        on_upper, on_lower = cross(base.upper_lever, force), cross(base.lower_lever, force)
        on_lower = subtract(on_lower, scale(dot(on_lower, base.axle), base.axle))
        for d in range(3):
            result.series[m, 0, d], result.series[m, 1, d] = force[d], -force[d]
            result.series[m, 0, 3 + d], result.series[m, 1, 3 + d] = on_upper[d], -on_lower[d]
        if elements.series_law[m] >= 0:
            slope = law_slope(elements.laws, elements.series_law[m], stiffness * series[m])
            result.decay[m] = -slope * stiffness
        else:
            result.decay[m] = -stiffness / elements.series_damping[m]


@analytic
def spring_slopes(elements: ElementArrays, r: int, upper: Motion, lower: Motion, values: Array) -> None:
    """Fill the derivatives (2, 3, 3) of the moment of rotational spring r on the upper body by the rotation vectors of
    the upper and the lower one; those of the rotation from one to the other by complex steps.
    """
    together = crossing(scale(-1.0, spring_moment(elements, r, upper, lower)))
    for k in range(3):
        turn = IDENTITY[k]
        x, y, z = cross(turn, upper.axes[0]), cross(turn, upper.axes[1]), cross(turn, upper.axes[2])
        axes = (turned(upper.axes[0], x), turned(upper.axes[1], y), turned(upper.axes[2], z))
        fixed = (turned(lower.axes[0], NONE[0]), turned(lower.axes[1], NONE[1]), turned(lower.axes[2], NONE[2]))
        place = axes[0]
        moment = spring_moment(elements, r, Motion(place, place, axes, place), Motion(place, place, fixed, place))
        for d in range(3):
            values[0, d, k] = moment[d].imag / STEP
            values[1, d, k] = together[k][d] - moment[d].imag / STEP


@analytic
def turned(a: Vector, change: Vector) -> Vector:
    """A vector whose imaginary parts are its change times `STEP`."""
    return complex(a[0], STEP * change[0]), complex(a[1], STEP * change[1]), complex(a[2], STEP * change[2])


@unchecked
def add_suspension(
    elements: ElementArrays, wheelset: Array, motions: Array, series: Array, rates: Array, result: SuspensionSlopes
) -> None:
    """Add the derivatives of all elements and rotational springs.

    Parameters:
        elements: of the vehicle.
        wheelset: (n,) 1 for wheelsets, otherwise 0.
        motions: (n, 6, 3), see `motion_in`.
        series, rates: (m,) m and m/s, of Maxwell elements, which are filled.
        result: zero or filled before.

    Those of elements that are mirror images of each other are added first, as their forces are.
    """
    pair, springs = np.empty((2, 9, MOTIONS)), np.empty((2, 3, 3))
    for p in range(len(elements.pairs)):
        first = elements.pairs[p, 0]
        bodies = (elements.upper[first], elements.lower[first])
        upper, lower = motion_in(motions[bodies[0]]), motion_in(motions[bodies[1]])
        pair[:] = 0.0
        for k in range(2):
            e = elements.pairs[p, k]
            if e >= 0:
                base = element_base(elements, e, upper, lower, wheelset[bodies[1]], series, rates)
                add_element(base, elements.turn[e], upper, lower, pair)
                fill_series(elements, e, base, upper, lower, series, result)
        for side in range(2):
            on_upper, on_lower = result.wrench[bodies[0], bodies[side]], result.wrench[bodies[1], bodies[side]]
            result.coupled[bodies[0], bodies[side]] = result.coupled[bodies[1], bodies[side]] = 1
            for d in range(3):
                for k in range(MOTIONS):
                    on_upper[d, k] += pair[side, d, k]
                    on_lower[d, k] -= pair[side, d, k]
                    on_upper[3 + d, k] += pair[side, 3 + d, k]
                    on_lower[3 + d, k] -= pair[side, 6 + d, k]
    for r in range(len(elements.spring_upper)):
        bodies = (elements.spring_upper[r], elements.spring_lower[r])
        spring_slopes(elements, r, motion_in(motions[bodies[0]]), motion_in(motions[bodies[1]]), springs)
        for side in range(2):
            result.coupled[bodies[0], bodies[side]] = result.coupled[bodies[1], bodies[side]] = 1
            for d in range(3):
                for k in range(3):
                    result.wrench[bodies[0], bodies[side], 3 + d, 3 + k] += springs[side, d, k]
                    result.wrench[bodies[1], bodies[side], 3 + d, 3 + k] -= springs[side, d, k]
