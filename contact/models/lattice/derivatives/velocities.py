"""Compiled: derivatives of rigid slip and rolling speed by pose and motion.

The twelve changes of pose and motion are those of `wheelrail.contact.kinematics.sensitivity`.
"""

from __future__ import annotations

from wheelrail.contact.geometry.wheel_surface import Place
from wheelrail.contact.models.lattice.derivatives.resultants import CHANGES, away, cross, dot, vector
from wheelrail.contact.models.lattice.system.equations import EquationData
from wheelrail.contact.models.lattice.system.surface import Motion, SurfaceFrames
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing


@borrowing
def add_friction_changes(
    data: EquationData,
    at: SurfaceFrames,
    crest: Array,
    slips: Array,
    slopes: Array,
    speed: Array,
    work: Array,
    total: Array,
) -> None:
    """Add the derivative of the residual of friction.

    Parameters:
        at: cells.
        crest: (S, 6), derivative of the strips' places of largest penetration.
        slips: (6, S, 2, M), derivative of the elastic slips at fixed loads.
        slopes: (S, M, SLOPES), of the friction residual.
        speed: (CHANGES,), derivative of the rolling speed.
        work: (2, CHANGES) work space.
    """
    motion, level, revolves = data.motion, data.places.level, data.surface.revolves
    M, turn = slopes.shape[1], vector(at.turn)
    for i in range(len(slopes)):
        straight = vector(level[i])
        turned = cross(turn, straight)
        for r in range(M):
            cell, by = i * M + r, slopes[i, r]
            place, x, y = vector(at.point[cell]), vector(at.axes[cell, 0]), vector(at.axes[cell, 1])
            own, other = _velocity(motion.wheel, place), _velocity(motion.rail, place)
            work[:] = 0.0
            _add_wheel_velocity(motion, place, x, own, revolves, 1.0, work[0])
            _add_rail_velocity(motion, place, straight, other, revolves, -1.0, work[0])
            _add_wheel_velocity(motion, place, y, own, revolves, 1.0, work[1])
            _add_rail_velocity(motion, place, y, other, revolves, -1.0, work[1])
            along = (dot(x, own) - dot(straight, other)) / motion.speed
            across = (dot(y, own) - dot(y, other)) / motion.speed
            by_crest = dot(turned, other) if revolves else 0.0
            for k in range(CHANGES):
                first = (work[0, k] - along * speed[k]) / motion.speed
                second = (work[1, k] - across * speed[k]) / motion.speed
                if k < 6:
                    first += slips[k, i, 0, r] - by_crest * crest[i, k] / motion.speed
                    second += slips[k, i, 1, r]
                total[i, r, k] = by[4] * first + by[5] * second + by[8] * speed[k]
                total[i, M + r, k] = by[6] * first + by[7] * second + by[9] * speed[k]


@borrowing
def store_speed_changes(
    revolves: bool,
    motion: Motion,
    at: SurfaceFrames,
    deepening: Array,
    depth: Array,
    width: Array,
    flow: Array,
    change: Array,
) -> None:
    """Fill the derivative (CHANGES,) of the rolling speed, which is zero: the mean of the flow on the n lines where
    strips touch.

    Parameters:
        revolves: whether the lines move with the upper body.
        motion: of both bodies.
        at: places of the largest penetrations.
        deepening: (n, 6), their derivative by the pose.
        depth, width: (n,) m, penetrations, and widths of the strips.
        flow: (CHANGES,) work space.
    """
    total = 0.0
    for i in range(len(depth)):
        total += depth[i] * depth[i] * width[i]
    for i in range(len(depth)):
        place, x = vector(at.point[i]), vector(at.axes[i, 0])
        own, other = _velocity(motion.wheel, place), _velocity(motion.rail, place)
        forward = motion.speed + 0.5 * (dot(x, own) + dot(x, other))
        flow[:] = 0.0
        _add_wheel_velocity(motion, place, x, own, revolves, 0.5, flow)
        _add_rail_velocity(motion, place, x, other, revolves, 0.5, flow)
        weight = depth[i] * width[i] / total
        for k in range(6):
            change[k] -= 2.0 * deepening[i, k] * weight * forward
        for k in range(CHANGES):
            change[k] -= flow[k] * depth[i] * weight


@borrowing
def _add_wheel_velocity(
    motion: Motion, place: Place, axis: Place, velocity: Place, moves: bool, factor: float, to: Array
) -> None:
    """Add the derivative (CHANGES,) of a component of the upper body's velocity, v + w x d, times a factor.

    Parameters:
        motion: of both bodies.
        place: m.
        axis: direction of the component.
        velocity: m/s, at the place.
        moves: whether place and axis move with the upper body; the reference point does.
    """
    reference = vector(motion.wheel[2])
    arm = away(place, reference)
    spin = cross(axis, vector(motion.wheel[1]))  # axis (w x d) = d spin
    by_rate = cross(arm, axis)
    if moves:
        by_turn, turned = cross(arm, spin), cross(axis, velocity)
        for c in range(3):
            to[3 + c] += factor * (by_turn[c] + turned[c])
    else:
        by_turn = cross(away(reference, vector(motion.origin)), spin)
        for c in range(3):
            to[c] -= factor * spin[c]
            to[3 + c] -= factor * by_turn[c]
    for c in range(3):
        to[6 + c] += factor * axis[c]
        to[9 + c] += factor * by_rate[c]


@borrowing
def _add_rail_velocity(
    motion: Motion, place: Place, axis: Place, velocity: Place, moves: bool, factor: float, to: Array
) -> None:
    """As `_add_wheel_velocity`, of the lower body's velocity."""
    if not moves:
        return
    arm = away(place, vector(motion.origin))
    spin = cross(axis, vector(motion.rail[1]))
    by_turn, turned = cross(arm, spin), cross(axis, velocity)
    for c in range(3):
        to[c] += factor * spin[c]
        to[3 + c] += factor * (by_turn[c] + turned[c])


@borrowing
def _velocity(body: tuple[Array, Array, Array], place: Place) -> Place:
    """Velocity m/s of a body at a place."""
    velocity, rotation, reference = body
    turned = cross(vector(rotation), away(place, vector(reference)))
    return velocity[0] + turned[0], velocity[1] + turned[1], velocity[2] + turned[2]
