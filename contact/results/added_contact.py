"""Sum of two contacts of each side of a wheelset, each with its own pair of surfaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult, LazyPatches, Patch
from wheelrail.contact.results.vehicle_contact import VehicleContact, WrappedContact
from wheelrail.support.arrays import Array


@dataclass(frozen=True, eq=False)
class _Parts:
    """Tangent of a sum, from the results of both contacts in the same axes about the same point."""

    parts: tuple[ContactResult, ContactResult]

    def __call__(self) -> Array:
        return np.asarray(sum(part.tangent() for part in self.parts))

    def about(self, centre: Array) -> _Parts:
        first, second = self.parts
        return _Parts((first.about(centre), second.about(centre)))

    def mirrored(self) -> _Parts:
        first, second = self.parts
        return _Parts((first.mirrored(), second.mirrored()))


class AddedContact(WrappedContact):
    """Contact model of wheels with a second pair of surfaces, as flange back and check rail, whose force is added.

    Parameters:
        contact: of the first pair, whose fields, approach and warm starts are those of the sum.
        other: of the second pair, which needs no guess.
        sides: with a second pair.
        clears: whether the second pair of a side is open at a state, where that is known without solving it.

    Results of an open second pair are those of the first one.
    """

    def __init__(
        self,
        contact: VehicleContact,
        other: VehicleContact,
        sides: Sequence[Side] = SIDES,
        clears: Callable[[WheelsetState, Side], bool] = lambda state, side: False,
    ) -> None:
        super().__init__(contact)
        self.other, self.sides, self.clears = other, tuple(sides), clears

    @property
    def model(self) -> object:
        """Contact model of the left-hand first pair, if there is one for all poses."""
        return getattr(self.contact, "model", None)

    def changed(self, change: Callable[[Any], Any]) -> AddedContact:
        """The contact with the models of the first pair changed by a function."""
        return AddedContact(self.contact.changed(change), self.other, self.sides, self.clears)  # type: ignore[attr-defined]

    def rubbing(self, factor: float) -> AddedContact:
        return AddedContact(self.contact.rubbing(factor), self.other.rubbing(factor), self.sides, self.clears)

    @property
    def concurrent(self) -> bool:
        return self.contact.concurrent and self.other.concurrent

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        first = self.contact.solve_side(states, side, guesses)
        if side not in self.sides:
            return first
        return [
            own if self.clears(state, side) else _sum(own, self.other(state, side))
            for own, state in zip(first, states, strict=True)
        ]

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        parts = [own.parts if isinstance(own := result.force_tangent, _Parts) else None for result in results]
        first = [part[0] if part else result for part, result in zip(parts, results, strict=True)]
        slopes = self.contact.side_tangents(states, side, first)
        for i, part in enumerate(parts):
            if part:
                slopes[i] += self.other.tangent(states[i], side, part[1])
        return slopes


def _sum(first: ContactResult, second: ContactResult) -> ContactResult:
    """Sum of the results of two pairs; the first one where the second is open."""
    if second.status == "separated":
        return first
    if not first.ok:
        return first
    if not second.ok:
        return replace(second, approach=first.approach)
    return replace(
        first,
        force=first.force + second.force,
        moment=first.moment + second.moment,
        patches=LazyPatches(partial(_all, first, second)),
        status="converged",
        force_tangent=_Parts((first, second)),
    )


def _all(first: ContactResult, second: ContactResult) -> tuple[Patch, ...]:
    return (*first.patches, *second.patches)
