"""Wheels of one side on moved rails, with moved hubs, solved together by the standard contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from wheelrail.bindings._contact import MovedStates, Parameters, moved_forces, moved_tangents
from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.loading.moved_pair import RotatedTangent, turned
from wheelrail.contact.models.standard.wheel_rail import SolvedWheels, WheelDerivative, solved_together
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True, eq=False)
class MovedWheels(SolvedWheels):
    """Wheels of one side, with forces in the track's axes and moments about the wheelsets' centres.

    Parameters:
        rails: axes (w, 3, 3) of the moved rails as left-hand ones, in the track's.
        rolls: (w,) rad of these rails.
    """

    rails: Array
    rolls: Array

    @classmethod
    def at(cls, parameters: Parameters, states: MovedStates) -> MovedWheels:
        """Wheels at states."""
        pairs, rails, forces = moved_forces(parameters, states)
        return cls(parameters, pairs, forces, states.mirror, rails, states.moves[:, 8])

    def patches(self, i: int) -> tuple[Patch, ...]:
        own = turned(self.patches_of_pair(i), self.rails[i], float(self.rolls[i]))
        return tuple(patch.mirrored() for patch in own) if self.mirror else own

    def tangent(self, i: int) -> RotatedTangent:
        own = RotatedTangent(ContactTangent(WheelDerivative(self, i), self.pairs.centre[i]), self.rails[i])
        return own.mirrored() if self.mirror else own

    def by_moves(self, wheels: Nodes, states: MovedStates) -> Array:
        """Derivatives (m, 6, 18) of left-hand wheels; parameters as for `moved_tangents`."""
        return moved_tangents(self.parameters, self.pairs, self.forces, wheels, states)


def moved_together(results: Sequence[ContactResult]) -> tuple[MovedWheels, Nodes] | None:
    """Wheels of results from one `MovedWheels` and their indices, see `solved_together`; None for other results."""
    own = [result.force_tangent for result in results]
    bare = [t.tangent if isinstance(t, RotatedTangent) else t for t in own]
    found = solved_together([changed(r, force_tangent=t) for r, t in zip(results, bare, strict=True)])
    return None if found is None or not isinstance(found.of, MovedWheels) else (found.of, found.indices)
