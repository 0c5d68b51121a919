"""Interface between a contact and the equations of motion of the bodies."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Protocol, TypeVar

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
R = TypeVar("R")
KEPT = 64  # models of friction at different places of the track


class StateContact(Protocol[S, K]):
    """Contact model of the sides of a body: state and side in, result out.

    Subclasses define the call; the other methods have defaults, for models without tangent that solve one state after
    the other.
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
        """Results of one side at several states, such as the states of all wheelsets of a vehicle.

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

    @property
    def concurrent(self) -> bool:
        """Whether several threads may solve different states at the same time."""
        return True

    def each(self, function: Callable[..., R], tasks: Sequence[tuple[Any, ...]]) -> Iterable[R]:
        """Values of a function that uses this contact, of the arguments of each task, in their order."""
        return (function(*task) for task in tasks)


class VehicleContact(StateContact[WheelsetState, Side], Protocol):
    """Contact model of the left and the right wheel of a wheelset, with the moment about the wheelset's centre."""

    def rubbing(self, factor: float) -> VehicleContact:
        """The contact with its coefficients of friction times a factor. Raises ValueError for a model without such."""
        raise ValueError(f"friction along the track: not with {type(self).__name__}")


class WrappedContact(VehicleContact):
    """Contact model that hands all calls on to another one; subclasses change some.

    Parameters:
        contact: the wrapped model.
    """

    def __init__(self, contact: VehicleContact) -> None:
        self.contact = contact

    def rubbing(self, factor: float) -> VehicleContact:
        own = copy(self)
        own.contact = self.contact.rubbing(factor)
        return own

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.solve_side([state], side, [guess])[0]

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        return self.side_tangents([state], side, [result])[0]  # type: ignore[no-any-return]

    @property
    def together(self) -> bool:
        return self.contact.together

    @property
    def concurrent(self) -> bool:
        return self.contact.concurrent

    def each(self, function: Callable[..., R], tasks: Sequence[tuple[Any, ...]]) -> Iterable[R]:
        return self.contact.each(function, tasks)

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        return self.contact.solve_side(states, side, guesses)

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        return self.contact.side_tangents(states, side, results)

    def warm_start(self, side: Side, result: ContactResult) -> object:
        return self.contact.warm_start(side, result)

    def guess(self, side: Side, warm_start: object) -> ContactResult:
        return self.contact.guess(side, warm_start)


class IndependentWheels(WrappedContact):
    """Contact model of wheelsets whose wheels turn by themselves: each side has the spin of its own wheel."""

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        return self.contact.solve_side([state.turning_as(side) for state in states], side, guesses)

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        return self.contact.side_tangents([state.turning_as(side) for state in states], side, results)


@dataclass(frozen=True)
class ContactsByWheelset(VehicleContact):
    """Contact models of the wheelsets of a vehicle; each state has that of its own wheelset.

    Parameters:
        default: of wheelsets without one of their own.
        own: by name of the wheelset; those with the same model are solved together.
    """

    default: VehicleContact
    own: Mapping[str, VehicleContact]

    def of(self, wheelset: str) -> VehicleContact:
        """Contact of a wheelset."""
        return self.own.get(wheelset, self.default)

    def changed(self, change: Callable[[VehicleContact], VehicleContact]) -> ContactsByWheelset:
        """The contacts changed by a function, which is called once for each model."""
        new = {id(contact): change(contact) for contact in self._models}
        own = {name: new[id(contact)] for name, contact in self.own.items()}
        return ContactsByWheelset(new[id(self.default)], own)

    def rubbing(self, factor: float) -> ContactsByWheelset:
        return self.changed(lambda contact: contact.rubbing(factor))

    @cached_property
    def _models(self) -> list[VehicleContact]:
        """Each model once."""
        return list({id(contact): contact for contact in (self.default, *self.own.values())}.values())

    @property
    def together(self) -> bool:
        return all(contact.together for contact in self._models)

    @property
    def concurrent(self) -> bool:
        return all(contact.concurrent for contact in self._models)

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.of(state.wheelset)(state, side, guess)

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        return self.of(state.wheelset).tangent(state, side, result)

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        return _solved([self.of(state.wheelset) for state in states], states, side, guesses)

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        return _slopes([self.of(state.wheelset) for state in states], states, side, results)


class FrictionAlong(WrappedContact):
    """Contact model whose coefficient of friction is multiplied by the factor of each state.

    Parameters:
        contact: the wrapped model.
    """

    def __init__(self, contact: VehicleContact) -> None:
        super().__init__(contact)
        self._of = lru_cache(KEPT)(lambda factor: contact if factor == 1.0 else contact.rubbing(factor))

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        return _solved([self._of(state.friction) for state in states], states, side, guesses)

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        return _slopes([self._of(state.friction) for state in states], states, side, results)


def _solved(
    models: Sequence[VehicleContact],
    states: Sequence[WheelsetState],
    side: Side,
    guesses: Sequence[ContactResult | None],
) -> list[ContactResult]:
    """Results of states by a model for each; those of the same model are solved together."""
    found: dict[int, ContactResult] = {}
    for model, group in _groups(models):
        own = model.solve_side([states[i] for i in group], side, [guesses[i] for i in group])
        found |= zip(group, own, strict=True)
    return [found[i] for i in range(len(states))]


def _slopes(
    models: Sequence[VehicleContact], states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]
) -> Array:
    """Tangents of states by a model for each."""
    found: dict[int, Array] = {}
    for model, group in _groups(models):
        own = model.side_tangents([states[i] for i in group], side, [results[i] for i in group])
        found |= zip(group, own, strict=True)
    return np.array([found[i] for i in range(len(states))])


def _groups(models: Sequence[VehicleContact]) -> Iterator[tuple[VehicleContact, list[int]]]:
    """Each model once with its indices."""
    for model in {id(own): own for own in models}.values():
        yield model, [i for i, own in enumerate(models) if own is model]
