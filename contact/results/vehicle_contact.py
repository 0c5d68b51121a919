"""Interface between a contact and the equations of motion of the bodies."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import Protocol, TypeVar

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array


class HasCoordinates(Protocol):
    """Position and velocity of a body."""

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates and rates by which forces are differentiated."""


S = TypeVar("S", contravariant=True)
K = TypeVar("K", contravariant=True)


class StateContact(Protocol[S, K]):
    """Contact model of the sides of a body: state and side in, result out.

    Subclasses define the call; the other methods have defaults, for models without tangent that solve one state after
    the other in this process.
    """

    @abstractmethod
    def __call__(self, state: S, side: K, guess: ContactResult | None = None) -> ContactResult:
        """Result of one side in the axes of the track, or of the lower body.

        Parameters:
            state: position and velocity.
            side: name of the side.
            guess: an earlier result of the same side, as initial guess.
        """

    def tangent(self, state: S, side: K, result: ContactResult) -> Array:
        """Derivative (6, n) of force N and moment N m at a result by the coordinates of the state.

        Parameters:
            state, side: for which the result was computed.
            result: point of linearisation.

        Raises ValueError for a model without tangent.
        """
        raise ValueError("the contact has no tangent")

    @property
    def together(self) -> bool:
        """Whether `solve_side` and `side_tangents` compute all states at once; others are solved state by state."""
        return False

    def solve_side(self, states: Sequence[S], side: K, guesses: Sequence[ContactResult | None]) -> list[ContactResult]:
        """Results of one side at several states, such as those of all wheelsets of a vehicle.

        Parameters:
            states: positions and velocities.
            side: name of the side.
            guesses: an earlier result for each state, as initial guess.
        """
        return [self(state, side, guess) for state, guess in zip(states, guesses, strict=True)]

    def side_tangents(self, states: Sequence[S], side: K, results: Sequence[ContactResult]) -> Array:
        """Derivatives (m, 6, n) at the results of one side at m states, see `tangent`."""
        return np.array([self.tangent(state, side, result) for state, result in zip(states, results, strict=True)])

    def warm_start(self, side: K, result: ContactResult) -> object:
        """Plain data of a result of a side with which `guess` makes an equivalent guess, also in another process."""
        return result.warm_start

    def guess(self, side: K, warm_start: object) -> ContactResult:
        """Guess for the solve of a side; a solve from it repeats that from the original result to the last bit."""
        return ContactResult.guess(warm_start)

    def ahead(self, state: S, guess: ContactResult | None) -> None:
        """Announces the solve of the last side after those before it, so that they can run in parallel."""
        return  # sequential

    def ahead_tangent(self, state: S, result: ContactResult) -> None:
        """Announces the tangent of the last side, see `ahead`."""
        return


class VehicleContact(StateContact[WheelsetState, Side], Protocol):
    """Contact model of the left and the right wheel of a wheelset, with the moment about the wheelset's centre."""
