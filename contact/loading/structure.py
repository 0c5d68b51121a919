"""Axle and track as a linear system whose motions are states of a time integration.

With the motions x, at rest without load x_0, and the loads w of the contacts on hubs and rails

    x' = A (x - x_0) + B w.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.flexible_contact import FlexiblePairs
from wheelrail.contact.loading.flexible_state import MOTIONS, OF_SIDES, FlexibleState, sums_and_differences
from wheelrail.support.arrays import Array

TIME_CONSTANT = 1e-3  # s


@dataclass(frozen=True)
class Structure(ABC):
    """Axle and track that move with the loads of the contacts.

    Parameters:
        pairs: of both sides.
        time_constant: s, damping over stiffness of massless parts.

    The k motions are even and odd parts of those of both sides as left-hand ones (see `sums_and_differences`), the
    loads are those on even and odd parts. The first 18 are of `FlexibleState.motions`; further motions and rates of
    motions follow.
    """

    pairs: FlexiblePairs
    time_constant: float = TIME_CONSTANT

    @property
    @abstractmethod
    def sizes(self) -> tuple[int, ...]:
        """Numbers of motions of one side in their order, of which k is twice the sum."""

    @property
    def size(self) -> int:
        """Number k of states."""
        return 2 * sum(self.sizes)

    @cached_property
    def of_sides(self) -> Array:
        """Matrix (k, k) by which even and odd parts become motions of the left and the right side."""
        return sums_and_differences(*self.sizes)

    @property
    def velocities(self) -> int:
        """Number of rates of motions, the last of the states."""
        return 0

    @property
    @abstractmethod
    def by_motions(self) -> Array:
        """Matrix A (k, k), 1/s."""

    @property
    @abstractmethod
    def by_loads(self) -> Array:
        """Matrix B (k, 18), of loads (18,) N and N m."""

    @property
    @abstractmethod
    def compliance(self) -> Array:
        """Static motions (k, 18) by unit loads, -A^-1 B."""

    @property
    @abstractmethod
    def energy_matrix(self) -> Array:
        """Matrix (k, k) whose quadratic form in x - x_0 is twice the energy, J."""

    @property
    @abstractmethod
    def damping(self) -> Array:
        """Matrix (k, k) whose quadratic form in the rates is the dissipated power, W."""

    @cached_property
    def unloaded(self) -> Array:
        """Motions (k,) without contact, x_0."""
        parts = 0.5 * OF_SIDES @ self.pairs.flexibility.unloaded
        return np.concatenate([parts, np.zeros(self.size - len(MOTIONS))])

    @property
    def varies(self) -> bool:
        """Whether the structure depends on the place along the track."""
        return self.pairs.flexibility.varies

    @property
    def period(self) -> float:
        """Period of the track (sleeper spacing), m; infinite for a uniform track."""
        return min((rail.spacing for rail in self.pairs.flexibility.rails or ()), default=np.inf)

    def at(self, distance: float) -> Self:
        """The structure at a distance m along the track."""
        if not self.varies:
            return self
        flexibility = self.pairs.flexibility.moved(distance)
        return replace(self, pairs=replace(self.pairs, flexibility=flexibility))

    def moved(self, state: WheelsetState, motions: Array) -> FlexibleState:
        """State of the wheelset with motions (k,)."""
        return FlexibleState(**vars(state), motions=tuple((OF_SIDES @ motions[: len(MOTIONS)]).tolist()))

    def rates(self, motions: Array, loads: Array) -> Array:
        """Rates (k,) of motions (k,) under loads (18,)."""
        return np.asarray(self.by_motions @ (motions - self.unloaded) + self.by_loads @ loads)

    @abstractmethod
    def rates_by_distance(self, motions: Array, loads: Array) -> Array:
        """Derivative (k,) of the rates by the distance along the track, for motions (k,) and loads (18,)."""

    @abstractmethod
    def energy_by_distance(self, motions: Array) -> float:
        """Derivative J/m of the energy of motions (k,) by the distance: force along the track."""

    def energy(self, motions: Array) -> Array:
        """Energy (...) J of motions (..., k), without that of the wheelset's own weight."""
        strain = motions - self.unloaded
        return np.asarray(0.5 * np.einsum("...i,ij,...j->...", strain, self.energy_matrix, strain))

    def dissipated_power(self, rates: Array) -> Array:
        """Power (...) W of the dampers at rates (..., k)."""
        return np.asarray(np.einsum("...i,ij,...j->...", rates, self.damping, rates))
