"""Changes of the forces of suspension elements by the motion of a body, in closed form and compiled.

With the rotation vectors t of the bodies and of the element's axes, changes of a vector a that turns with them are
t x a. Symbols: `wheelrail.vehicle.multibody.compiled.elements`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array, Complex
from wheelrail.vehicle.multibody.compiled.bodies import Motion, motion_in
from wheelrail.vehicle.multibody.compiled.elements import (
    ElementArrays,
    direction_force,
    element_axes,
    element_state,
    spring_moment,
)
from wheelrail.vehicle.multibody.compiled.vectors import (
    Matrix,
    Vector,
    add,
    analytic,
    cross,
    dot,
    multiply,
    rotate,
    rotate_back,
    scale,
    subtract,
)

PARTS = 14  # vectors of an element in `store_element`


class ElementBase(NamedTuple):
    """An element in the motion about which changes are taken: real vectors in common axes, but for both slopes.

    Parameters:
        axes: of the element.
        upper_arm, lower_arm: m, of its points from the centres of the bodies.
        gap: m, from the lower to the upper point.
        slip: m/s, rate of the gap in the element's axes.
        axes_rate: rad/s.
        force: N on the upper body.
        upper_lever, lower_lever: m, of the force from the centres of the bodies.
        stiffness, damping: N/m and N s/m, slopes of the three forces by deflection and rate.
        axle: of a lower body that is a wheelset, otherwise zero: it bears no moment about it.
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
    stiffness: Vector
    damping: Vector
    axle: Vector


class BodyChange(NamedTuple):
    """Change of the motion of a body, real: position m, rotation rad, velocity m/s and angular velocity rad/s."""

    position: Vector
    turn: Vector
    velocity: Vector
    rate: Vector


class WrenchChange(NamedTuple):
    """Changes of the force N on the upper body, of the moments N m of `ElementWrench`, and of the rate m/s of the
    deflection.
    """

    force: Vector
    on_upper: Vector
    on_lower: Vector
    rate: Vector


@analytic
def real(a: Vector) -> Vector:
    """Vector parts."""
    return a[0].real, a[1].real, a[2].real


@analytic
def imaginary(a: Vector, step: float) -> Vector:
    """Imaginary parts over a step."""
    return a[0].imag / step, a[1].imag / step, a[2].imag / step


@analytic
def turn_of(axes: Matrix, step: float) -> Vector:
    """Rotation vector of axes whose imaginary parts are their change times a step."""
    x = cross(real(axes[0]), imaginary(axes[0], step))
    y = cross(real(axes[1]), imaginary(axes[1], step))
    z = cross(real(axes[2]), imaginary(axes[2], step))
    return scale(0.5, add(add(x, y), z))


@analytic
def body_change(motion: Motion, step: float) -> BodyChange:
    """Change of a motion whose imaginary parts are it times a step."""
    return BodyChange(
        imaginary(motion.position, step),
        turn_of(motion.axes, step),
        imaginary(motion.velocity, step),
        imaginary(motion.rate, step),
    )


@analytic
def element_base(
    elements: ElementArrays, e: int, upper: Motion, lower: Motion, wheelset: float, series: Complex, step: float
) -> ElementBase:
    """Element e in a motion of its bodies.

    Parameters:
        elements, e, upper, lower, wheelset, series: as for `wheelrail.vehicle.multibody.compiled.elements`.
        step: of the derivatives of the force laws by complex steps.
    """
    rates, turn = np.zeros_like(series), elements.turn[e]
    state = element_state(elements, e, upper, lower, series, rates)
    arms = (elements.upper_arm, elements.lower_arm)
    a_upper = rotate(upper.axes, (arms[0][e, 0], arms[0][e, 1], arms[0][e, 2]))
    a_lower = rotate(lower.axes, (arms[1][e, 0], arms[1][e, 1], arms[1][e, 2]))
    axes_rate = add(scale(1.0 - turn, lower.rate), scale(turn, upper.rate))
    gap_rate = subtract(
        add(upper.velocity, cross(upper.rate, a_upper)), add(lower.velocity, cross(lower.rate, a_lower))
    )
    slip = subtract(gap_rate, cross(axes_rate, state.gap))
    rate = rotate_back(state.axes, slip)
    slopes = np.empty((2, 3))
    for j in range(3):
        value = real(state.deflection)[j]
        by_value = direction_force(elements, e, j, complex(value, step), rate[j], series, rates)
        by_rate = direction_force(elements, e, j, value + 0.0j, complex(rate[j].real, step), series, rates)
        slopes[0, j], slopes[1, j] = by_value.imag / step, by_rate.imag / step
    point = add(state.place, scale(1.0 - turn, state.gap))
    return ElementBase(
        (real(state.axes[0]), real(state.axes[1]), real(state.axes[2])),
        real(a_upper),
        real(a_lower),
        real(state.gap),
        real(slip),
        real(axes_rate),
        real(rotate(state.axes, state.force)),
        real(subtract(point, upper.position)),
        real(subtract(point, lower.position)),
        (slopes[0, 0], slopes[0, 1], slopes[0, 2]),
        (slopes[1, 0], slopes[1, 1], slopes[1, 2]),
        scale(wheelset, real(lower.axes[1])),
    )


