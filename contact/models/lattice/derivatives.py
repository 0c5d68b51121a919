"""Compiled: derivatives of rigid slip and resultants by pose, motion and unknowns.

The twelve changes of pose and motion are those of `wheelrail.contact.kinematics.sensitivity`.
"""

from __future__ import annotations

import numpy as np

from wheelrail.contact.models.lattice.system.equations import EquationData, cell_frames, strip_grid
from wheelrail.contact.models.lattice.system.surface import (
    GAUSS,
    Motion,
    SurfaceData,
    SurfaceFrames,
    frames,
    penetration_changes,
)
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, compiled

CHANGES = 12


@borrowing
def _cross(a: Array, b: Array, to: Array) -> None:
    for c in range(3):
        first, second = (c + 1) % 3, (c + 2) % 3
        to[c] = a[first] * b[second] - a[second] * b[first]


@borrowing
def _dot(a: Array, b: Array) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@compiled
def rigid_changes(
    places: SurfaceFrames, level: Array, level_change: Array, motion: Motion, moves: bool
) -> tuple[Array, Array]:
    """Derivatives (CHANGES, n, 2) and (CHANGES, n) of shift and flow of `rigid_shift`.

    Parameters:
        places: n points of the upper body.
        level: (n, 3) longitudinal axes where the strips touch.
        level_change: (6, n, 3) their derivative by the pose.
        motion: of both bodies.
        moves: whether the points and axes move with the upper body.
    """
    n = len(places.point)
    shift, flow = np.zeros((CHANGES, n, 2)), np.zeros((CHANGES, n))
    unit, own, other = np.empty(3), np.empty(3), np.empty(3)
    own_change, other_change, x_change, y_change = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    moved, part = np.empty(3), np.empty(3)
    for i in range(n):
        point, x, y = places.point[i], places.axes[i, 0], places.axes[i, 1]
        _cross(motion.wheel[1], point - motion.wheel[2], own)
        _cross(motion.rail[1], point - motion.rail[2], other)
        own += motion.wheel[0]
        other += motion.rail[0]
        for k in range(CHANGES):
            unit[:] = 0.0
            unit[k % 3] = 1.0
            x_change[:] = 0.0
            y_change[:] = 0.0
            other_change[:] = 0.0
            if k < 6:
                if k < 3:
                    moved[:] = 0.0
                    if moves:
                        moved[:] = unit
                    part[:] = moved - unit  # the reference point moves with the frame
                else:
                    _cross(unit, point - motion.origin, moved)
                    if not moves:
                        moved[:] = 0.0
                    _cross(unit, motion.wheel[2] - motion.origin, part)
                    part[:] = moved - part
                    if moves:
                        _cross(unit, x, x_change)
                        _cross(unit, y, y_change)
                _cross(motion.wheel[1], part, own_change)
                _cross(motion.rail[1], moved, other_change)
                shift[k, i, 0] -= _dot(level_change[k, i], other)
            elif k < 9:
                own_change[:] = unit
            else:
                _cross(unit, point - motion.wheel[2], own_change)
            shift[k, i, 0] += _dot(x, own_change) + _dot(x_change, own) - _dot(level[i], other_change)
            shift[k, i, 1] = _dot(y, own_change) - _dot(y, other_change) + _dot(y_change, own) - _dot(y_change, other)
            flow[k, i] = 0.5 * (
                _dot(x, own_change) + _dot(x, other_change) + _dot(x_change, own) + _dot(x_change, other)
            )
    return shift, flow


@compiled
def speed_change(
    surface: SurfaceData, motion: Motion, s: Array, x: Array, depth: Array, width: Array, moves: bool
) -> Array:
    """Derivative (CHANGES,) of the rolling speed, the mean of the flow on the lines where strips touch.

    Parameters:
        surface, motion: of both bodies.
        s, x, depth, width: (n,) m, places of the largest penetrations, these, and widths of the strips.
        moves: see `rigid_changes`.
    """
    n = len(s)
    at = frames(surface, motion.origin, motion.rotation, s, x)
    level = at.axes[:, 0].copy()
    _, flow = rigid_changes(at, level, np.zeros((6, n, 3)), motion, moves)
    total, change, velocity = 0.0, np.zeros(CHANGES), np.empty(3)
    for i in range(n):
        total += depth[i] * depth[i] * width[i]
    for side in range(2):
        points = penetration_changes(surface, motion.origin, motion.rotation, s + (2 * side - 1) * GAUSS * width, x)
        for i in range(n):
            forward = motion.speed
            for body in (motion.wheel, motion.rail):
                _cross(body[1], at.point[i] - body[2], velocity)
                forward += 0.5 * (_dot(at.axes[i, 0], velocity) + _dot(at.axes[i, 0], body[0]))
            for k in range(6):
                change[k] -= points.depth[i, k] * depth[i] * width[i] * forward / total
    for i in range(n):
        for k in range(CHANGES):
            change[k] -= flow[k, i] * depth[i] * depth[i] * width[i] / total
    return change


@compiled
def resultant_slopes(values: Array, data: EquationData) -> Array:
    """Derivative (6, S block) of `resultants` by the unknowns."""
    places, basis = data.places, data.basis
    S, block = values.shape
    M, modes = len(basis.marks) - 1, basis.mean.shape[1]
    rolls = data.motion.speed > 0.0
    first = 2 * M if rolls else 0
    at = cell_frames(values, places, basis, data.surface, data.motion)
    grid = strip_grid(values, places, basis)
    slopes = np.zeros((6, S * block))
    unit, load, part = np.zeros((3, 6)), np.empty(6), np.empty(3)
    for i in range(S):
        column = i * block
        low, high = column + block - 2, column + block - 1
        for r in range(M):
            cell = i * M + r
            mark = basis.marks[r + 1] - basis.marks[r]
            middle = 0.5 * (basis.marks[r] + basis.marks[r + 1])
            area = grid.length[i] * mark * places.width[i]
            for k in range(3):
                unit[k, :3] = area * at.axes[cell, k]
                _cross(at.point[cell], unit[k, :3], unit[k, 3:])
            pressure = 0.0
            for m in range(modes):
                pressure += values[i, first + m] * basis.mean[r, m]
            load[:] = -pressure * unit[2]
            if rolls:
                load += values[i, r] * unit[0] + values[i, M + r] * unit[1]
                slopes[:, column + r] = unit[0]
                slopes[:, column + M + r] = unit[1]
            for m in range(modes):
                slopes[:, column + first + m] -= basis.mean[r, m] * unit[2]
            longer = load / (values[i, -1] - values[i, -2])
            slopes[:, low] -= longer
            slopes[:, high] += longer
            # the cell moves along x: its axes turn, and its point moves forward
            _cross(at.turn, load[:3], part)
            moved = np.empty(6)
            moved[:3] = part
            _cross(at.point[cell], moved[:3], moved[3:])
            _cross(at.forward[cell], load[:3], part)
            moved[3:] += part
            slopes[:, low] += (1.0 - middle) * moved
            slopes[:, high] += middle * moved
    return slopes
