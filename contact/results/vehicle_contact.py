"""Interface between the contact of a wheelset and the equations of motion of a vehicle."""

from __future__ import annotations

from abc import abstractmethod
from typing import Protocol

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array


class VehicleContact(Protocol):
    """Contact model of the left and the right wheel of a wheelset.

    Subclasses define the call; `tangent`, `ahead` and `ahead_tangent` are optional, with defaults for models without
    them.
    """

    @abstractmethod
    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        """Result of one side in the track's axes, with the moment about the wheelset's centre.

        Parameters:
            state: of the wheelset.
            side: "left" or "right".
            guess: an earlier result of the same side, as initial guess.
        """

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """Derivative (6, 9) of force N and moment N m at a result by `WheelsetState.coordinates`.

        Parameters:
            state, side: for which the result was computed.
            result: point of linearisation.

        Raises ValueError for a model without tangent.
        """
        raise ValueError("the contact has no tangent")

    def ahead(self, state: WheelsetState, guess: ContactResult | None) -> None:
        """Announces the solve of the right side after that of the left one, so that both can run in parallel."""
        return  # sequential

    def ahead_tangent(self, state: WheelsetState, result: ContactResult) -> None:
        """Announces the tangent of the right side, see `ahead`."""
        return
