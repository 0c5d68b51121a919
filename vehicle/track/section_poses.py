"""Position, orientation and rotation per length of track sections at several distances, in common axes."""

from __future__ import annotations

from collections.abc import Sequence
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
    """Piecewise polynomials of distance on the same pieces, with vectorised values.

    Parameters:
        starts: (m,) m, start of each piece; the first and the last piece are unbounded.
        coefficients: (m, degree + 1, k) of k polynomials, ascending powers of the distance from the start.
    """

    starts: Array
    coefficients: Array

    @classmethod
    def through(cls, breaks: tuple[float, ...], values: Array, outside: Array) -> LocalPolynomials:
        """Interpolants between breaks (m,) m of values (m - 1, 8, k) at `sample_points`, constants (2, k) outside."""
        coefficients = np.zeros((len(breaks) + 1, DEGREE + 1, values.shape[-1]))
        coefficients[[0, -1], 0] = outside
        if len(breaks) > 1:
            unit = np.linalg.solve(np.vander(_UNIT_POINTS, increasing=True), values)
            coefficients[1:-1] = unit / np.diff(breaks)[:, None, None] ** np.arange(DEGREE + 1)[:, None]
        return cls(np.array([breaks[0], *breaks]), coefficients)

    def __call__(self, s: Array) -> Array:
        """Values (..., k) at distances (...) m."""
        piece = np.searchsorted(self.starts[1:], s, side="right")
        x, coefficients = (s - self.starts[piece])[..., None], self.coefficients[piece]
        result = coefficients[..., -1, :]
        for power in range(coefficients.shape[-2] - 2, -1, -1):
            result = result * x + coefficients[..., power, :]
        return np.asarray(result)

    @cached_property
    def derivative(self) -> LocalPolynomials:
        return LocalPolynomials(self.starts, self.coefficients[:, 1:] * np.arange(1, self._count)[:, None])

    @cached_property
    def integral(self) -> LocalPolynomials:
        """Integral from the first break."""
        powers = np.arange(1, self._count + 1)[:, None]
        coefficients = np.concatenate([np.zeros_like(self.coefficients[:, :1]), self.coefficients / powers], axis=1)
        lengths = np.append(0.0, np.diff(self.starts[1:]))
        rises = (coefficients[:-1] * lengths[:, None, None] ** np.arange(self._count + 1)[:, None]).sum(axis=1)
        coefficients[1:, 0] = np.cumsum(rises, axis=0)
        return LocalPolynomials(self.starts, coefficients)

    @property
    def _count(self) -> int:
        """Number of coefficients of a polynomial."""
        return int(self.coefficients.shape[1])

    @classmethod
    def joined(cls, parts: Sequence[LocalPolynomials]) -> LocalPolynomials:
        """All polynomials of several parts on the same pieces."""
        count = max(part._count for part in parts)
        padded = [np.pad(part.coefficients, ((0, 0), (0, count - part._count), (0, 0))) for part in parts]
        return cls(parts[0].starts, np.concatenate(padded, axis=2))


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
        """Boundaries between smooth pieces of curvature, superelevation and gradient, m."""
        return tuple(sorted({b for function in self._functions for b in function.breaks}))

    @property
    def _functions(self) -> tuple[PiecewiseFunction, ...]:
        return self.track.curvature, self.track.superelevation, self.track.gradient

    @cached_property
    def alignment(self) -> LocalPolynomials:
        """Heading; curvature, superelevation and gradient; their first, then their second derivatives.

        The heading is the angle of the tangent in plan, rad, from the first break: integral of curvature times
        cos(gradient).
        """
        points = sample_points(self.breaks)
        values = np.array([[[f(s)[0] for f in self._functions] for s in row] for row in points.tolist()])
        outside = np.array([[f.values[end] for f in self._functions] for end in (0, -1)])
        functions = LocalPolynomials.through(self.breaks, values.reshape(*points.shape, 3), outside)
        sampled = functions(points)
        turn, turn_outside = (v[..., :1] * np.cos(v[..., 2:]) for v in (sampled, outside))
        heading = LocalPolynomials.through(self.breaks, turn, turn_outside).integral
        return LocalPolynomials.joined([heading, functions, functions.derivative, functions.derivative.derivative])

    @cached_property
    def direction(self) -> LocalPolynomials:
        """Heading and gradient, rad."""
        return LocalPolynomials(self.alignment.starts, self.alignment.coefficients[:, :, [0, 3]])

    def at(self, stations: Array, reference: float) -> SectionPoses:
        """Sections at distances (...) m, in the axes at the distance of the reference, m.

        Orientation Rz(heading) Ry(-gradient) Rx(roll), as in `Track.frame`. Positions by Gauss quadrature of the
        tangent, within smooth pieces.
        """
        heading, curvature, h, a, dcurvature, dh, da, _, ddh, dda = np.moveaxis(self.alignment(stations), -1, 0)
        at_reference = float(self.direction(np.array(reference))[0])
        heading = heading - at_reference
        h, dh, ddh = (value / -self.track.base for value in (h, dh, ddh))
        root = np.sqrt(1.0 - h * h)
        p, dp, ddp = np.arcsin(h), dh / root, ddh / root + h * dh * dh / root**3
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
        upright = _vectors(-ch * sa, -sh * sa, ca)
        lateral = cp[..., None] * left + sp[..., None] * upright
        normal = cp[..., None] * upright - sp[..., None] * left
        axes = np.stack([tangent, lateral, normal], axis=-1)
        return SectionPoses(self._positions(stations, reference, at_reference), axes, rate, rate_slope)

    def _positions(self, stations: Array, reference: float, heading: float) -> Array:
        """Positions (..., 3) m of the centre line relative to the reference, of a given heading, rad."""
        inside = [b for b in self.breaks if abs(b - reference) < REACH]
        knots = np.array(sorted({reference, *inside}))
        steps = self._advance(knots[:-1], knots[1:], heading)
        at_knots = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
        at_knots -= at_knots[np.searchsorted(knots, reference)]
        nearest = np.maximum(np.searchsorted(knots, stations, side="right") - 1, 0)
        return np.asarray(at_knots[nearest] + self._advance(knots[nearest], stations, heading))

    def _advance(self, start: Array, end: Array, heading: float) -> Array:
        """Displacement (..., 3) m along the centre line from start to end (...) m, x along a heading, rad."""
        half = 0.5 * (end - start)[..., None]
        direction = self.direction(0.5 * (start + end)[..., None] + half * GAUSS_NODES)
        turned, a = direction[..., 0] - heading, direction[..., 1]
        tangent = _vectors(np.cos(turned) * np.cos(a), np.sin(turned) * np.cos(a), np.sin(a))
        return np.asarray(((half * GAUSS_WEIGHTS)[..., None] * tangent).sum(axis=-2))


def _vectors(x: Array, y: Array, z: Array) -> Array:
    return np.stack([x, y, z], axis=-1)
