"""Elastic axles and tracks of the wheelsets of a vehicle, with their motions as states after the bodies' own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.wheelset_state import WheelsetState
    from wheelrail.contact.loading.flexible_contact import FlexiblePairs
    from wheelrail.contact.loading.structure import Structure


class ElasticWheelset(NamedTuple):
    """A wheelset whose axle or rails move.

    Parameters:
        wheelset: its index.
        structure: axle and track under it.
        states: places of its motions among those of all wheelsets.
    """

    wheelset: int
    structure: Structure
    states: slice


@dataclass(frozen=True)
class Structures:
    """Axle and track of each of w wheelsets, with n motions in all.

    Parameters:
        own: (w,); None where axle and rails are rigid.
    """

    own: tuple[Structure | None, ...]

    @classmethod
    def of(cls, given: Structure | Sequence[Structure | None] | None, count: int) -> Structures:
        """Structures of a number of wheelsets: one for all, or one for each. Raises ValueError for another number."""
        if not isinstance(given, Sequence):
            return cls((given,) * count)
        if len(given) != count:
            raise ValueError(f"structure: must be one for all, or {count} for as many wheelsets, got {len(given)}")
        return cls(tuple(given))

    @cached_property
    def elastic(self) -> tuple[ElasticWheelset, ...]:
        """Wheelsets whose axle or rails move."""
        found, first = list[ElasticWheelset](), 0
        for i, structure in enumerate(self.own):
            if structure is not None:
                found.append(ElasticWheelset(i, structure, slice(first, first + structure.size)))
                first += structure.size
        return tuple(found)

    @property
    def size(self) -> int:
        """Number n of motions."""
        return self.elastic[-1].states.stop if self.elastic else 0

    @cached_property
    def velocities(self) -> NDArray[np.bool_]:
        """Whether (n,) a motion is a rate."""
        result = np.zeros(self.size, dtype=bool)
        for _, structure, states in self.elastic:
            result[states.stop - structure.velocities : states.stop] = True
        return result

    @property
    def period(self) -> float:
        """Shortest period of a track (sleeper spacing), m; infinite for uniform ones."""
        return min((own.structure.period for own in self.elastic), default=np.inf)

    @cached_property
    def _alike(self) -> list[tuple[FlexiblePairs, list[int]]]:
        """Pairs with the indices of their wheelsets among all elastic ones."""
        pairs = [own.structure.pairs for own in self.elastic]
        found = {id(own): own for own in pairs}
        return [(own, [i for i, other in enumerate(pairs) if other is own]) for own in found.values()]

    def loads(self, states: Sequence[WheelsetState], wrenches: Array) -> Array:
        """Loads (e, 18) N and N m on the motions of each elastic wheelset.

        Parameters:
            states: of all w wheelsets.
            wrenches: (w, 2, 6), force N on the left and the right wheel, and moment N m about the wheelset's centre.
        """
        result = np.empty((len(self.elastic), 18))
        for pairs, members in self._alike:
            own = [self.elastic[i].wheelset for i in members]
            result[members] = pairs.loads([states[i] for i in own], wrenches[own])
        return result

    def load_slopes(self, states: Sequence[WheelsetState], wrenches: Array, tangents: Array) -> Array:
        """Derivatives (e, 2, 18, c) of the loads, see `FlexiblePairs.load_slopes`; tangents: (w, 2, 6, c)."""
        result = np.empty((len(self.elastic), 2, 18, tangents.shape[-1]))
        for pairs, members in self._alike:
            own = [self.elastic[i].wheelset for i in members]
            result[members] = pairs.load_slopes([states[i] for i in own], wrenches[own], tangents[own])
        return result

    def static(self, rates: Array, distances: Array) -> Array:
        """Distances (n, ...) of motions from static ones under the same loads, by rates (n, ...).

        Parameters:
            rates: m/s and rad/s.
            distances: (w,) m of the wheelsets along the track.
        """
        result = np.empty_like(rates)
        for i, structure, states in self.elastic:
            result[states] = np.linalg.solve(structure.at(float(distances[i])).by_motions, rates[states])
        return result
