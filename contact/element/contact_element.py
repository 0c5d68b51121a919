"""A contact with a last accepted state, from which solves start."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any, Generic, TypeVar

import numpy as np

from wheelrail.contact.element.element_solution import ElementSolution
from wheelrail.contact.element.element_tangent import ElementTangent
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.contact.results.vehicle_contact import HasCoordinates, StateContact
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import check_interrupt

S = TypeVar("S", bound=HasCoordinates)
K = TypeVar("K", bound=str)

BREAKDOWN = (ArithmeticError, RuntimeError, np.linalg.LinAlgError)  # of a solver, at a state it was not made for


@dataclass(frozen=True)
class ElementState(Generic[K]):
    """The accepted state of an element, as plain data: numbers and arrays in dataclasses; it can be pickled.

    Parameters:
        warm_start: of each side, see `ContactResult.warm_start`; empty before the first accepted solve.
    """

    warm_start: Mapping[K, object]


class ContactElement(Generic[S, K]):
    """Contact of one or several sides, solved for trial states between accepted ones.

    Parameters:
        contact: model of all sides.
        sides: their names.

    `solve_states` and `tangents` are functions of their arguments alone. `solve_state` starts from the last
    accepted results; trial states that are not accepted have no influence on later ones.
    """

    def __init__(self, contact: StateContact[S, K], sides: tuple[K, ...]) -> None:
        self.contact, self.sides = contact, sides
        self._accepted: Mapping[K, ContactResult] = {}
        self._latest: ElementSolution[S, K] | None = None

    def solve_states(
        self, states: Sequence[S], starts: Sequence[Mapping[K, ContactResult] | None]
    ) -> Iterator[tuple[int, K, ContactResult]]:
        """Index of the state, side and result, of all sides at several states.

        Parameters:
            states: positions and velocities.
            starts: results of all sides as initial guess, for each state.

        A breakdown of the solver and a force that is not finite are failed results.
        """
        return self._each(self._solve_side, states, [start or {} for start in starts])

    def solve_sides(self, state: S, start: Mapping[K, ContactResult] | None) -> Iterator[tuple[K, ContactResult]]:
        """Side and result at one state, see `solve_states`."""
        return ((side, result) for _, side, result in self.solve_states([state], [start]))

    def _solve_side(
        self, states: Sequence[S], side: K, guesses: Sequence[ContactResult | None]
    ) -> Sequence[ContactResult]:
        check_interrupt()
        try:
            return [_finite(result) for result in self.contact.solve_side(states, side, guesses)]
        except BREAKDOWN as error:
            return [ContactResult.failed(f"{type(error).__name__}: {error}")] * len(states)

    def tangents(self, states: Sequence[S], results: Sequence[Mapping[K, ContactResult]]) -> Array:
        """Derivatives (m, sides, 6, n) of force N and moment N m by the coordinates of m states.

        Parameters:
            states: positions and velocities.
            results: of these states.

        Raises ValueError for a model or a result without tangent.
        """
        values = np.array([value for _, _, value in self._each(self.contact.side_tangents, states, results)])
        return values.reshape(len(self.sides), len(states), *values.shape[1:]).swapaxes(0, 1)

    def _each(
        self,
        function: Callable[[Sequence[S], K, Sequence[Any]], Any],
        states: Sequence[S],
        given: Sequence[Mapping[K, ContactResult]],
    ) -> Iterator[tuple[int, K, Any]]:
        """Index of the state, side and value of a function, for each state and side."""
        all_states = range(len(states))
        groups = [all_states] if self.contact.together else [[i] for i in all_states]
        keys = [(group, side) for side in self.sides for group in groups]
        tasks = [([states[i] for i in group], side, [given[i].get(side) for i in group]) for group, side in keys]
        for (group, side), values in zip(keys, self.contact.each(function, tasks), strict=True):
            yield from ((i, side, value) for i, value in zip(group, values, strict=True))

    def solve_state(self, state: S) -> ElementSolution[S, K]:
        """Solution of a trial state, from the last accepted results."""
        self._latest = None
        self._latest = ElementSolution(state, dict(self.solve_sides(state, self._accepted)))
        return self._latest

    def accept(self) -> None:
        """Let the next solves start from the last solved state. Raises ValueError when it failed, or there is none."""
        self._accepted = {side: _initial_guess(result) for side, result in self._solved("accept").results.items()}

    def tangent(self) -> ElementTangent:
        """Derivatives of force and moment at the last solved state.

        Raises ValueError when it failed, or there is none, and for a model without tangent.
        """
        solution = self._solved("tangent")
        (values,) = self.tangents([solution.state], [solution.results])
        return ElementTangent(values, self.sides, solution.state.coordinates)

    def patches(self) -> dict[K, tuple[Patch, ...]]:
        """Patches of each side at the last solved state. Raises ValueError when it failed, or there is none."""
        return {side: tuple(result.patches) for side, result in self._solved("patches").results.items()}

    def state(self) -> ElementState[K]:
        """The accepted state; a trial state that is not accepted is not part of it."""
        return self.state_of(self._accepted)

    def restore(self, state: ElementState[K]) -> None:
        """Return to an accepted state, also that of an equal element in another process.

        Parameters:
            state: from `state`.

        Solves after it repeat those after `state` to the last bit. Raises ValueError for a state of other sides,
        TypeError for anything else.
        """
        if not isinstance(state, ElementState):
            raise TypeError(f"restore: must be given the state of an element, got {type(state).__name__}")
        sides = state.warm_start
        if sides and set(sides) != set(self.sides):
            raise ValueError(f"restore: must be a state of {', '.join(self.sides)}, got {', '.join(sides)}")
        self._accepted, self._latest = self.guesses(state), None

    def state_of(self, results: Mapping[K, ContactResult]) -> ElementState[K]:
        """State of an element after accepted results."""
        return ElementState({side: self.contact.warm_start(side, result) for side, result in results.items()})

    def guesses(self, state: ElementState[K]) -> dict[K, ContactResult]:
        """Initial guesses by side, from the warm starts of a state."""
        return {side: self.contact.guess(side, warm_start) for side, warm_start in state.warm_start.items()}

    def _solved(self, purpose: str) -> ElementSolution[S, K]:
        """The last solution. Raises ValueError when it failed, or there is none."""
        if self._latest is None:
            raise ValueError(f"{purpose}: no state has been solved since the element was made or restored")
        if not self._latest.ok:
            raise ValueError(f"{purpose}: the last solve {self._latest.status}")
        return self._latest


def _finite(result: ContactResult) -> ContactResult:
    """The result, a failed one for a force that is not finite."""
    if result.ok and not all(map(isfinite, (*result.force.tolist(), *result.moment.tolist()))):
        return ContactResult.failed("force or moment is not finite", result.approach)
    return result


def _initial_guess(result: ContactResult) -> ContactResult:
    """The result without patches, fields and tangent, which hold on to whole problems."""
    return replace(result, patches=(), fields=None, force_tangent=None)
