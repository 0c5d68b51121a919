"""Contact of both wheels of a wheelset by one contact model of the left-hand pair."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from wheelrail.bindings._contact import by_states
from wheelrail.contact.kinematics.frames import SIDES, Pose, RigidMotion, Side
from wheelrail.contact.kinematics.wheelset_state import Mounting, WheelsetState
from wheelrail.contact.models.standard.model import StandardContact
from wheelrail.contact.models.standard.wheel_rail import SolvedWheels, solved_together
from wheelrail.contact.models.table.tabulated import AtState, TableWheels, TabulatedContact
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array

ContactModel = Callable[[Pose, RigidMotion, ContactResult | None], ContactResult]


def _rubbing(factor: float, model: ContactModel) -> ContactModel:
    """Model with the coefficient of friction times a factor. Raises ValueError."""
    if hasattr(model, "rubbing"):
        return model.rubbing(factor)  # type: ignore[no-any-return]
    if not hasattr(model, "with_laws"):
        raise ValueError(f"friction along the track: not with {type(model).__name__}")
    changed: ContactModel = model.with_laws(model.laws.rubbing(factor))  # type: ignore[attr-defined]
    return changed


@dataclass(frozen=True)
class WheelsetContact(VehicleContact):
    """Contact of one side: state of the wheelset in, `ContactResult` in the track's axes out.

    Parameters:
        model: contact model of the left-hand pair, and of the mirror image of the right-hand one.
        mounting: dimensions of wheelset and track.
        right: contact of the right-hand pair, where profiles, radius or friction differ.

    The moment is about the wheelset's centre; the guess is an earlier result of the same side.
    """

    model: ContactModel
    mounting: Mounting
    right: WheelsetContact | None = None

    def of(self, side: Side) -> WheelsetContact:
        """Contact with the model and mounting of a side."""
        return self.right if side == "right" and self.right is not None else self

    def changed(self, change: Callable[[ContactModel], ContactModel]) -> WheelsetContact:
        """The contact with the models of both sides changed by a function."""
        right = None if self.right is None else self.right.changed(change)
        return replace(self, model=change(self.model), right=right)

    def rubbing(self, factor: float) -> WheelsetContact:
        """The contact with its coefficients of friction times a factor. Raises ValueError for other models and laws."""
        return self.changed(partial(_rubbing, factor))

    @property
    def together(self) -> bool:
        return all(self.batched(side) is not None or self._tabulated(side) is not None for side in SIDES)

    def _tabulated(self, side: Side) -> TabulatedContact | None:
        """Model of a side, if a table has most forces."""
        model = self.of(side).model
        return model if isinstance(model, TabulatedContact) else None

    def _on_table(self, model: TabulatedContact, states: Sequence[WheelsetState], side: Side) -> TableWheels:
        values, dimensions = np.array([state.values for state in states]), self.of(side).mounting.dimensions
        return TableWheels(model, values, dimensions, side == "right")

    @property
    def concurrent(self) -> bool:
        return all(getattr(self.of(side).model, "concurrent", True) for side in SIDES)

    def batched(self, side: Side) -> StandardContact | None:
        """Model of a side, if able to solve all wheels of the side in one call."""
        model = self.of(side).model
        return model if isinstance(model, StandardContact) and model.together is not None else None

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        if self.batched(side) is not None:
            return self.solve_side([state], side, [guess])[0]
        own, left_state = self.of(side), state if side == "left" else state.mirrored()
        pose, motion = own.mounting.left_pair(left_state)
        result = own.model(pose, motion, guess).about(motion.wheel.reference)
        return result if side == "left" else result.mirrored()

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        model = self.batched(side)
        if (tabulated := self._tabulated(side)) is not None:
            found = tabulated.at_states(self._on_table(tabulated, states, side), guesses)
            tasks = zip(found, states, guesses, strict=True)
            return [self(state, side, guess) if result is None else result for result, state, guess in tasks]
        if model is None:
            return super().solve_side(states, side, guesses)
        assert model.together is not None
        values, dimensions = np.array([state.values for state in states]), self.of(side).mounting.dimensions
        return model.results(SolvedWheels.at_states(model.together, values, dimensions, side == "right"))

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """Derivatives (6, 9) of force N and moment N m by `WheelsetState.coordinates`.

        Parameters:
            state: of the wheelset, m, rad, m/s and rad/s.
            side: of the contact.
            result: of this state and side.

        The moment is about the wheelset's centre, which moves with y and z. Zero when separated. Raises ValueError for
        a result without a tangent.
        """
        own, mirror = self.of(side), side == "right"
        tangent = (result.mirrored() if mirror else result).tangent()[None]
        wrench, values = np.concatenate([result.force, result.moment])[None], np.array([state.values])
        return np.asarray(by_states(tangent, wrench, values, own.mounting.dimensions[0], mirror)[0])

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        model, wheels = self.batched(side), solved_together(results)
        if (tabulated := self._tabulated(side)) is not None:
            tangents = self._on_table(tabulated, states, side).slopes()
            for i, (state, result) in enumerate(zip(states, results, strict=True)):
                if not isinstance(result.force_tangent, AtState):
                    tangents[i] = self.tangent(state, side, result)
            return tangents
        if model is None or wheels is None:
            return super().side_tangents(states, side, results)
        values, dimensions = np.array([state.values for state in states]), self.of(side).mounting.dimensions
        return wheels.of.by_states(wheels.indices, values, dimensions)
