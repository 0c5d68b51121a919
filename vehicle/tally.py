"""Counts what the contact solves of a run cost."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter

from contact.pose import Side, WheelsetState
from contact.result import ContactResult
from vehicle.dynamics import Contact


@dataclass
class SideCost:
    """Solves (failed ones included), failed ones, Newton and linear iterations, seconds; and seconds by phase."""

    solves: int = 0
    failed: int = 0
    newton: int = 0
    linear: int = 0
    seconds: float = 0.0
    phases: dict[str, float] = field(default_factory=dict)


@dataclass
class Tally:
    """A contact that passes calls on to another one and adds up what they cost."""

    contact: Contact
    costs: dict[Side, SideCost] = field(default_factory=lambda: {"left": SideCost(), "right": SideCost()})

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
