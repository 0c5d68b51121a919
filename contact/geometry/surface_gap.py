"""Gap of the undeformed surfaces of a wheel and a rail: the smallest distance of their points, always a number."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.line_scan import Lines, scan
from wheelrail.contact.geometry.rigid_search import deepest
from wheelrail.meshes.curves.closest_point import Shape
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, unchecked

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
SECTIONS = 28  # of an interval of two lines, down to 1e-9 m


@unchecked
def nearest_place(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, lines: Lines
) -> tuple[float, float, float]:
    """Position s m on the wheel's profile, penetration and x m where the penetration is largest; separated surfaces
    have minus their gap.

    Parameters:
        wheel, rail: shapes of the profiles.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        lines: of the wheel's profile.
    """
    s, n = lines.s, len(lines.s)
    depth, _, where, _ = scan(rail, lines, radius, origin, rotation, (0, n))
    highest, place, largest, x = depth.max(), 0.0, -np.inf, 0.0
    for i in range(n):
        before, after = max(i - 1, 0), min(i + 1, n - 1)
        # the penetration changes by at most the way along the profile
        if depth[i] >= max(depth[before], depth[after], highest - (s[after] - s[before])):
            own = _best(wheel, rail, radius, origin, rotation, s[before], s[after], where[i])
            if own[1] > largest:
                place, largest, x = own
    return place, largest, x


@borrowing
def _best(
    wheel: Shape, rail: Shape, radius: float, origin: Array, rotation: Array, low: float, high: float, x: float
) -> tuple[float, float, float]:
    """Position, penetration and x m of the largest penetration between two positions m, by golden sections."""
    step = GOLDEN * (high - low)
    left, right = high - step, low + step
    a = deepest(wheel, rail, radius, origin, rotation, left, x, -1)
    b = deepest(wheel, rail, radius, origin, rotation, right, x, -1)
    for _ in range(SECTIONS):
        step *= GOLDEN
        if a[0] > b[0]:
            high, right, b = right, left, a
            left = high - step
            a = deepest(wheel, rail, radius, origin, rotation, left, x, -1)
        else:
            low, left, a = left, right, b
            right = low + step
            b = deepest(wheel, rail, radius, origin, rotation, right, x, -1)
    return (left, a[0], a[2]) if a[0] > b[0] else (right, b[0], b[2])
