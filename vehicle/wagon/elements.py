"""Force laws of springs and dampers, each in one direction: linear, by points, dampers in series with a spring."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.wagon.force_law import ForceLaw, Law


@dataclass(frozen=True)
class ElementPair:
    """A direction (0 lateral, 1 vertical) of the elements of both sides, left one first, or of one in the middle.

    Laws count lateral deflections outwards: positive to the left on the left side, to the right on the right side.
    """

    left: int
    right: int
    direction: int

    @cached_property
    def index(self) -> Any:
        return ..., slice(self.left, self.right + 1, max(self.right - self.left, 1)), self.direction

    @cached_property
    def signs(self) -> Array:
        return np.array([1.0] if self.left == self.right else [1.0, 1.0 if self.direction else -1.0])

    def outward(self, values: Array) -> Array:
        """Of values (..., n, 2) those at this place, (..., 1 or 2)."""
        return np.asarray(self.signs * values[self.index])

    def add(self, values: Array, more: Array) -> None:
        values[self.index] += self.signs * more


@dataclass(frozen=True)
class ForceElement:
    """What acts at a place: a spring and a damper side by side, the damper in series with a stiffness N/m."""

    place: ElementPair
    spring: Law = 0.0
    damper: Law = 0.0
    series: float = inf

    def slide(self, force: Array) -> Array:
        """Velocity of the damper m/s under a force N; raises ValueError for a law that does not rise everywhere."""
        return self.damper.inverse(force) if isinstance(self.damper, ForceLaw) else force / self.damper


@dataclass(frozen=True)
class ForceElements:
    """Force laws of n elements, deflections and velocities (..., n, 2) lateral and vertical, m and m/s.

    stiffness, damping (n, 2) of all that is linear; springs and dampers by points; series: dampers on a spring, whose
    deflections (..., m), outwards, m, are part of the state: those of the left side, then of the right side.
    """

    stiffness: Array
    damping: Array
    springs: tuple[tuple[ElementPair, ForceLaw], ...]
    dampers: tuple[tuple[ElementPair, ForceLaw], ...]
    series: tuple[ForceElement, ...]

    @classmethod
    def of(cls, elements: Iterable[ForceElement], n: int) -> ForceElements:
        elements = list(elements)
        rigid, series = (tuple(e for e in elements if (e.series == inf) == is_rigid) for is_rigid in (True, False))
        stiffness, springs = _sorted([(e.place, e.spring) for e in elements], n)
        damping, dampers = _sorted([(e.place, e.damper) for e in rigid], n)
        return cls(stiffness, damping, springs, dampers, series)

    @property
    def states(self) -> int:
        """m, deflections of springs in series with dampers."""
        return 2 * len(self.series)

    def force(self, deflection: Array, velocity: Array, series: Array) -> Array:
        """On the upper body (..., n, 2), N."""
        force = -self.stiffness * deflection - self.damping * velocity
        for values, laws in ((deflection, self.springs), (velocity, self.dampers)):
            for place, law in laws:
                place.add(force, -law(place.outward(values)))
        for element, stretch in self._in_series(series):
            element.place.add(force, -element.series * stretch)
        return force

    def series_rate(self, velocity: Array, series: Array) -> Array:
        """Rates (..., m) of the springs in series with dampers, m/s."""
        rate = np.empty(series.shape)
        for i, (element, stretch) in enumerate(self._in_series(series)):
            rate[..., i :: len(self.series)] = element.place.outward(velocity) - element.slide(element.series * stretch)
        return rate

    def energy(self, deflection: Array, series: Array) -> Array:
        """Stored in all springs (...), J."""
        energy = 0.5 * np.sum(self.stiffness * deflection**2, axis=(-2, -1))
        for place, law in self.springs:
            energy += law.energy(place.outward(deflection)).sum(axis=-1)
        for element, stretch in self._in_series(series):
            energy += 0.5 * element.series * np.sum(stretch**2, axis=-1)
        return np.asarray(energy)

    def dissipated(self, velocity: Array, series: Array) -> Array:
        """Power taken up by all dampers (...), W."""
        power = np.sum(self.damping * velocity**2, axis=(-2, -1))
        for place, law in self.dampers:
            at = place.outward(velocity)
            power += np.sum(law(at) * at, axis=-1)
        for element, stretch in self._in_series(series):
            force = element.series * stretch
            power += np.sum(force * element.slide(force), axis=-1)
        return np.asarray(power)

    def _in_series(self, series: Array) -> Iterable[tuple[ForceElement, Array]]:
        """Each with the deflections (..., 2) of its springs on the left and on the right."""
        return ((element, series[..., i :: len(self.series)]) for i, element in enumerate(self.series))


def _sorted(laws: list[tuple[ElementPair, Law]], n: int) -> tuple[Array, tuple[tuple[ElementPair, ForceLaw], ...]]:
    """The linear ones as a matrix (n, 2), the others by their places."""
    matrix, tables = np.zeros((n, 2)), []
    for place, law in laws:
        if isinstance(law, ForceLaw):
            tables.append((place, law))
        else:
            matrix[place.index] += law
    return matrix, tuple(tables)
