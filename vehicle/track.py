"""A track by its curvature, slope and cant along the distance s."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from math import asin, copysign, cos, sin, sqrt

import numpy as np

from vehicle.course import Course, Shape
from vehicle.frame import Frame


def _zero() -> Course:
    return Course.constant(0.0)


@dataclass(frozen=True)
class Track:
    """The centre line as courses of s.

    curvature 1/m in plan, positive to the left; lift m: by how much the right rail lies above the left one (the cant of
    a left-hand curve); gradient rad, positive uphill; base m, distance over which the lift is measured. The plane of
    the rails turns about the centre line. Raises ValueError where the lift does not fit the base.
    """

    curvature: Course = field(default_factory=_zero)
    lift: Course = field(default_factory=_zero)
    gradient: Course = field(default_factory=_zero)
    base: float = 1.5

    def __post_init__(self) -> None:
        if not self.base > max(abs(h) for h in self.lift.values):
            raise ValueError(f"cant {self.lift.values} m does not fit a base of {self.base} m")

    @classmethod
    def curve(
        cls,
        *,
        curvature: float,
        cant: float = 0.0,
        tangent: float = 0.0,
        transition: float,
        length: float,
        exit_transition: float | None = None,
        gradient: float = 0.0,
        base: float = 1.5,
        shape: Shape = "quintic",
        corner: float = 3.0,
    ) -> Track:
        """Tangent, transition, full curve and, when exit_transition is given, back to a tangent without end.

        curvature 1/m, positive to the left; cant m, positive raises the outer rail; gradient rad; lengths m.
        Raises ValueError for lengths that are not positive.
        """
        if (
            tangent < 0.0
            or not (transition > 0.0 and length > 0.0)
            or not (exit_transition is None or exit_transition > 0)
        ):
            raise ValueError("a curve needs a tangent >= 0 and positive lengths of transition, curve and exit")
        stations = [tangent, tangent + transition]
        share = [0.0, 1.0]
        if exit_transition is not None:
            stations += [stations[-1] + length, stations[-1] + length + exit_transition]
            share += [1.0, 0.0]
        lift = cant * copysign(1.0, curvature)

        def course(value: float) -> Course:
            return Course(tuple(stations), tuple(value * x for x in share), shape=shape, corner=corner)

        return cls(course(curvature), course(lift), Course.constant(gradient), base)

    def angle(self, s: float) -> tuple[float, float, float]:
        """Roll of the rail plane about the tangent, positive raises the left rail, and two derivatives by s."""
        h, dh, ddh = (-value / self.base for value in self.lift(s))
        root = sqrt(1.0 - h * h)
        return asin(h), dh / root, ddh / root + h * dh * dh / root**3

    def frame(self, s: float, speed: float, acceleration: float = 0.0) -> Frame:
        """Track frame at s for a vehicle at speed m/s with acceleration m/s2.

        Orientation Rz(heading) Ry(-gradient) Rx(angle); rotation k and k' per length turn into w = V k and
        dw/dt = V' k + V^2 k'.
        """
        p, dp, ddp = self.angle(s)
        a, da, dda = self.gradient(s)
        curvature, dcurvature, _ = self.curvature(s)
        ca, sa, cp, sp = cos(a), sin(a), cos(p), sin(p)
        turn = curvature * ca  # heading per arc length
        dturn = dcurvature * ca - curvature * da * sa
        across, dacross = turn * ca, dturn * ca - turn * da * sa  # its part normal to the tangent
        k = (dp + turn * sa, across * sp - da * cp, across * cp + da * sp)
        dk = (
            ddp + dturn * sa + turn * da * ca,
            dacross * sp + across * dp * cp - dda * cp + da * dp * sp,
            dacross * cp - across * dp * sp + dda * sp + da * dp * cp,
        )
        v2 = speed * speed
        return Frame(
            speed,
            acceleration,
            rate=(speed * k[0], speed * k[1], speed * k[2]),
            rate_dot=(
                acceleration * k[0] + v2 * dk[0],
                acceleration * k[1] + v2 * dk[1],
                acceleration * k[2] + v2 * dk[2],
            ),
            down=(-sa, -ca * sp, -ca * cp),
        )

    def heading(self, s: float) -> float:
        """Angle of the tangent in plan against that at s = 0, rad, by Gauss quadrature piece by piece."""
        low, high = min(0.0, s), max(0.0, s)
        breaks = sorted({low, high, *(x for c in (self.curvature, self.gradient) for x in c.breaks if low < x < high)})
        nodes, weights = np.polynomial.legendre.leggauss(8)  # type: ignore[no-untyped-call]
        total = 0.0
        for a, b in pairwise(breaks):
            points = (0.5 * (a + b) + 0.5 * (b - a) * nodes).tolist()
            turns = [self.curvature(x)[0] * cos(self.gradient(x)[0]) for x in points]
            total += 0.5 * (b - a) * float(weights @ np.array(turns))
        return total if s >= 0.0 else -total
