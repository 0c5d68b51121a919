"""A run in time: integration over a span with recording, checkpoints, and limits."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any, Generic, Protocol, TypeVar

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import deferred_interrupts
from wheelrail.vehicle.dynamics.contact_differences import ContactDifferences
from wheelrail.vehicle.integration.integrate import FirstStep, Step, StepSettings, StepTooSmall, integrate
from wheelrail.vehicle.integration.problem import E, HasDerivatives, StepFailure
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints, WarmStarts
from wheelrail.vehicle.simulation.contact_cost import ContactCost, CountedContact
from wheelrail.vehicle.simulation.history import RunCost
from wheelrail.vehicle.simulation.limits import OutOfBounds
from wheelrail.vehicle.simulation.recorder import Recorder
from wheelrail.vehicle.steady.equilibrium import EquilibriumError
from wheelrail.vehicle.track.speed_profile import SpeedProfile

Progress = Callable[[float, Mapping[str, float]], None]


@dataclass(frozen=True)
class Recording:
    """Recording of a run.

    Parameters:
        interval: between rows, s; None: rows at accepted steps.
        checkpoints: spacing, receiver and start; None: no checkpoints.

    Raises ValueError for an interval that is not positive.
    """

    interval: float | None = None
    checkpoints: Checkpoints | None = None

    def __post_init__(self) -> None:
        if self.interval is not None and not self.interval > 0.0:
            raise ValueError(f"interval = {self.interval} s: must be positive, or None for all accepted steps")


class RunDynamics(Protocol):
    """Equations of motion of a run, a dataclass."""

    @property
    def contact(self) -> VehicleContact: ...

    @property
    def size(self) -> int: ...

    @property
    def speed_profile(self) -> SpeedProfile: ...


C = TypeVar("C", contravariant=True)


class Linearisation(Protocol[C]):
    """Jacobian of the equations of motion, with the contact differences that it uses again."""

    @property
    def differences(self) -> ContactDifferences | None: ...

    def __call__(self, time: float, state: Array, at: C) -> HasDerivatives: ...


D = TypeVar("D", bound=RunDynamics)


class TimeRun(ABC, Generic[D, E]):
    """A run in progress, resumed from the latest checkpoint if there is one: its cost and recorded rows.

    Parameters:
        dynamics: equations of motion.
        span: start and end, s.
        steps: method, tolerances and bounds of the steps.
        recording: rows and checkpoints.
        progress: called at each accepted step with the completed fraction and statistics.

    Subclasses define what belongs to their equations of motion. Raises ValueError for a checkpoint of another state.
    """

    def __init__(
        self,
        dynamics: D,
        span: tuple[float, float],
        steps: StepSettings,
        recording: Recording,
        progress: Progress | None,
    ) -> None:
        self.span, self.steps, self.progress, self.checkpoints = span, steps, progress, recording.checkpoints
        self.latest = self.checkpoints.latest if self.checkpoints else None
        if self.latest is not None and self.latest.state.shape != (dynamics.size,):
            raise ValueError(f"checkpoint: a state of shape {self.latest.state.shape}: must be ({dynamics.size},)")
        self.cost = (
            deepcopy(self.latest.cost) if self.latest else RunCost(contact={side: ContactCost() for side in SIDES})
        )
        self.uncounted: D = dynamics
        self.dynamics: D = self._counted(dynamics)
        self.recorder = self.recorder_of(recording.interval)
        self.recorder.rows = list(self.latest.rows) if self.latest else []
        self.began = perf_counter() - self.cost.seconds

    def _counted(self, dynamics: Any) -> Any:
        """The equations of motion with a contact that counts its calls."""
        return replace(dynamics, contact=CountedContact(dynamics.contact, self.cost.contact))

    @abstractmethod
    def recorder_of(self, interval: float | None) -> Recorder[E, Any]:
        """Recorder of rows at an interval, s, or at accepted steps."""

    @abstractmethod
    def equilibrium(self, time: float) -> Array:
        """State of rest at a time, s. Raises EquilibriumError."""

    @abstractmethod
    def evaluate(self, dynamics: D, at: Checkpoint) -> E:
        """Evaluation at a checkpoint, from its guess. Raises StepFailure."""

    @abstractmethod
    def right_hand_side(self, time: float, state: Array, previous: E | None) -> E:
        """Evaluation of the equations of motion. Raises StepFailure."""

    def between(self, step: Step[E], time: float, state: Array) -> tuple[Array, E]:
        """State and evaluation at a time s within a step, from the state of its dense output. Raises StepFailure."""
        return state, self.right_hand_side(time, state, step.end)

    @abstractmethod
    def linearisation(self, differences: ContactDifferences | None) -> Linearisation[E]:
        """Jacobian that starts from contact differences."""

    @abstractmethod
    def warm_starts(self, evaluation: E) -> WarmStarts | None:
        """Warm starts of the contact solves of an evaluation, as plain data."""

    @abstractmethod
    def check(self, time: float, state: Array) -> None:
        """Raises OutOfBounds beyond the limits."""

    @abstractmethod
    def describe(self, time: float, state: Array) -> str:
        """Position in words, for the status of a run with a failed contact solve."""

    @property
    def seconds(self) -> float:
        """Wall time s, including that before the checkpoint."""
        return perf_counter() - self.began

    def run(self, initial: Array | None) -> str:
        """Integrates over the span from an initial state, by default the equilibrium; returns the status."""
        try:
            with deferred_interrupts():
                self._integrate(self.latest or self._start(initial))
        except KeyboardInterrupt:
            return "interrupted"
        except StepTooSmall as error:
            return f"failed: {error}; {self.describe(*self.recorder.latest)}"
        except (StepFailure, EquilibriumError, OutOfBounds) as error:
            return f"failed: {error}"
        finally:
            self.cost.seconds = self.seconds
        return "completed"

    def _start(self, initial: Array | None) -> Checkpoint:
        time = self.span[0]
        state = self.equilibrium(time) if initial is None else initial.astype(float)
        return Checkpoint(time, state, None, 1.0, None, None, self.cost, self.recorder.rows)

    def _integrate(self, at: Checkpoint) -> None:
        """Integrates from a checkpoint to the end of the span."""
        # the evaluation counts once, also when it is repeated for a resumed run
        first = self.evaluate(self.uncounted if at is self.latest else self.dynamics, at)
        jacobian = self.linearisation(at.differences)
        self.recorder.begin(at.time, at.state, first)
        if self.checkpoints is not None and at is not self.latest:
            self.checkpoints.write(replace(at, cost=deepcopy(self.cost), rows=self.recorder.rows))
        steps = integrate(
            self.right_hand_side,
            at.time,
            at.state,
            self.span[1],
            self.steps,
            jacobian=jacobian,
            first=FirstStep(first, at.step, at.error),
            counts=self.cost.steps,
        )
        for count, step in enumerate(steps, start=1):
            self._accept(step)
            if self.checkpoints is not None and count % self.checkpoints.every == 0 and step.t < self.span[1]:
                self.checkpoints.write(self._checkpoint(step, jacobian))

    def _checkpoint(self, step: Step[E], jacobian: Linearisation[E]) -> Checkpoint:
        """Checkpoint at the end of a step."""
        self.cost.seconds = self.seconds
        return Checkpoint(
            step.t,
            step.x,
            step.following,
            step.error,
            self.warm_starts(step.end),
            jacobian.differences,
            deepcopy(self.cost),
            self.recorder.rows,
        )

    def _accept(self, step: Step[E]) -> None:
        """Records a step. Raises OutOfBounds beyond the limits."""
        self.recorder.add(step)
        self.check(step.t, step.x)
        if self.progress is not None:
            t0, t1 = self.span
            distance = self.dynamics.speed_profile(step.t).distance
            self.progress((step.t - t0) / (t1 - t0), _figures(step.t, step.t - step.t0, distance, self.cost))


def _figures(time: float, step: float, distance: float, cost: RunCost) -> dict[str, float]:
    return {
        "time": time,
        "distance": distance,
        "step": step,
        "steps": cost.steps.accepted,
        "rejected": cost.steps.rejected,
        "failed": cost.steps.failed,
        "solves": sum(side.solves for side in cost.contact.values()),
        "newton": sum(side.newton for side in cost.contact.values()),
    }
