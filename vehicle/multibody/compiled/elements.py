"""Forces of suspension elements and rotational springs in compiled code.

Equations and symbols: `wheelrail.vehicle.multibody.suspension_forces` and docs/theory/multibody.md.
"""

from __future__ import annotations

from typing import NamedTuple

from wheelrail.support.arrays import Array, Nodes
from wheelrail.vehicle.multibody.compiled.bodies import Motion
from wheelrail.vehicle.multibody.compiled.vectors import (
    Matrix,
    Vector,
    add,
    analytic,
    cross,
    dot,
    moment_of_gradient,
    multiply,
    product,
    relative_rotation,
    rotate,
    rotate_back,
    rotation_matrix,
    rotation_vector,
    scale,
    subtract,
)


class LawArrays(NamedTuple):
    """Piecewise linear force laws.

    Parameters:
        first: (l + 1,) index of each law's first point, and number of all points.
        odd: (l,) whether a law is odd.
        abscissae, forces: (p,) of all points.
    """

    first: Nodes
    odd: Nodes
    abscissae: Array
    forces: Array


class ElementArrays(NamedTuple):
    """Suspension elements (e,) and rotational springs (r,).

    Parameters:
        upper, lower: (e,) indices of the bodies.
        upper_arm, lower_arm: (e, 3) m, of the points from the bodies' centres, in their axes.
        turn: (e,) part of the rotation from the lower to the upper body that the axes make.
        static_load: (e,) N.
        spring, damper: (e, 3) N/m and N s/m; those of dampers in series with springs are zero.
        spring_law, damper_law: (e, 3) index of a force law; -1: none.
        series: (e, 3) index of the Maxwell element; -1: none.
        series_stiffness, series_damping: (m,) N/m and N s/m of Maxwell elements; damping 0: by a law.
        series_law: (m,) index of the law of velocity over force; -1: none.
        laws: force laws.
        pairs: (p, 2) mirror images of each other in y = 0, whose forces are added first; -1: without.
        spring_upper, spring_lower: (r,) bodies of rotational springs.
        rotational_stiffness: (r, 3) N m/rad.
    """

    upper: Nodes
    lower: Nodes
    upper_arm: Array
    lower_arm: Array
    turn: Array
    static_load: Array
    spring: Array
    damper: Array
    spring_law: Nodes
    damper_law: Nodes
    series: Nodes
    series_stiffness: Array
    series_damping: Array
    series_law: Nodes
    laws: LawArrays
    pairs: Nodes
    spring_upper: Nodes
    spring_lower: Nodes
    rotational_stiffness: Array


@analytic
def law_piece(laws: LawArrays, law: int, value: float) -> int:
    """Index of the first point of the piece of a force law at a value; of an odd law, at its mirror image."""
    x, last = abs(value) if laws.odd[law] else value, laws.first[law + 1] - 2
    i: int = laws.first[law]
    while i < last and x >= laws.abscissae[i + 1]:
        i += 1
    return i


@analytic
def law_slope(laws: LawArrays, law: int, value: float) -> float:
    """Slope of a force law, at a point that behind it."""
    i = law_piece(laws, law, value)
    slope: float = (laws.forces[i + 1] - laws.forces[i]) / (laws.abscissae[i + 1] - laws.abscissae[i])
    return slope


@analytic
def law_force(laws: LawArrays, law: int, value: float) -> float:
    """Value of a force law, linear between its points and beyond them."""
    sign, i = -1.0 if laws.odd[law] and value < 0.0 else 1.0, law_piece(laws, law, value)
    point = i if laws.abscissae[i] >= 0.0 else i + 1  # the end nearer to zero: mirrored laws agree bit for bit
    rise = law_slope(laws, law, value) * (sign * value - laws.abscissae[point])
    force: float = sign * (rise + laws.forces[point])
    return force


@analytic
def direction_force(
    elements: ElementArrays, e: int, j: int, value: float, rate: float, series: Array, series_rate: Array
) -> float:
    """Force N on the upper body along direction j of element e; fills the rate of its Maxwell element.

    Parameters:
        elements, e, j: all elements, index of this one, and direction.
        value, rate: deflection m and its rate m/s.
        series, series_rate: (m,) spring deflections m of Maxwell elements and their rates m/s.
    """
    force: float = -elements.spring[e, j] * value - elements.damper[e, j] * rate
    if elements.spring_law[e, j] >= 0:
        force -= law_force(elements.laws, elements.spring_law[e, j], value)
    if elements.damper_law[e, j] >= 0:
        force -= law_force(elements.laws, elements.damper_law[e, j], rate)
    m = elements.series[e, j]
    if m >= 0:
        spring_force = elements.series_stiffness[m] * series[m]
        if elements.series_law[m] >= 0:
            series_rate[m] = rate - law_force(elements.laws, elements.series_law[m], spring_force)
        else:
            series_rate[m] = rate - spring_force / elements.series_damping[m]
        force -= spring_force
    return force


