"""A run in time: integration over a span with recording, checkpoints, and limits."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from math import inf
from time import perf_counter

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import deferred_interrupts
from wheelrail.vehicle.integration.integrate import FirstStep, Step, StepSettings, StepTooSmall, integrate
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation, WheelContacts
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints, WarmStarts
from wheelrail.vehicle.simulation.contact_cost import ContactCost, CountedContact
from wheelrail.vehicle.simulation.contacts_at_end import ContactsAtEnd
from wheelrail.vehicle.simulation.excitation import Excitation
from wheelrail.vehicle.simulation.history import RunCost
from wheelrail.vehicle.simulation.limits import SLOWEST, Limits, OutOfBounds, describe_position
from wheelrail.vehicle.simulation.rail_following import rail_following
from wheelrail.vehicle.simulation.recorder import Observer, Recorder
from wheelrail.vehicle.steady.equilibrium import EquilibriumError
from wheelrail.vehicle.steady.start_state import start_state

Progress = Callable[[float, Mapping[str, float]], None]

SETTLED = 1e-8  # m and rad, of motions that follow constant loads: 10 N on a contact
MOST_NEWTON = 8  # Newton steps; 2 suffice from states within a step of the integration


@dataclass(frozen=True)
class Recording:
    """Recording of a run.

    Parameters:
        interval: between rows, s; None: rows at accepted steps.
        checkpoints: spacing, receiver and start; None: no checkpoints.
        observer: called with the time s, state and evaluation of every row, for what rows do not keep; not with those
            before a checkpoint.

    Raises ValueError for an interval that is not positive.
    """

    interval: float | None = None
    checkpoints: Checkpoints | None = None
    observer: Observer | None = None

    def __post_init__(self) -> None:
        if self.interval is not None and not self.interval > 0.0:
            raise ValueError(f"interval = {self.interval} s: must be positive, or None for all accepted steps")


class TimeRun:
    """A run in progress, resumed from the latest checkpoint if there is one: its cost and recorded rows.

    Parameters:
        dynamics: equations of motion.
        span: start and end, s.
        steps: method, tolerances and bounds of the steps.
        recording: rows and checkpoints.
        limits: bounds beyond which the run ends.
        progress: called at each accepted step with the completed fraction and statistics.
        until: distance m at which the run is complete.

    A vehicle that runs free and slows down to `SLOWEST` has stopped: the run is complete, too. Raises OtherVehicle, a
    ValueError, for a checkpoint of another one.
    """

    def __init__(
        self,
        dynamics: VehicleDynamics,
        span: tuple[float, float],
        steps: StepSettings,
        recording: Recording,
        limits: Limits,
        progress: Progress | None,
        until: float,
    ) -> None:
        self.limits, self.until = limits, until
        self.span, self.steps, self.progress, self.checkpoints = span, steps, progress, recording.checkpoints
        self.latest = self.checkpoints.latest if self.checkpoints else None
        if self.latest is not None:
            self.latest.require_fit(dynamics)
        self.cost = (
            deepcopy(self.latest.cost) if self.latest else RunCost(contact={side: ContactCost() for side in SIDES})
        )
        self.uncounted = dynamics
        self.dynamics = replace(dynamics, contact=CountedContact(dynamics.contact, self.cost.contact))
        self.recorder = Recorder(self.between, dynamics.contact.each, recording.interval, recording.observer)
        self.recorder.rows = list(self.latest.rows) if self.latest else []
        self.began = perf_counter() - self.cost.seconds

    def between(self, step: Step[VehicleEvaluation], time: float, state: Array) -> tuple[Array, VehicleEvaluation]:
        """State and evaluation at a time s within a step, from the state of its dense output. Raises StepFailure.

        Sliders are those of a step that ends there. Contacts start from those at the nearer end of the step. Motions of
        axles and rails are those with their mean rates over the step.
        """
        if self.dynamics.settle is not None:
            state, _ = self.dynamics.settle(step.t0, step.x0, time, state)
        near = step.start if time - step.t0 < step.t - time else step.end
        if not self.dynamics.structures.elastic:
            return state, self.dynamics(time, state, near)
        rates = (step.x - step.x0)[self.dynamics.coordinates.size :] / (step.t - step.t0)
        return with_motions_at_rates(self.dynamics, time, state, rates, near)

    def _first(self, at: Checkpoint) -> VehicleEvaluation:
        """Evaluation at a checkpoint, from its guess; it counts once, also when it is repeated for a resumed run."""
        dynamics = self.uncounted if at is self.latest else self.dynamics
        place, guess = (at.state, at.guess) if at.solved is None else at.solved
        guesses = None if guess is None else {n: dynamics.element.guesses(sides) for n, sides in guess.items()}
        there = dynamics(at.time, place, guess=guesses)
        return there if at.solved is None else ContactsAtEnd.of(dynamics, place, there)(at.time, at.state, there)

    def _warm_starts(self, guess: WheelContacts | None) -> WarmStarts | None:
        """Warm starts of contact solves, as plain data."""
        return None if guess is None else {n: self.dynamics.element.state_of(sides) for n, sides in guess.items()}

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
            return f"failed: {error}; {describe_position(self.dynamics, *self.recorder.latest)}"
        except (StepFailure, EquilibriumError, OutOfBounds) as error:
            return f"failed: {error}"
        finally:
            self.cost.seconds = self.seconds
        return "completed"

    def _start(self, initial: Array | None) -> Checkpoint:
        time = self.span[0]
        state = start_state(self.dynamics, time) if initial is None else initial.astype(float)
        return Checkpoint(time, state, None, 1.0, None, None, None, None, self.cost, self.recorder.rows)

    def _integrate(self, at: Checkpoint) -> None:
        """Integrates from a checkpoint to the end of the span."""
        first = self._first(at)
        jacobian = VehicleJacobian(self.dynamics, self.cost.steps, differences=at.differences)
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
            first=FirstStep(first, at.step, at.error, at.before),
            counts=self.cost.steps,
            follow=rail_following(self.dynamics),
            next_end=self._next_end if self.dynamics.drifts else None,
            longest=Excitation(self.dynamics, float(np.min(self.steps.atol)), self.steps.output_tolerance).longest_step,
            settle=self.dynamics.settle,
            ends=ContactsAtEnd.at_start(self.dynamics),
        )
        for count, step in enumerate(steps, start=1):
            if self._accept(step):
                return
            if self.checkpoints is not None and count % self.checkpoints.every == 0 and step.t < self.span[1]:
                self.checkpoints.write(self._checkpoint(step, jacobian))

    def _next_end(self, time: float) -> float:
        """Next time s at which a step must end: at a kink of torques and forces, and at a row of a free-running
        vehicle. At low speed its steps are long, and the errors of rates interpolated within them dominate its creep
        forces.
        """
        kinks = self.dynamics.loads.kinks
        after = kinks[i] if (i := bisect_right(kinks, time)) < len(kinks) else inf
        return min(after, self.recorder.next_row(time)) if self.dynamics.runs_free else after

    def _checkpoint(self, step: Step[VehicleEvaluation], jacobian: VehicleJacobian) -> Checkpoint:
        """Checkpoint at the end of a step."""
        self.cost.seconds, solved = self.seconds, step.end.solved
        return Checkpoint(
            step.t,
            step.x,
            step.following,
            step.error,
            (step.t0, step.x0),
            self._warm_starts(step.end.guess),
            None if solved is None else (solved[0], self._warm_starts(solved[1])),
            jacobian.differences,
            deepcopy(self.cost),
            self.recorder.rows,
        )

    def _accept(self, step: Step[VehicleEvaluation]) -> bool:
        """Records a step; whether the vehicle has arrived or stopped. Raises OutOfBounds beyond the limits."""
        self.recorder.add(step)
        self.limits.check(self.dynamics, step.t, step.x, step.end.states)
        distance, speed = self.dynamics.progress(step.t, step.x)
        if self.progress is not None:
            t0, t1 = self.span
            done = max((step.t - t0) / (t1 - t0), distance / self.until)
            self.progress(done, _figures(step.t, step.t - step.t0, distance, self.cost))
        return distance >= self.until or (self.dynamics.runs_free and speed < SLOWEST)


def with_motions_at_rates(
    dynamics: VehicleDynamics, time: float, state: Array, rates: Array, previous: VehicleEvaluation
) -> tuple[Array, VehicleEvaluation]:
    """State whose motions of axle and rails have given rates under the loads of the contacts, and its evaluation.

    Interpolated motions are not accurate enough: wheel and rail both move, and an error of 10 um between them is one of
    10 kN. Rates are.
    Parameters:
        dynamics: equations of motion, with elastic axles or rails.
        time: s.
        state: (2 c + m + k,), of which the last k are a first approximation.
        rates: (k,) m/s and rad/s.
        previous: evaluation nearby, whose contacts are the initial guess.

    Raises StepFailure when a contact solve fails, and without convergence.
    """
    distances = dynamics.distances(dynamics.speed_profile(time), state)
    state, first, jacobian = state.copy(), dynamics.coordinates.size, VehicleJacobian(dynamics, StepStatistics())
    for _ in range(MOST_NEWTON):
        evaluation = dynamics(time, state, previous)
        error = evaluation.rate[first:] - rates
        if np.abs(dynamics.structures.static(error, distances)).max() <= SETTLED:
            return state, evaluation
        slopes = jacobian(time, state, evaluation).by_state[first:, first:]
        state[first:] -= np.linalg.solve(slopes, error)
        previous = evaluation
    raise StepFailure(f"motions of axle and rails do not settle in {MOST_NEWTON} Newton steps")


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
