"""Counts what the contact solves of a run cost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from time import perf_counter

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Contact


@dataclass
class SideCost:
    """Solves (failed ones included), failed ones, Newton and linear iterations, seconds, tangents included, as this
    process waited for them; seconds by phase; tangents.
    """

    solves: int = 0
    failed: int = 0
    newton: int = 0
    linear: int = 0
    seconds: float = 0.0
    phases: dict[str, float] = field(default_factory=dict)
    tangents: int = 0


@dataclass
class Tally:
    """A contact that passes calls on to another one and adds up what they cost; it can what the other one can."""

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

    def __post_init__(self) -> None:
        # what only some contacts can: a method would promise it for all of them
        for name in ("tangent", "ahead", "ahead_tangent"):
            if hasattr(self.contact, name):
                inner = getattr(self.contact, name)
                setattr(self, name, partial(self._tangent, inner) if name == "tangent" else inner)

    def _tangent(
        self,
        inner: Callable[[WheelsetState, Side, ContactResult], Array],
        state: WheelsetState,
        side: Side,
        result: ContactResult,
    ) -> Array:
        cost, start = self.costs[side], perf_counter()
        try:
            found = inner(state, side, result)
            cost.tangents += 1
            return found
        finally:
            cost.seconds += perf_counter() - start