class ElementState(NamedTuple):
    """Axes of an element, its lower point m and the upper point's distance from it m, in common axes; the deflection m
    and the force N on the upper body, static load included, in its own axes.
    """

    axes: Matrix
    place: Vector
    gap: Vector
    deflection: Vector
    force: Vector


class ElementWrench(NamedTuple):
    """Force N on the upper body, and moments N m about the centres of the upper and the lower one, in common axes."""

    force: Vector
    on_upper: Vector
    on_lower: Vector


@analytic
def element_axes(turn: float, upper: Matrix, lower: Matrix) -> Matrix:
    """Axes that turn with the lower body (turn 0), the upper body (1), or in between."""
    if turn == 0.0:
        return lower
    if turn == 1.0:
        return upper
    return product(lower, rotation_matrix(scale(turn, rotation_vector(relative_rotation(lower, upper)))))


@analytic
def element_state(
    elements: ElementArrays, e: int, upper: Motion, lower: Motion, series: Array, series_rate: Array
) -> ElementState:
    """Deflection and force of element e, parameters as for `element_wrench`."""
    arms, turn = (elements.upper_arm, elements.lower_arm), elements.turn[e]
    a_upper = rotate(upper.axes, (arms[0][e, 0], arms[0][e, 1], arms[0][e, 2]))
    a_lower = rotate(lower.axes, (arms[1][e, 0], arms[1][e, 1], arms[1][e, 2]))
    p_lower = add(lower.position, a_lower)
    gap = subtract(add(upper.position, a_upper), p_lower)
    gap_rate = subtract(
        add(upper.velocity, cross(upper.rate, a_upper)), add(lower.velocity, cross(lower.rate, a_lower))
    )
    axes = element_axes(turn, upper.axes, lower.axes)
    axes_rate = add(scale(1.0 - turn, lower.rate), scale(turn, upper.rate))
    value, rate = rotate_back(axes, gap), rotate_back(axes, subtract(gap_rate, cross(axes_rate, gap)))
    x = direction_force(elements, e, 0, value[0], rate[0], series, series_rate)
    y = direction_force(elements, e, 1, value[1], rate[1], series, series_rate)
    z = direction_force(elements, e, 2, value[2], rate[2], series, series_rate)
    return ElementState(axes, p_lower, gap, value, (x, y, z + elements.static_load[e]))


@analytic
def element_wrench(
    elements: ElementArrays,
    e: int,
    upper: Motion,
    lower: Motion,
    wheelset: float,
    series: Array,
    series_rate: Array,
) -> ElementWrench:
    """Force and moments of element e.

    Parameters:
        elements, e: all elements, and index of this one.
        upper, lower: motion of its bodies.
        wheelset: 1 if the lower body is a wheelset, otherwise 0.
        series, series_rate: (m,) spring deflections m of Maxwell elements and their rates m/s, which are filled.
    """
    state = element_state(elements, e, upper, lower, series, series_rate)
    force = rotate(state.axes, state.force)
    point = add(state.place, scale(1.0 - elements.turn[e], state.gap))
    on_upper = cross(subtract(point, upper.position), force)
    on_lower = cross(subtract(point, lower.position), force)
    # Bearings transmit no moment about the axle of a wheelset.
    axle = lower.axes[1]
    on_lower = subtract(on_lower, scale(wheelset * dot(on_lower, axle), axle))
    return ElementWrench(force, on_upper, on_lower)


@analytic
def spring_moment(elements: ElementArrays, r: int, upper: Motion, lower: Motion) -> Vector:
    """Moment N m of rotational spring r on the upper body, in common axes."""
    stiffness = elements.rotational_stiffness
    turned = rotation_vector(relative_rotation(lower.axes, upper.axes))
    gradient = multiply((stiffness[r, 0], stiffness[r, 1], stiffness[r, 2]), turned)
    return rotate(lower.axes, scale(-1.0, moment_of_gradient(turned, gradient)))
