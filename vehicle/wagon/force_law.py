"""Force laws given by points: springs, dampers and stops that are not linear."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class ForceLaw:
    """Force over deflection (a spring) or velocity (a damper), linear between points; the last slopes go on.

    points: pairs of deflection m (velocity m/s), which rises strictly, and force N, which never falls; (0, 0) is one of
    them. A law whose points begin there is odd: the same in both directions. Times a number it is the law with that
    many times the force. Raises ValueError for other points.
    """

    points: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        table = np.array(self.points, dtype=float) if all(len(p) == 2 for p in self.points) else np.empty(0)
        if table.shape[:1] < (2,) or not np.isfinite(table).all():
            raise ValueError("two points or more, each a pair of finite numbers")
        if (np.diff(table[:, 0]) <= 0.0).any() or (np.diff(table[:, 1]) < 0.0).any():
            raise ValueError("points whose first numbers rise strictly and whose forces do not fall")
        if not (table == 0.0).all(axis=1).any():
            raise ValueError("points one of which is (0, 0)")

    @property
    def odd(self) -> bool:
        return self.points[0][0] == 0.0

    @property
    def rises(self) -> bool:
        """Whether the force rises everywhere, so that it has an inverse."""
        return bool((self.slopes > 0.0).all())

    @cached_property
    def places(self) -> Array:
        return np.array([p[0] for p in self.points])

    @cached_property
    def forces(self) -> Array:
        return np.array([p[1] for p in self.points])

    @cached_property
    def slopes(self) -> Array:
        return np.asarray(np.diff(self.forces) / np.diff(self.places))

    @cached_property
    def energies(self) -> Array:
        """Integral of the force from 0 to each place, J."""
        pieces = 0.5 * (self.forces[1:] + self.forces[:-1]) * np.diff(self.places)
        sums = np.append(0.0, np.cumsum(pieces))
        return np.asarray(sums - sums[np.searchsorted(self.places, 0.0)])

    def __call__(self, value: float | Array) -> Array:
        """Force N at a deflection m or velocity m/s of any shape, with its sign."""
        i, beyond = self._located(value)
        force = self.slopes[i] * beyond + self.forces[i]
        return np.asarray(np.copysign(force, value) if self.odd else force)

    def energy(self, value: float | Array) -> Array:
        """Integral of the force from 0, J, exact."""
        i, beyond = self._located(value)
        return np.asarray(self.energies[i] + (self.forces[i] + 0.5 * self.slopes[i] * beyond) * beyond)

    @cached_property
    def inverse(self) -> ForceLaw:
        """Deflection or velocity over force; raises ValueError for a law that does not rise everywhere."""
        return ForceLaw(tuple((f, x) for x, f in self.points))

    def _located(self, value: float | Array) -> tuple[NDArray[np.int64], Array]:
        """The piece, and how far beyond its beginning; of an odd law for the size of the value."""
        size = np.abs(value) if self.odd else np.asarray(value)
        i = np.searchsorted(self.places[1:-1], size, side="right")
        return np.asarray(i), np.asarray(size - self.places[i])

    def __rmul__(self, factor: float) -> ForceLaw:
        return ForceLaw(tuple((x, factor * f) for x, f in self.points))


Law = float | ForceLaw  # a number is the slope of a linear law: stiffness N/m or damping N s/m
