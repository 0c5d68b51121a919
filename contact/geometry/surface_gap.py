"""Gap of the undeformed surfaces of a wheel and a rail: the smallest distance of their points, always a number."""

from __future__ import annotations

import numpy as np

from wheelrail.contact.geometry.line_scan import Lines, lines_to_scan, scan
from wheelrail.contact.geometry.rigid_search import Scan, deepest, stationary_point
from wheelrail.meshes.curves.closest_point import Shape
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import borrowing, unchecked

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
SAMPLED = 1e-6  # m, error of the gap on sampled lines
SECTIONS = 28  # of an interval of two lines, down to 1e-9 m


@unchecked
def nearest_place(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    lines: Lines,
    part: tuple[int, int],
    samples: Scan,
) -> tuple[float, float, float]:
    """Position s m on the wheel's profile, penetration and x m where the penetration is largest; separated surfaces
    have minus their gap.

    Parameters:
        wheel, rail: shapes of the profiles.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        lines: of the wheel's profile.
        part: first of the lines that may overlap the rail, and one past the last.
        samples: their scan.
    """
    s = lines.s
    highest = samples.depth[part[0] : part[1]].max()
    if highest < 0.0:  # others may be nearer
        near = lines_to_scan(lines, radius, origin, rotation, -highest)
        if near != part:
            part, samples = near, scan(rail, lines, radius, origin, rotation, near)
            highest = samples.depth[part[0] : part[1]].max()
    depth, place, largest, x = samples.depth, 0.0, -np.inf, 0.0
    for i in range(part[0], part[1]):
        before, after = max(i - 1, part[0]), min(i + 1, part[1] - 1)
        # the penetration changes by at most the way along the profile
        if depth[i] >= max(depth[before], depth[after], highest - (s[after] - s[before])):
            guess = samples.x[i], samples.sample[i], depth[i] - SAMPLED
            own = _best(wheel, rail, radius, origin, rotation, s[before], s[after], guess)
            if own[1] > largest:
                place, largest, x = own
    return place, largest, x


@borrowing
def _best(
    wheel: Shape,
    rail: Shape,
    radius: float,
    origin: Array,
    rotation: Array,
    low: float,
    high: float,
    guess: tuple[float, int, float],
) -> tuple[float, float, float]:
    """Position, penetration and x m of the largest penetration between two positions m, from guesses of x and of the
    rail's nearest sample: where its slope vanishes, or, as at corners, by golden sections if that finds no more than
    the last guess, of the penetration.
    """
    x, sample, least = guess
    _, rise, _, _ = deepest(wheel, rail, radius, origin, rotation, low, x, sample)
    _, fall, _, _ = deepest(wheel, rail, radius, origin, rotation, high, x, sample)
    if rise > 0.0 > fall:
        found = stationary_point(wheel, rail, radius, origin, rotation, low, high, rise, fall, x, sample)
        if found[1] >= least:
            return found
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
