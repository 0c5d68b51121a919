"""The contact of both wheels of a wheelset as the equations of motion of a vehicle call it."""

from __future__ import annotations

from abc import abstractmethod
from typing import Protocol

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array


class VehicleContact(Protocol):
    """Contact model of the left and the right wheel of a wheelset.

    Explicit subclasses define the call; tangent and work ahead are optional, with defaults for models without them.
    """

    @abstractmethod
    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        """Result of one side in the track's axes, its moment about the wheelset's centre; guess: an earlier result of
        the same side.
        """

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        """Derivative (6, 8) of force N and moment N m by y, z, roll, yaw, y_rate, z_rate, roll_rate and pitch_rate, at
        a result of this state and side.

        Raises ValueError where the model has none.
        """
        raise ValueError("the contact has no tangent")

    def ahead(self, state: WheelsetState, guess: ContactResult | None) -> None:
        """Announces the solve of the right side, which follows that of the left one: both may run at the same time."""
        return  # one after the other

    def ahead_tangent(self, state: WheelsetState, result: ContactResult) -> None:
        """The same for the tangent of the right side."""
        return
