"""What a run goes on from after it was stopped: a state, and nothing that a contact remembers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from wheelrail.support.arrays import Array
from wheelrail.vehicle.simulation.history import RunCost
from wheelrail.vehicle.simulation.recorder import Row


@dataclass(frozen=True)
class Checkpoint:
    """All that a run takes past a checkpoint, so that one that was killed there goes on to the very last bit.

    time s and state; step s, the length of the next one (None: not known yet); error of the last one, in tolerances;
    what the run cost and the rows that it recorded so far, which go on growing.
    """

    time: float
    state: Array
    step: float | None
    error: float
    cost: RunCost
    rows: list[Row]


@dataclass(frozen=True)
class Checkpoints:
    """One after every so many accepted steps, and at the start, each handed to keep; latest, where to go on from.

    Contacts, steppers and differences start from nothing there, in a run that goes on, too: other distances give
    results that are others within the tolerances. Raises ValueError for less than a step.
    """

    every: int
    keep: Callable[[Checkpoint], None]
    latest: Checkpoint | None = None

    def __post_init__(self) -> None:
        if self.every < 1:
            raise ValueError(f"a checkpoint every {self.every} steps: 1 at least")