@analytic
def store_element(base: ElementBase, values: Array) -> None:
    """Fill (14, 3)."""
    for k in range(3):
        values[0, k], values[1, k], values[2, k] = base.axes[0][k], base.axes[1][k], base.axes[2][k]
        values[3, k], values[4, k], values[5, k] = base.upper_arm[k], base.lower_arm[k], base.gap[k]
        values[6, k], values[7, k], values[8, k] = base.slip[k], base.axes_rate[k], base.force[k]
        values[9, k], values[10, k] = base.upper_lever[k], base.lower_lever[k]
        values[11, k], values[12, k], values[13, k] = base.stiffness[k], base.damping[k], base.axle[k]


@analytic
def row(values: Array, i: int) -> Vector:
    return values[i, 0], values[i, 1], values[i, 2]


@analytic
def element_of(values: Array) -> ElementBase:
    """Element of (14, 3), see `store_element`."""
    return ElementBase(
        (row(values, 0), row(values, 1), row(values, 2)),
        row(values, 3),
        row(values, 4),
        row(values, 5),
        row(values, 6),
        row(values, 7),
        row(values, 8),
        row(values, 9),
        row(values, 10),
        row(values, 11),
        row(values, 12),
        row(values, 13),
    )


@analytic
def axes_turn(turn: float, upper: Complex, lower: Complex, change: Vector, is_upper: bool, step: float) -> Vector:
    """Rotation vector of an element's axes.

    Parameters:
        turn: part of the rotation from the lower to the upper body that they make.
        upper, lower: motions (6, 3), whose imaginary parts are their change times the step.
        change: rotation vector of the body that moves.
        is_upper: whether that is the upper one.
        step: of the imaginary parts.
    """
    if turn == 0.0:
        return scale(0.0 if is_upper else 1.0, change)
    if turn == 1.0:
        return scale(1.0 if is_upper else 0.0, change)
    return turn_of(element_axes(turn, motion_in(upper).axes, motion_in(lower).axes), step)


