"""Runs a wagon over a track on a contact model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import deferred_interrupts
from wheelrail.vehicle.dynamics.equations import Dynamics, Evaluation
from wheelrail.vehicle.dynamics.jacobian import Jacobian
from wheelrail.vehicle.dynamics.state import COUNT, graded
from wheelrail.vehicle.integration.integrate import METHODS, FirstStep, Step, StepSettings, StepTooSmall, integrate
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.rosenbrock import RosenbrockCoefficients
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.contact_cost import ContactCost, CountedContact
from wheelrail.vehicle.simulation.history import History, RunCost
from wheelrail.vehicle.simulation.limits import LIMITS, Limits, OutOfBounds, whereabouts
from wheelrail.vehicle.simulation.recorder import Recorder
from wheelrail.vehicle.steady.equilibrium import EquilibriumError, equilibrium

Progress = Callable[[float, Mapping[str, float]], None]


@dataclass(frozen=True)
class Recording:
    """What is recorded of a run: rows every interval s (None: at accepted steps), and checkpoints, if any.

    Raises ValueError for an interval that is not positive.
    """

    interval: float | None = None
    checkpoints: Checkpoints | None = None

    def __post_init__(self) -> None:
        if self.interval is not None and not self.interval > 0.0:
            raise ValueError(f"interval = {self.interval} s: positive, or None for all accepted steps")


def simulate(
    dynamics: Dynamics,
    span: tuple[float, float] = (0.0, 10.0),
    *,
    initial: Array | None = None,
    steps: StepSettings | None = None,
    recording: Recording | None = None,
    limits: Limits = LIMITS,
    progress: Progress | None = None,
) -> History:
    """Motion of the wagon over the times span s; distance is zero at time zero.

    initial: a state (see `wheelrail.vehicle.dynamics.state`), else the equilibrium at the start. steps: "ode23" and
    "ode45" are explicit and follow the contact's 150 Hz; "rosenbrock" is linearly implicit and uses the contact's
    tangent where there is one; atol: see `tolerances`. Each contact solve starts from the result before, the first of a
    step from the latest accepted one. A solve that fails makes the step shorter; when the smallest step does not help
    either, beyond the limits, or on Ctrl-C, the history ends there and its status tells. progress gets the share done
    and figures at each accepted step. With checkpoints the run goes on from the latest one; all else given must be the
    same. Raises ValueError for senseless input.
    """
    simulation = _Simulation(dynamics, span, steps or StepSettings(), recording or Recording(), limits, progress)
    if initial is not None and np.shape(initial) != (dynamics.size,):
        raise ValueError(f"initial: shape {np.shape(initial)}: a state of this wagon has {dynamics.size} numbers")
    status = simulation.run(initial)
    simulation.cost.seconds = simulation.seconds
    return History.of(simulation.recorder, simulation.cost, status)


class _Simulation:
    """A run in progress: its cost and records, on from the latest checkpoint if there is one."""

    def __init__(
        self,
        dynamics: Dynamics,
        span: tuple[float, float],
        steps: StepSettings,
        recording: Recording,
        limits: Limits,
        progress: Progress | None,
    ) -> None:
        self.span, self.limits, self.progress, self.checkpoints = span, limits, progress, recording.checkpoints
        self.latest = self.checkpoints.latest if self.checkpoints else None
        self.cost = (
            deepcopy(self.latest.cost) if self.latest else RunCost(contact={side: ContactCost() for side in SIDES})
        )
        self.dynamics = replace(dynamics, contact=CountedContact(dynamics.contact, self.cost.contact))
        self.steps = replace(steps, atol=tolerances(steps.method, steps.atol, dynamics.size))
        self.recorder = Recorder(self.dynamics, recording.interval, list(self.latest.rows) if self.latest else [])
        self.began = perf_counter() - self.cost.seconds

    @property
    def seconds(self) -> float:
        """Wall time s since the start, with that of the run before a checkpoint."""
        return perf_counter() - self.began

    def run(self, initial: Array | None) -> str:
        """Runs through the span; returns the status of the history."""
        try:
            with deferred_interrupts():
                self.integrate(self.latest or self.start(initial))
        except KeyboardInterrupt:
            return "interrupted"
        except StepTooSmall as error:
            (last,) = self.recorder.latest
            return f"failed: {error}; {whereabouts(self.dynamics, last.time, last.state)}"
        except (StepFailure, EquilibriumError, OutOfBounds) as error:
            return f"failed: {error}"
        return "completed"

    def start(self, initial: Array | None) -> Checkpoint:
        """At the initial state given, else in equilibrium."""
        time = self.span[0]
        state = equilibrium(self.dynamics, time=time).state if initial is None else np.array(initial, dtype=float)
        return self.checkpoint(time, state, None, 1.0)

    def checkpoint(self, time: float, state: Array, step: float | None, error: float) -> Checkpoint:
        self.cost.seconds = self.seconds
        return Checkpoint(time, state, step, error, deepcopy(self.cost), self.recorder.rows)

    def integrate(self, at: Checkpoint) -> None:
        """From checkpoint to checkpoint to the end of the span; from each, contacts are solved without a guess."""
        following: tuple[Checkpoint, Evaluation] | None = at, self.dynamics(at.time, at.state)
        while following is not None:
            at, evaluation = following
            self.recorder.begin(at.time, at.state, evaluation)
            if self.checkpoints is not None:
                self.checkpoints.keep(at)
            following = self.leg(at, evaluation)

    def leg(self, at: Checkpoint, evaluation: Evaluation) -> tuple[Checkpoint, Evaluation] | None:
        """Steps to the next checkpoint, with the evaluation there; None at the end of the span."""
        steps = integrate(
            self.dynamics,
            at.time,
            at.state,
            self.span[1],
            self.steps,
            jacobian=Jacobian(self.dynamics, self.cost.steps),
            first=FirstStep(evaluation, at.step, at.error),
            counts=self.cost.steps,
        )
        for done, step in enumerate(steps, start=1):
            self.accept(step)
            if self.checkpoints is not None and done >= self.checkpoints.every and step.t < self.span[1]:
                at = self.checkpoint(step.t, step.x, step.following, step.error)
                try:
                    return at, self.dynamics(at.time, at.state)
                except StepFailure:  # the contacts cannot be solved without a guess here
                    continue
        return None

    def accept(self, step: Step[Evaluation]) -> None:
        """Records a step. Raises OutOfBounds beyond the limits."""
        self.recorder.add(step)
        self.limits.check(self.dynamics, step.t, step.x)
        if self.progress is not None:
            t0, t1 = self.span
            distance = self.dynamics.drive(step.t).distance
            self.progress((step.t - t0) / (t1 - t0), _figures(step.t, step.t - step.t0, distance, self.cost))


def tolerances(method: str, atol: float | Array, size: int = 2 * COUNT) -> float | Array:
    """Absolute tolerance of each component: an array as it is, a number for positions and deflections in m and rad.

    Explicit steps take the same number for the rates, as they are bound by stability anyway; for implicit ones see
    `wheelrail.vehicle.dynamics.state.graded`.
    """
    if isinstance(atol, float | int) and isinstance(METHODS[method], RosenbrockCoefficients):
        return graded(atol, size)
    return atol


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
