"""Time simulation of a wagon on a track."""

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
from wheelrail.vehicle.simulation.limits import LIMITS, Limits, OutOfBounds, describe_position
from wheelrail.vehicle.simulation.recorder import Recorder
from wheelrail.vehicle.steady.equilibrium import EquilibriumError, equilibrium

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
    """Motion of the wagon over a time span; the distance is zero at time zero.

    Parameters:
        dynamics: equations of motion.
        span: start and end, s.
        initial: (20 + m + k,) state (see `wheelrail.vehicle.dynamics.state`); None: the equilibrium at the start.
        steps: "ode23" and "ode45" are explicit and resolve the contact's 150 Hz; "rosenbrock" is linearly implicit and
            uses the contact's tangent if it has one; atol: see `tolerances`.
        recording: rows and checkpoints. With a latest checkpoint the run resumes from it; all other arguments must
            be those of the interrupted run.
        limits: bounds beyond which the run ends.
        progress: called at each accepted step with the completed fraction and statistics.

    The initial guess of a contact solve is the previous result, at the start of a step that of the latest accepted
    state. A failed solve shortens the step. If the smallest step fails, beyond the limits, or on Ctrl-C, the history
    ends there; its status names the reason. Raises ValueError for invalid input.
    """
    simulation = _Simulation(dynamics, span, steps or StepSettings(), recording or Recording(), limits, progress)
    if initial is not None and np.shape(initial) != (dynamics.size,):
        raise ValueError(f"initial: shape {np.shape(initial)}: must be ({dynamics.size},), the state of this wagon")
    status = simulation.run(initial)
    simulation.cost.seconds = simulation.seconds
    return History.of(simulation.recorder, simulation.cost, status)


class _Simulation:
    """A run in progress, resumed from the latest checkpoint if there is one: its cost and recorded rows."""

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
        if self.latest is not None and self.latest.state.shape != (dynamics.size,):
            raise ValueError(f"checkpoint: a state of shape {self.latest.state.shape}: must be ({dynamics.size},)")
        self.cost = (
            deepcopy(self.latest.cost) if self.latest else RunCost(contact={side: ContactCost() for side in SIDES})
        )
        self.dynamics, self.uncounted = (
            replace(dynamics, contact=CountedContact(dynamics.contact, self.cost.contact)),
            dynamics,
        )
        self.steps = replace(steps, atol=tolerances(steps.method, steps.atol, dynamics.size))
        self.recorder = Recorder(self.dynamics, recording.interval, list(self.latest.rows) if self.latest else [])
        self.began = perf_counter() - self.cost.seconds

    @property
    def seconds(self) -> float:
        """Wall time s, including that before the checkpoint."""
        return perf_counter() - self.began

    def run(self, initial: Array | None) -> str:
        """Integrates over the span; returns the status of the history."""
        try:
            with deferred_interrupts():
                self.integrate(self.latest or self.start(initial))
        except KeyboardInterrupt:
            return "interrupted"
        except StepTooSmall as error:
            (last,) = self.recorder.latest
            return f"failed: {error}; {describe_position(self.dynamics, last.time, last.state)}"
        except (StepFailure, EquilibriumError, OutOfBounds) as error:
            return f"failed: {error}"
        return "completed"

    def start(self, initial: Array | None) -> Checkpoint:
        """Start of the run: the initial state, by default the equilibrium."""
        time = self.span[0]
        state = equilibrium(self.dynamics, time=time).state if initial is None else np.array(initial, dtype=float)
        return Checkpoint(time, state, None, 1.0, None, None, self.cost, self.recorder.rows)

    def integrate(self, at: Checkpoint) -> None:
        """Integrates from a checkpoint to the end of the span."""
        first = self.evaluation(at)
        jacobian = Jacobian(self.dynamics, self.cost.steps, differences=at.differences)
        self.recorder.begin(at.time, at.state, first)
        if self.checkpoints is not None and at is not self.latest:
            self.checkpoints.write(replace(at, cost=deepcopy(self.cost), rows=self.recorder.rows))
        steps = integrate(
            self.dynamics,
            at.time,
            at.state,
            self.span[1],
            self.steps,
            jacobian=jacobian,
            first=FirstStep(first, at.step, at.error),
            counts=self.cost.steps,
        )
        for count, step in enumerate(steps, start=1):
            self.accept(step)
            if self.checkpoints is not None and count % self.checkpoints.every == 0 and step.t < self.span[1]:
                self.checkpoints.write(self.checkpoint(step, jacobian))

    def evaluation(self, at: Checkpoint) -> Evaluation:
        """Evaluation at a checkpoint, which counts once, also when it is repeated for a resumed run."""
        dynamics = self.uncounted if at is self.latest else self.dynamics
        return dynamics(at.time, at.state, guess=None if at.guess is None else dynamics.element.guesses(at.guess))

    def checkpoint(self, step: Step[Evaluation], jacobian: Jacobian) -> Checkpoint:
        """Checkpoint at the end of a step."""
        self.cost.seconds = self.seconds
        guess = None if step.end.guess is None else self.dynamics.element.state_of(step.end.guess)
        return Checkpoint(
            step.t,
            step.x,
            step.following,
            step.error,
            guess,
            jacobian.differences,
            deepcopy(self.cost),
            self.recorder.rows,
        )

    def accept(self, step: Step[Evaluation]) -> None:
        """Records a step. Raises OutOfBounds beyond the limits."""
        self.recorder.add(step)
        self.limits.check(self.dynamics, step.t, step.x)
        if self.progress is not None:
            t0, t1 = self.span
            distance = self.dynamics.speed_profile(step.t).distance
            self.progress((step.t - t0) / (t1 - t0), _figures(step.t, step.t - step.t0, distance, self.cost))


def tolerances(method: str, atol: float | Array, size: int = 2 * COUNT) -> float | Array:
    """Absolute tolerance of each component of the state.

    Parameters:
        method: name of the integration method.
        atol: an array is returned unchanged; a number is that of positions and deflections, m and rad. Explicit
            methods, limited by stability, use it for rates, too; for implicit ones see
            `wheelrail.vehicle.dynamics.state.graded`.
        size: of the state.
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
