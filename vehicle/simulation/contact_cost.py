"""Cost of the contact solves of a run."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter

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
        cost, start, result = self.costs[side], perf_counter(), None
        try:
            result = self.contact(state, side, guess)
        finally:
            cost.solves += 1
            cost.seconds += perf_counter() - start
            cost.failed += result is None or not result.ok
        cost.newton += result.statistics.newton
        cost.linear += result.statistics.linear
        for phase, seconds in result.statistics.seconds.items():
            cost.phases[phase] = cost.phases.get(phase, 0.0) + seconds
        return result

    def tangent(self, state: WheelsetState, side: Side, result: ContactResult) -> Array:
        cost, start = self.costs[side], perf_counter()
        try:
            tangent = self.contact.tangent(state, side, result)
            cost.tangents += 1
            return tangent
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
