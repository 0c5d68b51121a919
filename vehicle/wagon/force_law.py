"""Nonlinear force laws of springs, dampers and bumpstops, piecewise linear."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class ForceLaw:
    """Force over deflection (spring) or velocity (damper), piecewise linear with linear extrapolation.

    Parameters:
        points: (n, 2), n >= 2: deflection m (velocity m/s), strictly increasing, and force N, not decreasing; one point
            is (0, 0). If that is the first, the law is odd.

    A number times a law is the law with the scaled force. Raises ValueError for other points.
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        table = np.array(self.points, dtype=float) if all(len(p) == 2 for p in self.points) else np.empty(0)
        if table.shape[:1] < (2,) or not np.isfinite(table).all():
            raise ValueError("two or more points, each a pair of finite numbers")
        if (np.diff(table[:, 0]) <= 0.0).any() or (np.diff(table[:, 1]) < 0.0).any():
            raise ValueError("points with strictly increasing first numbers and forces that do not decrease")
        if not (table == 0.0).all(axis=1).any():
            raise ValueError("points that include (0, 0)")

    @property
    def odd(self) -> bool:
        return self.points[0][0] == 0.0

    @property
    def increasing(self) -> bool:
        """Whether the force increases strictly, so that the law has an inverse."""
        return bool((self.slopes > 0.0).all())

    @cached_property
    def abscissae(self) -> Array:
        """(n,) deflections m or velocities m/s of the points."""
        return np.array([p[0] for p in self.points])

    @cached_property
    def forces(self) -> Array:
        return np.array([p[1] for p in self.points])

    @cached_property
    def slopes(self) -> Array:
        return np.asarray(np.diff(self.forces) / np.diff(self.abscissae))

    @cached_property
    def energies(self) -> Array:
        """(n,) integrals of the force from 0 to each point, J."""
        pieces = 0.5 * (self.forces[1:] + self.forces[:-1]) * np.diff(self.abscissae)
        sums = np.append(0.0, np.cumsum(pieces))
        return np.asarray(sums - sums[np.searchsorted(self.abscissae, 0.0)])

    def __call__(self, value: float | Array) -> Array:
        """Force N at deflections m or velocities m/s (...), with their sign."""
        i, point, offset = self._located(value)
        force = self.slopes[i] * offset + self.forces[point]
        return np.asarray(np.copysign(force, value) if self.odd else force)

    def energy(self, value: float | Array) -> Array:
        """Integral (...) of the force from 0, J, exact."""
        i, point, offset = self._located(value)
        return np.asarray(self.energies[point] + (self.forces[point] + 0.5 * self.slopes[i] * offset) * offset)

    @cached_property
    def mirrored(self) -> ForceLaw:
        """The law of the mirror image of an element: of deflections and forces with the opposite sign, bit for bit."""
        return self if self.odd else ForceLaw(tuple((0.0 - x, 0.0 - f) for x, f in reversed(self.points)))

    @cached_property
    def inverse(self) -> ForceLaw:
        """Deflection or velocity over force; raises ValueError for a law that does not increase strictly."""
        return ForceLaw(tuple((f, x) for x, f in self.points))

    def _located(self, value: float | Array) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
        """Index of the piece, of its end that is nearer to zero, and distance from there; of an odd law for the
        absolute value.
        """
        magnitude = np.abs(value) if self.odd else np.asarray(value)
        i = np.searchsorted(self.abscissae[1:-1], magnitude, side="right")
        point = i + (self.abscissae[i] < 0.0)
        return np.asarray(i), np.asarray(point), np.asarray(magnitude - self.abscissae[point])

    def __rmul__(self, factor: float) -> ForceLaw:
        return ForceLaw(tuple((x, factor * f) for x, f in self.points))


Law = float | ForceLaw  # a number is the slope of a linear law: stiffness N/m or damping N s/m
