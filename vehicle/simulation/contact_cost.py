"""Cost of the contact solves of a run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Lock
from time import perf_counter

from wheelrail.contact.kinematics.frames import Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.contact.results.vehicle_contact import VehicleContact, WrappedContact
from wheelrail.support.arrays import Array


@dataclass
class ContactCost:
    """Call statistics of the contact of one side.

    Parameters:
        solves, failed: solves (failed ones included), failed solves.
        newton, linear: iterations.
        seconds: wall time of all threads, tangents included.
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


class CountedContact(WrappedContact):
    """Contact model that counts and times the calls to a wrapped model.

    Parameters:
        contact: the wrapped model.
        costs: call statistics by side.
    """

    def __init__(self, contact: VehicleContact, costs: dict[Side, ContactCost] | None = None) -> None:
        super().__init__(contact)
        self.costs: dict[Side, ContactCost] = costs or {"left": ContactCost(), "right": ContactCost()}
        self._lock = Lock()  # of the costs

    def solve_side(
        self, states: Sequence[WheelsetState], side: Side, guesses: Sequence[ContactResult | None]
    ) -> list[ContactResult]:
        results: list[ContactResult] = []
        with self._timed(side) as cost:
            try:
                results = self.contact.solve_side(states, side, guesses)
            finally:
                with self._lock:
                    cost.solves += len(states)
                    cost.failed += len(states) - sum(result.ok for result in results)
                    for statistics in (result.statistics for result in results):
                        cost.newton += statistics.newton
                        cost.linear += statistics.linear
                        for phase, seconds in statistics.seconds.items():
                            cost.phases[phase] = cost.phases.get(phase, 0.0) + seconds
        return results

    def side_tangents(self, states: Sequence[WheelsetState], side: Side, results: Sequence[ContactResult]) -> Array:
        with self._timed(side) as cost:
            tangents = self.contact.side_tangents(states, side, results)
            with self._lock:
                cost.tangents += len(states)
            return tangents

    @contextmanager
    def _timed(self, side: Side) -> Iterator[ContactCost]:
        cost, start = self.costs[side], perf_counter()
        try:
            yield cost
        finally:
            with self._lock:
                cost.seconds += perf_counter() - start
