"""Time simulation of a wagon on a track."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wheelrail.contact.element.contact_element import ElementState
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.contact_differences import ContactDifferences
from wheelrail.vehicle.dynamics.equations import Dynamics, Evaluation
from wheelrail.vehicle.dynamics.jacobian import Jacobian
from wheelrail.vehicle.dynamics.state import COUNT, graded
from wheelrail.vehicle.dynamics.structure_motions import with_motions_at_rates
from wheelrail.vehicle.integration.integrate import METHODS, Step, StepSettings
from wheelrail.vehicle.integration.rosenbrock import RosenbrockCoefficients
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, WarmStarts
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.limits import LIMITS, Limits, describe_position
from wheelrail.vehicle.simulation.recorder import Recorder
from wheelrail.vehicle.simulation.row import Row, without_contacts
from wheelrail.vehicle.simulation.time_run import Progress, Recording, TimeRun
from wheelrail.vehicle.steady.equilibrium import equilibrium


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
    if initial is not None and np.shape(initial) != (dynamics.size,):
        raise ValueError(f"initial: shape {np.shape(initial)}: must be ({dynamics.size},), the state of this wagon")
    steps = steps or StepSettings()
    velocities = 0 if dynamics.structure is None else dynamics.structure.velocities
    atol, longest = tolerances(steps.method, steps.atol, dynamics.size, velocities), longest_step(dynamics)
    steps = replace(steps, atol=atol, max_step=min(steps.max_step, longest))
    run = _WagonRun(dynamics, span, steps, recording or Recording(), limits, progress)
    status = run.run(None if initial is None else np.array(initial, dtype=float))
    return History.of(run.dynamics, run.recorder.rows, run.cost, status)


class _WagonRun(TimeRun[Dynamics, Evaluation]):
    """A run of the plane wagon; limits: bounds beyond which it ends."""

    def __init__(
        self,
        dynamics: Dynamics,
        span: tuple[float, float],
        steps: StepSettings,
        recording: Recording,
        limits: Limits,
        progress: Progress | None,
    ) -> None:
        super().__init__(dynamics, span, steps, recording, progress)
        self.limits = limits

    def recorder_of(self, interval: float | None) -> Recorder[Evaluation, Row]:
        def row_of(time: float, state: Array, at: Evaluation) -> Row:
            return Row.of(self.dynamics, time, state, at)

        return Recorder(self.between, row_of, without_contacts, interval)

    def equilibrium(self, time: float) -> Array:
        return equilibrium(self.dynamics, time=time).state

    def evaluate(self, dynamics: Dynamics, at: Checkpoint) -> Evaluation:
        assert at.guess is None or isinstance(at.guess, ElementState)
        return dynamics(at.time, at.state, guess=None if at.guess is None else dynamics.element.guesses(at.guess))

    def right_hand_side(self, time: float, state: Array, previous: Evaluation | None) -> Evaluation:
        return self.dynamics(time, state, previous)

    def between(self, step: Step[Evaluation], time: float, state: Array) -> tuple[Array, Evaluation]:
        """As for any run; motions of axle and rails are those with their mean rates over the step."""
        if self.dynamics.structure is None:
            return super().between(step, time, state)
        rates = self.dynamics.split(step.x - step.x0).motions / (step.t - step.t0)
        return with_motions_at_rates(self.dynamics, time, state, rates, step.end)

    def linearisation(self, differences: ContactDifferences | None) -> Jacobian:
        return Jacobian(self.dynamics, self.cost.steps, differences=differences)

    def warm_starts(self, evaluation: Evaluation) -> WarmStarts | None:
        return None if evaluation.guess is None else self.dynamics.element.state_of(evaluation.guess)

    def check(self, time: float, state: Array) -> None:
        self.limits.check(self.dynamics, time, state)

    def describe(self, time: float, state: Array) -> str:
        return describe_position(self.dynamics, time, state)


def longest_step(dynamics: Dynamics) -> float:
    """Longest step s: a third of the time from sleeper to sleeper, where these are discrete."""
    if dynamics.structure is None:
        return np.inf
    return dynamics.structure.period / (3.0 * max(dynamics.speed_profile.speeds.values))


def tolerances(method: str, atol: float | Array, size: int = 2 * COUNT, velocities: int = 0) -> float | Array:
    """Absolute tolerance of each component of the state.

    Parameters:
        method: name of the integration method.
        atol: an array is returned unchanged; a number is that of positions and deflections, m and rad. Explicit
            methods, limited by stability, use it for rates, too; for implicit ones see
            `wheelrail.vehicle.dynamics.state.graded`.
        size: of the state.
        velocities: number of rates at its end.
    """
    if isinstance(atol, float | int) and isinstance(METHODS[method], RosenbrockCoefficients):
        return graded(atol, size, velocities)
    return atol
