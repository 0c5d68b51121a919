"""Position, orientation and rotation per length of track sections at several distances, in common axes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track

DEGREE = 7  # of the local polynomials; those of a `PiecewiseFunction` have degree 5
REACH = 200.0  # m from the reference, within which boundaries of pieces are boundaries of the quadrature
GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(10)  # type: ignore[no-untyped-call]


class SectionPoses(NamedTuple):
    """Track sections at n distances.

    Parameters:
        position: (..., 3) m of the centre line from the reference, x along its heading there, y to the left, z up.
        axes: (..., 3, 3) tangent, lateral axis to the left and normal of the rail plane as columns, in the same axes.
        rate: (..., 3) rotation of the axes per length, rad/m, in the section's own axes.
        rate_slope: (..., 3) derivative of `rate` by the distance, rad/m2.
    """

    position: Array
    axes: Array
    rate: Array
    rate_slope: Array


@dataclass(frozen=True)
class LocalPolynomials:
    """A piecewise polynomial of distance with vectorised values.

    Parameters:
        starts: (m,) m, start of each piece; the first and the last piece are unbounded.
        coefficients: (m, degree + 1), ascending powers of the distance from the start.
    """

    starts: Array
    coefficients: Array

    @classmethod
    def through(cls, breaks: tuple[float, ...], values: Array, outside: tuple[float, float]) -> LocalPolynomials:
        """Interpolants between breaks (m,) m through values (m - 1, 8) at `sample_points`, and constants outside."""
        coefficients = np.zeros((len(breaks) + 1, DEGREE + 1))
        coefficients[0, 0], coefficients[-1, 0] = outside
        if len(breaks) > 1:
            lengths = np.diff(breaks)[:, None]
            unit = np.linalg.solve(np.vander(_UNIT_POINTS, increasing=True), values.T).T
            coefficients[1:-1] = unit / lengths ** np.arange(DEGREE + 1)
        return cls(np.array([breaks[0], *breaks]), coefficients)

    def __call__(self, s: Array, derivative: int = 0) -> Array:
        """Values or derivatives at distances (...) m."""
        piece = np.searchsorted(self.starts[1:], s, side="right")
        x, coefficients = s - self.starts[piece], self.coefficients
        for _ in range(derivative):
            coefficients = coefficients[:, 1:] * np.arange(1, coefficients.shape[1])
        result: Array = np.zeros_like(x)
        for power in range(coefficients.shape[1] - 1, -1, -1):
            result = result * x + coefficients[piece, power]
        return result

    @cached_property
    def integral(self) -> LocalPolynomials:
        """Integral from the first break."""
        powers = np.arange(1, self.coefficients.shape[1] + 1)
        coefficients = np.hstack([np.zeros((len(self.coefficients), 1)), self.coefficients / powers])
        lengths = np.append(0.0, np.diff(self.starts[1:]))
        rises = (coefficients[:-1] * lengths[:, None] ** np.arange(coefficients.shape[1])).sum(axis=1)
        coefficients[1:, 0] = np.cumsum(rises)
        return LocalPolynomials(self.starts, coefficients)


_UNIT_POINTS = 0.5 - 0.5 * np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))


def sample_points(breaks: tuple[float, ...]) -> Array:
    """Chebyshev points (m - 1, 8) m between breaks (m,) m."""
    left = np.array(breaks[:-1])[:, None]
    return np.asarray(left + np.diff(breaks)[:, None] * _UNIT_POINTS)


@dataclass(frozen=True)
class TrackSections:
    """Sections of a track at several distances, for bodies that each have their own.

    Parameters:
        track: alignment; irregularities are not part of it.
    """

    track: Track

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Boundaries between smooth pieces of curvature and gradient, m."""
        return tuple(sorted({*self.track.curvature.breaks, *self.track.gradient.breaks}))

    @cached_property
    def curvature(self) -> LocalPolynomials:
        return _polynomials(self.track.curvature)

    @cached_property
    def superelevation(self) -> LocalPolynomials:
        return _polynomials(self.track.superelevation)

    @cached_property
    def gradient(self) -> LocalPolynomials:
        return _polynomials(self.track.gradient)

    @cached_property
    def heading(self) -> LocalPolynomials:
        """Angle of the tangent in plan, rad, from the first break: integral of curvature times cos(gradient)."""
        points = sample_points(self.breaks)
        turn = self.curvature(points) * np.cos(self.gradient(points))
        ends = np.array([self.breaks[0] - 1.0, self.breaks[-1] + 1.0])
        first, last = (self.curvature(ends) * np.cos(self.gradient(ends))).tolist()
        return LocalPolynomials.through(self.breaks, turn, (first, last)).integral

    def at(self, stations: Array, reference: float) -> SectionPoses:
        """Sections at distances (...) m, in the axes at the distance of the reference, m.

        Orientation Rz(heading) Ry(-gradient) Rx(roll), as in `Track.frame`. Positions by Gauss quadrature of the
        tangent, within smooth pieces.
        """
        heading = self.heading(stations) - self.heading(np.array([reference]))
        a, da, dda = (self.gradient(stations, order) for order in range(3))
        h, dh, ddh = (self.superelevation(stations, order) / -self.track.base for order in range(3))
        root = np.sqrt(1.0 - h * h)
        p, dp, ddp = np.arcsin(h), dh / root, ddh / root + h * dh * dh / root**3
        curvature, dcurvature = self.curvature(stations), self.curvature(stations, 1)
        ca, sa, cp, sp, ch, sh = (f(x) for x in (a, p, heading) for f in (np.cos, np.sin))
        turn, dturn = curvature * ca, dcurvature * ca - curvature * da * sa
        across, dacross = turn * ca, dturn * ca - turn * da * sa
        rate = _vectors(dp + turn * sa, across * sp - da * cp, across * cp + da * sp)
        rate_slope = _vectors(
            ddp + dturn * sa + turn * da * ca,
            dacross * sp + across * dp * cp - dda * cp + da * dp * sp,
            dacross * cp - across * dp * sp + dda * sp + da * dp * cp,
        )
        tangent, left = _vectors(ch * ca, sh * ca, sa), _vectors(-sh, ch, 0.0 * sh)
        upright = np.cross(tangent, left)
        lateral = cp[..., None] * left + sp[..., None] * upright
        normal = cp[..., None] * upright - sp[..., None] * left
        axes = np.stack([tangent, lateral, normal], axis=-1)
        return SectionPoses(self._positions(stations, reference), axes, rate, rate_slope)

    def _positions(self, stations: Array, reference: float) -> Array:
        """Positions (..., 3) m of the centre line relative to the reference."""
        inside = [b for b in self.breaks if abs(b - reference) < REACH]
        knots = np.array(sorted({reference, *inside}))
        steps = self._advance(knots[:-1], knots[1:], reference)
        at_knots = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
        at_knots -= at_knots[np.searchsorted(knots, reference)]
        nearest = np.maximum(np.searchsorted(knots, stations, side="right") - 1, 0)
        return np.asarray(at_knots[nearest] + self._advance(knots[nearest], stations, reference))

    def _advance(self, start: Array, end: Array, reference: float) -> Array:
        """Displacement (..., 3) m along the centre line from start to end (...) m."""
        half = 0.5 * (end - start)[..., None]
        points = 0.5 * (start + end)[..., None] + half * GAUSS_NODES
        heading, a = self.heading(points) - self.heading(np.array([reference])), self.gradient(points)
        tangent = _vectors(np.cos(heading) * np.cos(a), np.sin(heading) * np.cos(a), np.sin(a))
        return np.asarray(((half * GAUSS_WEIGHTS)[..., None] * tangent).sum(axis=-2))


def _vectors(x: Array, y: Array, z: Array) -> Array:
    return np.stack([x, y, z], axis=-1)


def _polynomials(function: PiecewiseFunction) -> LocalPolynomials:
    """Vectorised form of a function, exact but for round-off."""
    breaks = function.breaks
    values = np.array([[function(s)[0] for s in row] for row in sample_points(breaks).tolist()])
    return LocalPolynomials.through(breaks, values, (function.values[0], function.values[-1]))
