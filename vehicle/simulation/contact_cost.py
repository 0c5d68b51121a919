"""Cost of the contact solves of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array


@dataclass
class ContactCost:
    """Call statistics of the contact of one side.

    Parameters:
        solves, failed: solves (failed ones included), failed solves.
        newton, linear: iterations.
        seconds: wall time of this process, tangents included.
        phases: seconds by phase.
        tangents: number of tangents.
    """

    solves: int = 0
    failed: int = 0
    newton: int = 0
    linear: int = 0
    seconds: float = 0.0
    phases: dict[str, float] = field(default_factory=dict)
    tangents: int = 0


@dataclass
class CountedContact(VehicleContact):
    """Contact model that counts and times the calls to the model it wraps.

    Parameters:
        contact: the wrapped model.
        costs: call statistics by side.
    """

    contact: VehicleContact
    costs: dict[Side, ContactCost] = field(default_factory=lambda: {"left": ContactCost(), "right": ContactCost()})

    def __call__(self, state: WheelsetState, side: Side, guess: ContactResult | None = None) -> ContactResult:
        return self.solve_side([state], side, [guess])[0]

    @property
    def together(self) -> bool:
        return self.contact.together

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        cost, start = self.costs[side], perf_counter()
        results: list[ContactResult] = []
        try:
            results = self.contact.solve_side(states, side, guesses)
        finally:
            cost.solves += len(states)
            cost.seconds += perf_counter() - start
            cost.failed += len(states) - sum(result.ok for result in results)
        for result in results:
            cost.newton += result.statistics.newton
            cost.linear += result.statistics.linear
            for phase, seconds in result.statistics.seconds.items():
                cost.phases[phase] = cost.phases.get(phase, 0.0) + seconds
        return results

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        return np.asarray(self.side_tangents([state], side, [result])[0])

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        cost, start = self.costs[side], perf_counter()
        try:
            tangents = self.contact.side_tangents(states, side, results)
            cost.tangents += len(states)
            return tangents
        finally:
            cost.seconds += perf_counter() - start

    def warm_start(self, side: Side, result: ContactResult) -> object:
        return self.contact.warm_start(side, result)

    def guess(self, side: Side, warm_start: object) -> ContactResult:
        return self.contact.guess(side, warm_start)

    def ahead(self, state: WheelsetState, guess: ContactResult | None) -> None:
        self.contact.ahead(state, guess)

    def ahead_tangent(self, state: WheelsetState, result: ContactResult) -> None:
        self.contact.ahead_tangent(state, result)
