"""Sections of the standard profiles, in metres, y to the field side and z up (wheel: above the rolling circle)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from wheelrail.meshes.curves.arc_length import CurveSegment, arc, bridged, graph, line
from wheelrail.support.arrays import Array

MM = 1e-3


def s1002() -> list[CurveSegment]:
    """S1002 for diameters of 760 to 1000 mm, flange 28 mm high, sections H to A and the 5 mm chamfer (EN 13715).

    The standard's rounded numbers have gaps of 1.2e-4 mm between D and C and 3.7e-5 mm between C and B; they are closed
    over 0.37 and 0.9 mm, which changes no published sample by more than 1e-5 mm.
    """
    d, c = bridged(_root(), _polynomial(_C, -35.0, -26.0), 0.24 * MM, 0.13 * MM)
    c, b = bridged(c, _polynomial(_B, -26.0, 32.15796), 0.5 * MM, 0.4 * MM)
    return [
        _circle(-49.5, 9.519259302, 20.5, -70.0, -62.764705882),
        _circle(-55.0, 16.0, 12.0, -62.764705882, -49.662510381),
        _circle(-58.558326413, 8.834924130, 20.0, -49.662510381, -39.764473993),
        _polynomial([-93.576667419, -2.747477419], -39.764473993, -38.426669071),
        d,
        c,
        b,
        _polynomial([1.364323640, -0.066666667], 32.15796, 60.0),
        _polynomial([57.36432364, -1.0], 60.0, 65.0),
    ]


_C = [
    -4.320221063e3,
    -1.038384026e3,
    -1.065501873e2,
    -6.051367875,
    -2.054332446e-1,
    -4.169739389e-3,
    -4.687195829e-5,
    -2.252755540e-7,
]
_B = [
    0.0,
    -3.358537058e-2,
    1.565681624e-3,
    -2.810427944e-5,
    5.844240864e-8,
    -1.562379023e-8,
    5.309217349e-15,
    -5.957839843e-12,
    2.646656573e-13,
]


def _polynomial(coefficients: list[float], start: float, stop: float) -> CurveSegment:
    """z(y) in mm with coefficients by rising power, as a section in m."""
    middle = 0.5 * (start + stop)
    # about the middle, since the powers of y itself cancel and lose four digits
    height = Polynomial(coefficients)(Polynomial([middle, 1.0]))
    slope = height.deriv()

    def z(y: Array) -> Array:
        return np.asarray(MM * height(y / MM - middle))

    def dz(y: Array) -> Array:
        return np.asarray(slope(y / MM - middle))

    return graph(z, dz, start * MM, stop * MM)


def _circle(y: float, z: float, radius: float, start: float, stop: float) -> CurveSegment:
    """Upper arc about (y, z) between two lateral positions, mm."""
    angles = [math.acos((end - y) / radius) for end in (start, stop)]
    return arc((y + 1j * z) * MM, radius * MM, *angles)


def _root() -> CurveSegment:
    """Section D, the lower arc of 13 mm in the flange root, as a graph for a bridge to a polynomial."""
    centre, radius = -26.210665 * MM, 13.0 * MM

    def z(y: Array) -> Array:
        return np.asarray(16.446 * MM - np.sqrt(radius**2 - (y - centre) ** 2))

    def dz(y: Array) -> Array:
        return np.asarray((y - centre) / np.sqrt(radius**2 - (y - centre) ** 2))

    return graph(z, dz, -38.426669071 * MM, -35.0 * MM)


@dataclass(frozen=True)
class RailHead:
    """Head of the UIC60 family: arcs of 300, 80 and 13 mm, each tangent to the next, and flanks inclined 1:20.

    Parameters, in the rail's axis frame with its origin at the crown:
        join: half width at which the arcs of 300 and 80 mm meet, m.
        foot: depth of the flank's lower end, m.
        half_width: at which the arc of 13 mm meets the flank, m.
        drop: downward translation of the arc of 13 mm from tangency, m.
    """

    join: float
    foot: float
    half_width: float = 36.0 * MM
    drop: float = 0.0

    def sections(self) -> list[CurveSegment]:
        """Sections from the lower end of the gauge side's flank to that of the field side."""
        large, middle, small = 300.0 * MM, 80.0 * MM, 13.0 * MM
        level = math.atan(1 / 20)  # polar angle at which the flank is tangent
        first = math.acos(self.join / large)
        top = -1j * large
        shoulder = top + (large - middle) * complex(math.cos(first), math.sin(first))
        y = self.half_width - small * math.cos(level)
        lateral = y - shoulder.real
        corner = complex(y, shoulder.imag + math.sqrt((middle - small) ** 2 - lateral**2))
        second = math.acos(lateral / (middle - small))
        corner -= 1j * self.drop
        flank = corner + small * complex(math.cos(level), math.sin(level))
        depth = self.foot + flank.imag
        half = [
            arc(shoulder, middle, first, second),
            arc(corner, small, second, level),
            line(flank, flank + depth * complex(1 / 20, -1)),
        ]
        if self.drop:
            half[0], half[1] = bridged(half[0], half[1], 0.35 * MM, 0.15 * MM)
        gauge = [mirrored(section) for section in reversed(half)]
        return [*gauge, arc(top, large, math.pi - first, first), *half]


def mirrored(section: CurveSegment) -> CurveSegment:
    """The section mirrored at y = 0, in the opposite direction."""
    total = section.knots[0] + section.knots[-1]
    return CurveSegment(
        lambda t: -section.position(total - t).conj(),
        lambda t: section.velocity(total - t).conj(),
        total - section.knots[::-1],
    )


# EN 13674-1: 20.456 mm between the ends of the arc of 300 mm; the flank ends at the lower corner of the head.
EN_60E1 = RailHead(join=10.228 * MM, foot=35.27527 * MM)
# The Manchester contact benchmark's UIC60: 21 mm instead. In its file the arc of 13 mm is 4.5e-5 mm lower than for
# tangency with that of 80 mm, as from a joint rounded to (25.988, 2.2532); the gap is closed over 0.5 mm.
BENCHMARK_UIC60 = RailHead(join=10.5 * MM, foot=37.5 * MM, drop=4.5e-5 * MM)
# Placement in that file: inclined by atan(1/40), origin 5.96e-3 mm to the gauge side of the highest point.
BENCHMARK_INCLINATION = math.atan(1 / 40)
BENCHMARK_SHIFT = complex(-7.4917 * MM, 300.0 * MM * (math.cos(BENCHMARK_INCLINATION) - 1.0))
