"""Forces of all sides of a contact element at one state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array

S = TypeVar("S")
K = TypeVar("K", bound=str)
ArrayBySide = dict[str, Array]


@dataclass(frozen=True)
class ElementSolution(Generic[S, K]):
    """Contact of all sides at a state.

    Parameters:
        state: position and velocity for which the contact was solved.
        results: contact result of each side, with patches and fields.
    """

    state: S
    results: Mapping[K, ContactResult]

    @property
    def status(self) -> str:
        """ "converged" (a side may be separated), "separated" (all sides), or "failed: ..." with side and reason."""
        failures = [
            f"{side}: {result.status.removeprefix('failed: ')}"
            for side, result in self.results.items()
            if not result.ok
        ]
        if failures:
            return f"failed: {'; '.join(failures)}"
        return "converged" if any(r.status == "converged" for r in self.results.values()) else "separated"

    @property
    def ok(self) -> bool:
        """Whether no side failed."""
        return all(result.ok for result in self.results.values())

    @property
    def force(self) -> ArrayBySide:
        """Force (3,) N on the wheel, or the upper body, of each side; NaN of one that failed."""
        return {side: _usable(result, result.force) for side, result in self.results.items()}

    @property
    def moment(self) -> ArrayBySide:
        """Moment (3,) N m of each side, about the centre of the wheelset; NaN of one that failed."""
        return {side: _usable(result, result.moment) for side, result in self.results.items()}

    @property
    def approach(self) -> dict[K, float]:
        """Largest undeformed penetration of each side, m; negative is a distance."""
        return {side: result.approach for side, result in self.results.items()}

    @property
    def iterations(self) -> dict[K, int]:
        """Newton iterations of each side."""
        return {side: result.statistics.newton for side, result in self.results.items()}


def _usable(result: ContactResult, vector: Array) -> Array:
    return vector if result.ok else np.full(3, np.nan)
