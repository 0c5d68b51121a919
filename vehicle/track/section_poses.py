"""Position, orientation and rotation per length of track sections at several distances, in common axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.bindings._vehicle import Track
from wheelrail.support.arrays import Array
from wheelrail.vehicle.track import track
from wheelrail.vehicle.track.piecewise import PiecewiseFunction

DEGREE = 7  # of the local polynomials; those of a `PiecewiseFunction` have degree 5
GAUSS = np.polynomial.legendre.leggauss(10)  # type: ignore[no-untyped-call]


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

    track: track.Track

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
    def core(self) -> Track:
        """The same in the compiled core."""
        line = self.alignment
        return Track(
            line.starts.tolist(), line.coefficients.tolist(), self.track.base, *(part.tolist() for part in GAUSS)
        )

    def at(self, stations: Array, reference: float) -> SectionPoses:
        """Sections at distances (...) m, in the axes at the distance of the reference, m.

        Orientation Rz(heading) Ry(-gradient) Rx(roll), as in `Track.frame`. Positions by Gauss quadrature of the
        tangent, within smooth pieces.
        """
        rows = self.core.sections(np.ravel(stations), reference).reshape(*np.shape(stations), 6, 3)
        position, *axes, rate, rate_slope = np.moveaxis(rows, -2, 0)
        return SectionPoses(position, np.stack(axes, axis=-1), rate, rate_slope)
