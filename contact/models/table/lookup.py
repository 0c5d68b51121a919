"""Compiled look-up of the values of a table of contact forces, with their derivatives by the table's variables."""

from __future__ import annotations

from wheelrail.contact.models.table.interpolation import Grid, along, between, fast, nodes_of, stencil
from wheelrail.support.arrays import Array

LEVEL, LONGITUDINAL, LATERAL = 3, 4, 5  # axes, after those of the position: y, roll, yaw
Position = tuple[float, float, float, float]  # y, roll, yaw and z of the tread, m, rad, rad, m


@fast
def level_at(nodes: Array, heights: Array, z: float) -> float:
    """Level at which the interpolated height is z.

    Parameters:
        nodes: levels (n,).
        heights: (n,) m, decreasing.
        z: m, between the first and the last.

    Newton's method, kept in the interval by bisection; after a step below 1e-8 of the interval the next one would be
    below round-off.
    """
    k = 0
    while k < len(nodes) - 2 and z <= heights[k + 1]:
        k += 1
    low, high = nodes[k], nodes[k + 1]
    length = high - low
    level: float = low + length * (heights[k] - z) / (heights[k] - heights[k + 1])
    for _ in range(60):
        first, count, weights, slopes = stencil(nodes, level)
        height, slope = 0.0, 0.0
        for n in range(count):
            height += weights[n] * heights[first + n]
            slope += slopes[n] * heights[first + n]
        if height > z:
            low = level
        else:
            high = level
        before, level = level, level + (z - height) / slope
        if not low <= level <= high:
            level = 0.5 * (low + high)
        if abs(level - before) < 1e-8 * length:
            break
    return level


@fast
def contact_at(normal: Grid, position: Position, slopes: bool) -> tuple[float, Array]:
    """Depth m below first contact, and values (1, 9) at y, roll, yaw and z: level, then those after the height.

    The level is the depth where there is no contact, and grows linearly beyond the last one, with the values of that.
    With slopes (5, 9): the derivatives of these values, in contact, follow.

    Parameters:
        normal: of a `NormalTable`.
        position: of the tread.
        slopes: whether derivatives are computed.
    """
    y, roll, yaw, z = position
    levels = nodes_of(normal, LEVEL)
    blocks = between(normal, (y, roll, yaw), 0, len(levels), slopes)
    heights = blocks[0, :: normal.columns]
    depth = heights[0] - z
    level = depth
    if z < heights[-1]:
        level = levels[-1] * (1.0 + (heights[-1] - z) / (heights[0] - heights[-1]))
    elif depth > 0.0:
        level = level_at(levels, heights, z)
    first, count, weights, changes = stencil(levels, min(max(level, 0.0), levels[-1]))
    values = along(blocks, first, count, weights, changes, normal.columns)
    if slopes:  # by level at first: the height of the level is z
        by_level = values[4].copy()
        for k in range(1, 4):
            change = -values[k, 0] / by_level[0]
            values[k] += change * by_level
            values[k, 0] = change
        values[4] = by_level / by_level[0]
        values[4, 0] = 1.0 / by_level[0]
    values[0, 0] = level
    return depth, values


@fast
def contact_of_level(normal: Grid, y: float, roll: float, yaw: float, level: float) -> Array:
    """Values (9,) of a `NormalTable` at a position and level."""
    levels = nodes_of(normal, LEVEL)
    first, count, weights, changes = stencil(levels, level)
    blocks = between(normal, (y, roll, yaw), first, count, False)
    values: Array = along(blocks, 0, count, weights, changes, normal.columns)[0]
    return values


@fast
def friction_at(friction: Grid, at: tuple[float, float, float, float, float, float], slopes: bool) -> Array:
    """Values (1, 6) of a `FrictionTable` at coordinates of all its axes; with slopes (7, 6), with their derivatives."""
    first, count, weights, changes = stencil(nodes_of(friction, LATERAL), at[5])
    blocks = between(friction, (at[0], at[1], at[2], at[3], at[4]), first, count, slopes)
    return along(blocks, 0, count, weights, changes, friction.columns)