@analytic
def wrench_change(
    base: ElementBase, turn: float, moved: BodyChange, body_rate: Vector, is_upper: bool, axes: Vector
) -> WrenchChange:
    """Change of force and moments by the motion of one of an element's bodies.

    Parameters:
        base: the element.
        turn: part of the rotation from the lower to the upper body that its axes make.
        moved: change of the body's motion.
        body_rate: rad/s, angular velocity of the body.
        is_upper: whether it is the upper one.
        axes: rotation vector of the element's axes.
    """
    sign, arm = (1.0, base.upper_arm) if is_upper else (-1.0, base.lower_arm)
    swing = cross(moved.turn, arm)
    place = add(moved.position, swing)
    gap = scale(sign, place)
    gap_rate = scale(sign, add(add(moved.velocity, cross(moved.rate, arm)), cross(body_rate, swing)))
    axes_rate = scale(turn if is_upper else 1.0 - turn, moved.rate)
    slip = subtract(gap_rate, add(cross(axes_rate, base.gap), cross(base.axes_rate, gap)))
    deflection = rotate_back(base.axes, subtract(gap, cross(axes, base.gap)))
    rate = rotate_back(base.axes, subtract(slip, cross(axes, base.slip)))
    local = add(multiply(base.stiffness, deflection), multiply(base.damping, rate))
    force = add(cross(axes, base.force), rotate(base.axes, local))
    point = scale(1.0 - turn, gap) if is_upper else subtract(place, scale(1.0 - turn, place))
    on_upper = subtract(point, moved.position) if is_upper else point
    on_lower = point if is_upper else subtract(point, moved.position)
    on_upper = add(cross(on_upper, base.force), cross(base.upper_lever, force))
    on_lower = add(cross(on_lower, base.force), cross(base.lower_lever, force))
    axle, bent = base.axle, (0.0, 0.0, 0.0) if is_upper else cross(moved.turn, base.axle)
    moment = cross(base.lower_lever, base.force)
    along = dot(on_lower, axle) + dot(moment, bent)
    on_lower = subtract(on_lower, add(scale(along, axle), scale(dot(moment, axle), bent)))
    return WrenchChange(force, on_upper, on_lower, rate)


@analytic
def element_bases(elements: ElementArrays, wheelset: Array, motions: Complex, series: Complex, step: float) -> Array:
    """All elements (e, 14, 3) of `store_element`.

    Parameters:
        elements: of the vehicle.
        wheelset: (n,) 1 for wheelsets, otherwise 0.
        motions: (n, 6, 3), see `motion_in`.
        series, step: as for `element_base`.
    """
    result = np.empty((len(elements.upper), PARTS, 3))
    for e in range(len(result)):
        upper, lower = motion_in(motions[elements.upper[e]]), motion_in(motions[elements.lower[e]])
        store_element(element_base(elements, e, upper, lower, wheelset[elements.lower[e]], series, step), result[e])
    return result


@analytic
def add_changes(
    elements: ElementArrays, bases: Array, motions: Complex, body: int, step: float, change: Array, rates: Array
) -> None:
    """Add changes of forces and moments (n, 2, 3) by the motion of a body; those of the rates (m,) m/s of Maxwell
    elements are filled.

    Parameters:
        elements, bases: elements, and `element_bases`.
        motions: (n, 6, 3); the imaginary parts are the change of the body's motion times the step.
        body: its index.
        step: of the imaginary parts.
        change, rates: N and N m, in common axes, and m/s.

    Changes of elements that are mirror images of each other are added first, as their forces are.
    """
    own = motion_in(motions[body])
    moved, body_rate = body_change(own, step), real(own.rate)
    for p in range(len(elements.pairs)):
        upper, lower = elements.upper[elements.pairs[p, 0]], elements.lower[elements.pairs[p, 0]]
        if upper != body and lower != body:
            continue
        is_upper = bool(upper == body)
        force: Vector = (0.0, 0.0, 0.0)
        on_upper, on_lower = force, force
        for k in range(2):
            e = elements.pairs[p, k]
            if e < 0:
                continue
            turn = elements.turn[e]
            axes = axes_turn(turn, motions[upper], motions[lower], moved.turn, is_upper, step)
            wrench = wrench_change(element_of(bases[e]), turn, moved, body_rate, is_upper, axes)
            force, on_upper = add(force, wrench.force), add(on_upper, wrench.on_upper)
            on_lower = add(on_lower, wrench.on_lower)
            for j in range(3):
                if elements.series[e, j] >= 0:
                    rates[elements.series[e, j]] = wrench.rate[j]
        for d in range(3):
            change[upper, 0, d] += force[d]
            change[upper, 1, d] += on_upper[d]
            change[lower, 0, d] -= force[d]
            change[lower, 1, d] -= on_lower[d]
    for r in range(len(elements.spring_upper)):
        upper, lower = elements.spring_upper[r], elements.spring_lower[r]
        if upper == body or lower == body:
            moment = imaginary(spring_moment(elements, r, motion_in(motions[upper]), motion_in(motions[lower])), step)
            for d in range(3):
                change[upper, 1, d] += moment[d]
                change[lower, 1, d] -= moment[d]
