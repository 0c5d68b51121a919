"""Force elements in one direction: linear and nonlinear springs and dampers, Maxwell elements."""

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
    """One direction of the elements of both sides.

    Parameters:
        left, right: element indices, equal for one in the middle.
        direction: 0 lateral, 1 vertical.

    In force laws, lateral deflections are positive outwards: to the left on the left side, to the right on the right.
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
        """Values (..., 1 or 2) of these elements from all (..., n, 2), positive outwards."""
        return np.asarray(self.signs * values[self.index])

    def add(self, values: Array, outward: Array) -> None:
        """Adds outward values (..., 1 or 2) of these elements to all (..., n, 2)."""
        values[self.index] += self.signs * outward


@dataclass(frozen=True)
class ForceElement:
    """Spring and damper in parallel.

    Parameters:
        pair: elements and direction.
        spring: stiffness N/m, or a force law.
        damper: damping N s/m, or a force law.
        series: N/m, stiffness in series with the damper (Maxwell element); inf: rigid.
    """

    pair: ElementPair
    spring: Law = 0.0
    damper: Law = 0.0
    series: float = inf

    def damper_velocity(self, force: Array) -> Array:
        """Velocity of the damper m/s under a force N; raises ValueError for a law that does not increase strictly."""
        return self.damper.inverse(force) if isinstance(self.damper, ForceLaw) else force / self.damper


@dataclass(frozen=True)
class ForceElements:
    """Force laws of n elements; deflections and velocities (..., n, 2) lateral and vertical, m and m/s.

    Parameters:
        stiffness, damping: (n, 2) N/m and N s/m, of the linear elements.
        springs, dampers: nonlinear force laws.
        series: Maxwell elements; their spring deflections (..., m), m, outwards, are part of the state: left side, then
            right side.
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
        stiffness, springs = _linear_and_nonlinear([(e.pair, e.spring) for e in elements], n)
        damping, dampers = _linear_and_nonlinear([(e.pair, e.damper) for e in rigid], n)
        return cls(stiffness, damping, springs, dampers, series)

    @property
    def states(self) -> int:
        """Number m of spring deflections of Maxwell elements."""
        return 2 * len(self.series)

    def force(self, deflection: Array, velocity: Array, series: Array) -> Array:
        """Forces (..., n, 2) N on the upper body.

        Parameters:
            deflection, velocity: (..., n, 2) m and m/s.
            series: (..., m) m, spring deflections of Maxwell elements.
        """
        force = -self.stiffness * deflection - self.damping * velocity
        for values, laws in ((deflection, self.springs), (velocity, self.dampers)):
            for pair, law in laws:
                pair.add(force, -law(pair.outward(values)))
        for element, deflections in self._in_series(series):
            element.pair.add(force, -element.series * deflections)
        return force

    def series_rate(self, velocity: Array, series: Array) -> Array:
        """Rates (..., m) m/s of the spring deflections of Maxwell elements."""
        rate = np.empty(series.shape)
        for i, (element, deflections) in enumerate(self._in_series(series)):
            rate[..., i :: len(self.series)] = element.pair.outward(velocity) - element.damper_velocity(
                element.series * deflections
            )
        return rate

    def energy(self, deflection: Array, series: Array) -> Array:
        """Energy (...) J stored in all springs."""
        energy = 0.5 * np.sum(self.stiffness * deflection**2, axis=(-2, -1))
        for pair, law in self.springs:
            energy += law.energy(pair.outward(deflection)).sum(axis=-1)
        for element, deflections in self._in_series(series):
            energy += 0.5 * element.series * np.sum(deflections**2, axis=-1)
        return np.asarray(energy)

    def dissipated(self, velocity: Array, series: Array) -> Array:
        """Power (...) W dissipated in all dampers."""
        power = np.sum(self.damping * velocity**2, axis=(-2, -1))
        for pair, law in self.dampers:
            outward = pair.outward(velocity)
            power += np.sum(law(outward) * outward, axis=-1)
        for element, deflections in self._in_series(series):
            force = element.series * deflections
            power += np.sum(force * element.damper_velocity(force), axis=-1)
        return np.asarray(power)

    def _in_series(self, series: Array) -> Iterable[tuple[ForceElement, Array]]:
        """Maxwell elements with the deflections (..., 2) of their left and right springs."""
        return ((element, series[..., i :: len(self.series)]) for i, element in enumerate(self.series))


def _linear_and_nonlinear(
    laws: list[tuple[ElementPair, Law]], n: int
) -> tuple[Array, tuple[tuple[ElementPair, ForceLaw], ...]]:
    """Linear laws as a matrix (n, 2), and nonlinear ones with their elements."""
    matrix, tables = np.zeros((n, 2)), []
    for pair, law in laws:
        if isinstance(law, ForceLaw):
            tables.append((pair, law))
        else:
            matrix[pair.index] += law
    return matrix, tuple(tables)
