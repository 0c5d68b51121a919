"""Contact tangents by difference quotients, used several times."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import StepFailure

REUSED = 8  # Jacobians per set of contact differences: saves 2 of 3 solves, at a third more steps


@dataclass(frozen=True)
class ContactDifferences:
    """Contact tangents by differences, used several times.

    Parameters:
        tangents: (w, 2, 6, 9) of w wheelsets.
        age: Jacobians made with them, after the first.
    """

    tangents: Array
    age: int = 0


def renewed(current: ContactDifferences | None, differentiate: Callable[[], Array]) -> ContactDifferences:
    """Differences for the next Jacobian: those of an earlier one as long as they may be reused.

    Parameters:
        current: of the last Jacobian; None: none yet.
        differentiate: tangents at the present state.

    Where a contact fails nearby, earlier differences are used further. Raises StepFailure when there are none.
    """
    if current is None:
        return ContactDifferences(differentiate())
    if current.age + 1 < REUSED:
        return replace(current, age=current.age + 1)
    with suppress(StepFailure):
        return ContactDifferences(differentiate())
    return current
