"""Checkpoints of a run: states from which it can be resumed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from wheelrail.contact.element.contact_element import ElementState
from wheelrail.contact.kinematics.frames import Side
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Instant
from wheelrail.vehicle.multibody.contact_differences import ContactDifferences
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.history import RunCost
from wheelrail.vehicle.simulation.row import Row


class OtherVehicle(ValueError):
    """A checkpoint of another vehicle."""


WarmStarts = Mapping[str, ElementState[Side]]  # by wheelset


@dataclass(frozen=True)
class Checkpoint:
    """All data that a run carries across a checkpoint: a resumed run reproduces the uninterrupted one bit for bit.

    The evaluation at the state is repeated from the guess that it started from.

    Parameters:
        time: s.
        state: (n,).
        step: length of the next step, s; None: not yet estimated.
        error: of the last step, in tolerances.
        before: time s and state (n,) at the start of the last step; None: there is none.
        guess: warm starts of the contact solves at the state; None: none.
        solved: state nearby at which the contacts were solved, and the warm starts of these solves; None: at the state.
        differences: contact tangents by differences; None: of a model that has its own, or not yet computed.
        cost: of the run so far.
        rows: recorded so far; the list is extended by the running simulation.
    """

    time: float
    state: Array
    step: float | None
    error: float
    before: Instant | None
    guess: WarmStarts | None
    solved: tuple[Array, WarmStarts | None] | None
    differences: ContactDifferences | None
    cost: RunCost
    rows: Sequence[Row]

    def require_fit(self, dynamics: VehicleDynamics) -> None:
        """Raises OtherVehicle where a size is not that of a vehicle."""
        wheelsets, tangents = dynamics.vehicle.wheelsets, self.differences
        if self.state.shape != (dynamics.size,):
            raise OtherVehicle(f"checkpoint: a state of shape {self.state.shape}: must be ({dynamics.size},)")
        found = {len(row.force) for row in self.rows} | ({len(tangents.tangents)} if tangents is not None else set())
        if found - {len(wheelsets)} or (self.guess is not None and set(self.guess) != set(wheelsets)):
            raise OtherVehicle(f"checkpoint: forces of other wheelsets: must be those of {', '.join(wheelsets)}")


@dataclass(frozen=True)
class Checkpoints:
    """Checkpoints at the start and after every `every` accepted steps.

    Parameters:
        every: accepted steps.
        write: called with each checkpoint.
        latest: checkpoint to resume from.

    Checkpoints do not change the results. Raises ValueError for every < 1.
    """

    every: int
    write: Callable[[Checkpoint], None]
    latest: Checkpoint | None = None

    def __post_init__(self) -> None:
        if self.every < 1:
            raise ValueError(f"checkpoints: every = {self.every} steps: must be 1 at least")
