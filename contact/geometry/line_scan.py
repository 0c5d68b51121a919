"""Penetration on sampled lines of a wheel's profile, and which of them may touch the rail at a pose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.geometry.rigid_search import TURNS, Scan, next_turn
from wheelrail.meshes.curves.closest_point import SPACING, Shape, nearer_sample, nearest_sample
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array, Complex
from wheelrail.support.compiled import borrowing, unchecked

SCANNED = 1e-5  # m, last change of its x on sampled lines: the penetration before it is exact to 1e-10 m
FAR = 1e-3  # m: at larger distances, the same change suffices for the distance to 1e-6 m
INSIDE = 1e-3  # m under the rail's surface along the vertical: of a wheel inside it, beyond errors of the samples
NONE = -1.0  # m: penetration of lines that are left out


class Box(NamedTuple):
    """Bounds of some lines: lateral position nearest to the ordinary lines, smallest and largest z, m."""

    side: float
    low: float
    high: float


class Lines(NamedTuple):
    """Lines of the wheel's whole profile on which the penetration is sampled, complex numbers y + iz.

    Parameters:
        s: (n,) m, arc lengths on the wheel's profile.
        point, tangent: (n,) m and 1, there.
        rail_tangent: (m,), at the rail's samples.
        rail_curvature: (m,) 1/m, there, positive where it is convex.
        first, stop: of the ordinary lines, which are always looked at.
        flange, field: bounds of the lines before first, and from stop on.
        widest: m, largest distance of a line from y = 0.
        outline: (4, m) m, lateral positions of the rail's samples, increasing, heights, largest heights up to there
            and from there on.
    """

    s: Array
    point: Complex
    tangent: Complex
    rail_tangent: Complex
    rail_curvature: Array
    first: int
    stop: int
    flange: Box
    field: Box
    widest: float
    outline: Array

    @classmethod
    def of(cls, wheel: Profile, rail: Profile, ordinary: tuple[float, float], spacing: float) -> Lines:
        """Lines of two profiles.

        Parameters:
            wheel, rail: the profiles.
            ordinary: m, ends of the part of the wheel's profile that touches rails in ordinary running.
            spacing: m, at most, of the lines.
        """
        (start, stop), (low, high) = ordinary, wheel.s_range
        middle = np.linspace(start, stop, int(np.ceil((stop - start) / spacing)) + 1)
        parts = wheel.samples(spacing, low, start)[:-1], middle, wheel.samples(spacing, stop, high)[1:]
        s = np.concatenate([part[(part >= low) & (part <= high)] for part in parts])
        point, tangent = _complex(wheel.point(s)), _complex(wheel.tangent(s))
        first, end = int(np.searchsorted(s, start)), int(np.searchsorted(s, stop, side="right"))
        order, at = np.argsort(rail.shape.sampled.real, kind="stable"), rail.shape.samples
        heights = rail.shape.sampled.imag[order]
        before, after = np.maximum.accumulate(heights), np.maximum.accumulate(heights[::-1])[::-1]
        return cls(
            s,
            point,
            tangent,
            _complex(rail.tangent(at)),
            rail.curvature(at),
            first,
            end,
            _box(point[:first], 1.0),
            _box(point[end:], -1.0),
            float(np.abs(point.real).max()),
            np.array([rail.shape.sampled.real[order], heights, before, after]),
        )


def _complex(pairs: Array) -> Complex:
    return np.ascontiguousarray(pairs[:, 0] + 1j * pairs[:, 1])


def _box(points: Complex, hand: float) -> Box:
    """Bounds of points (n,) m whose side towards the ordinary lines is that of hand times y."""
    if not len(points):
        return Box(0.0, 0.0, 0.0)
    side = hand * float((hand * points.real).max())
    return Box(side, float(points.imag.min()), float(points.imag.max()))


@borrowing
def lines_to_scan(lines: Lines, radius: float, origin: Array, rotation: Array, margin: float = 0.0) -> tuple[int, int]:
    """First of the lines that may come closer to the rail at a pose than a margin m, 0 if they overlap it, and one past
    the last: the ordinary ones, and all before or after them unless bounds of their places show that they do not.

    Other parameters as for `scan`.
    """
    n = len(lines.s)
    first, stop = lines.first, lines.stop
    if first > 0 and _meets(lines, lines.flange, 1.0, radius, origin, rotation, margin):
        first = 0
    if stop < n and _meets(lines, lines.field, -1.0, radius, origin, rotation, margin):
        stop = n
    return first, stop


@borrowing
def _meets(lines: Lines, box: Box, hand: float, radius: float, origin: Array, rotation: Array, margin: float) -> bool:
    """Whether lines in a box, which the ordinary ones follow in the direction hand of y, may come closer to the rail
    than a margin m.

    A point of theirs at a distance r from the axle and an angle t from the lowest place lies at the height
    o_z + R_zy y + r (R_zx sin t - R_zz cos t), and laterally at o_y + R_yy y + r (R_yx sin t - R_yz cos t).
    """
    r, least = radius + box.high, radius + box.low
    reach = r * np.sqrt(rotation[2, 0] * rotation[2, 0] + rotation[2, 2] * rotation[2, 2])
    centre, top = origin[2] - margin - abs(rotation[2, 1]) * lines.widest, lines.outline[2, -1]
    if centre - reach >= top:
        return False
    # within the angles at which a point may be lower than the highest one of the rail
    cosine = min(max((centre - top) / reach, 0.0), 1.0)
    away = r * abs(rotation[1, 0]) * np.sqrt(1.0 - cosine * cosine)
    away += abs(rotation[1, 2]) * (r - least * cosine + r * abs(rotation[2, 0]))
    side = origin[1] + rotation[1, 1] * box.side - rotation[1, 2] * r + hand * (away + margin)
    low, high = 0, lines.outline.shape[1]  # number of the rail's samples before the side
    while low < high:
        middle = (low + high) // 2
        if lines.outline[0, middle] < side:
            low = middle + 1
        else:
            high = middle
    if hand > 0.0:
        return low > 0 and lines.outline[2, low - 1] > centre - reach
    return low < lines.outline.shape[1] and lines.outline[3, low] > centre - reach


@unchecked
def scan(rail: Shape, lines: Lines, radius: float, origin: Array, rotation: Array, part: tuple[int, int]) -> Scan:
    """Penetration at some lines, to about 1e-9 m, from the rail's samples and its curvature there; beside the rail
    minus the distance from its end.

    Parameters:
        rail: shape of the profile.
        lines: of the wheel.
        radius: nominal rolling radius, m.
        origin, rotation: (3,) m and (3, 3), pose of the wheel.
        part: the first of the lines, and one past the last; others are left out.
    """
    n = len(lines.s)
    result = Scan(np.full(n, NONE), np.zeros(n), np.zeros(n), np.full(n, -1))
    fill_scan(rail, lines, radius, origin, rotation, part, result)
    return result


@borrowing
def fill_scan(
    rail: Shape, lines: Lines, radius: float, origin: Array, rotation: Array, part: tuple[int, int], result: Scan
) -> None:
    """Fill some lines of a scan; other parameters as for `scan`."""
    depth, slope, where, nearest = result.depth, result.slope, result.x, result.sample
    last, sample, sine, cosine, advance = len(rail.samples) - 1, -1, 0.0, 1.0, 0
    for i in range(part[0], part[1]):
        z, t, before = lines.point[i], lines.tangent[i], sample
        r = z.imag + radius
        if sample >= 0:
            sample = min(max(sample + advance, 0), last)
        at, change = 0.0, 0.0
        for turn in range(TURNS):
            y = origin[1] + rotation[1, 0] * r * sine + rotation[1, 1] * z.real - rotation[1, 2] * r * cosine
            h = origin[2] + rotation[2, 0] * r * sine + rotation[2, 1] * z.real - rotation[2, 2] * r * cosine
            q = complex(y, h)
            sample = nearest_sample(rail, q) if sample < 0 else nearer_sample(rail, q, sample)
            offset, along, curvature = (
                q - rail.sampled[sample],
                lines.rail_tangent[sample],
                lines.rail_curvature[sample],
            )
            a = offset.real * along.real + offset.imag * along.imag
            d = offset.imag * along.real - offset.real * along.imag
            # to the closest point on the circle of curvature, in a hollow no further than the next sample
            a = min(max(a / (1.0 + curvature * d), -SPACING), SPACING)
            bend = a * curvature
            even = 1.0 - 0.5 * bend * bend
            ny, nz = along.real * bend - along.imag * even, along.real * even + along.imag * bend
            forward, upward = ny * rotation[1, 0] + nz * rotation[2, 0], ny * rotation[1, 2] + nz * rotation[2, 2]
            if upward == 0.0:
                break
            size = np.copysign(np.sqrt(forward * forward + upward * upward), upward)
            before_last, changed, at, sine, cosine = at, change, sine, -forward / size, upward / size
            change = sine - at
            if abs(change) * radius < (FAR if d > FAR else SCANNED):
                break
            sine, cosine = next_turn(turn, at, before_last, change, changed, sine, cosine)
        advance = sample - before if before >= 0 else 0
        if (sample == 0 and a < 0.0) or (sample == last and a > 0.0):
            depth[i], sample, sine, cosine = -abs(offset), -1, 0.0, 1.0
            continue
        ty = rotation[1, 0] * t.imag * sine + rotation[1, 1] * t.real - rotation[1, 2] * t.imag * cosine
        tz = rotation[2, 0] * t.imag * sine + rotation[2, 1] * t.real - rotation[2, 2] * t.imag * cosine
        depth[i], slope[i] = -(d + 0.5 * curvature * a * a * (1.0 + curvature * d)), -(ty * ny + tz * nz)
        where[i], nearest[i] = radius * np.arcsin(sine), sample


@borrowing
def inside(lines: Lines, samples: Scan, part: tuple[int, int], radius: float, origin: Array, rotation: Array) -> bool:
    """Whether a part of the wheel below its axle lies under the rail's surface; parameters as for `scan`, whose result
    the samples are: where they are above the rail, the wheel is.
    """
    across, heights = lines.outline[0], lines.outline[1]
    for i in range(part[0], part[1]):
        if samples.sample[i] >= 0 and samples.depth[i] <= 0.0:
            continue
        along, r = lines.point[i].real, lines.point[i].imag + radius
        y = origin[1] + rotation[1, 1] * along - rotation[1, 2] * r
        if not across[0] < y < across[-1]:
            continue
        k = np.searchsorted(across, y)
        share = (y - across[k - 1]) / (across[k] - across[k - 1])
        surface = heights[k - 1] + share * (heights[k] - heights[k - 1])
        if origin[2] + rotation[2, 1] * along - rotation[2, 2] * r < surface - INSIDE:
            return True
    return False
