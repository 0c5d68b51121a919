"""Time simulation of a vehicle on a track."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.contact_differences import ContactDifferences
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.rosenbrock import ROS34PW2
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation
from wheelrail.vehicle.multibody.equilibrium import vehicle_equilibrium
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.multibody.runs.history import VehicleHistory, VehicleRow, without_contacts
from wheelrail.vehicle.multibody.runs.limits import check_limits, describe_wheelsets
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, WarmStarts
from wheelrail.vehicle.simulation.recorder import Recorder
from wheelrail.vehicle.simulation.time_run import Progress, Recording, TimeRun


def simulate_vehicle(
    dynamics: VehicleDynamics,
    span: tuple[float, float] = (0.0, 10.0),
    *,
    initial: Array | None = None,
    rtol: float = 3e-3,
    atol: float = 3e-5,
    recording: Recording | None = None,
    progress: Progress | None = None,
) -> VehicleHistory:
    """Motion of a vehicle over a time span by a Rosenbrock-W method; the distance is zero at time zero.

    Parameters:
        dynamics: equations of motion.
        span: start and end, s.
        initial: (2 c + m,) state; None: the equilibrium at the speed, curvature and cant at time zero.
        rtol, atol: tolerances of the error of a step; atol in m and rad, 100 atol in m/s and rad/s. Smaller ones make
            the steps resolve the wheelsets' vibration on the contacts at 50 to 250 Hz, which is hardly damped.
        recording: rows and checkpoints. With a latest checkpoint the run resumes from it; all other arguments must
            be those of the interrupted run.
        progress: called at each accepted step with the completed fraction and statistics.

    The initial guess of a contact solve is the previous result, at the start of a step that of the latest accepted
    state. A failed solve shortens the step. If the smallest step fails, a body rolls or yaws by more than 0.3 rad, a
    wheelset leaves the rails, or on Ctrl-C, the history ends there; its status names the reason. Raises ValueError for
    invalid input.
    """
    if initial is not None and np.shape(initial) != (dynamics.size,):
        raise ValueError(f"initial: shape {np.shape(initial)}: must be ({dynamics.size},), the state of this vehicle")
    settings = StepSettings(ROS34PW2.name, rtol, dynamics.coordinates.tolerances(atol))
    run = _VehicleRun(dynamics, span, settings, recording or Recording(), progress)
    status = run.run(None if initial is None else np.array(initial, dtype=float))
    return VehicleHistory(dynamics, status, run.recorder.rows, run.cost)


class _VehicleRun(TimeRun[VehicleDynamics, VehicleEvaluation]):
    """A run of a vehicle."""

    def recorder_of(self, interval: float | None) -> Recorder[VehicleEvaluation, VehicleRow]:
        return Recorder(self.between, VehicleRow.of, without_contacts, interval)

    def equilibrium(self, time: float) -> Array:
        return vehicle_equilibrium(replace(self.dynamics, speed=self.dynamics.speed_profile(time).speed)).state

    def evaluate(self, dynamics: VehicleDynamics, at: Checkpoint) -> VehicleEvaluation:
        assert at.guess is None or isinstance(at.guess, Mapping)
        guesses = None if at.guess is None else {n: dynamics.element.guesses(sides) for n, sides in at.guess.items()}
        return dynamics(at.time, at.state, guess=guesses)

    def right_hand_side(self, time: float, state: Array, previous: VehicleEvaluation | None) -> VehicleEvaluation:
        return self.dynamics(time, state, previous)

    def linearisation(self, differences: ContactDifferences | None) -> VehicleJacobian:
        return VehicleJacobian(self.dynamics, self.cost.steps, differences=differences)

    def warm_starts(self, evaluation: VehicleEvaluation) -> WarmStarts | None:
        if evaluation.guess is None:
            return None
        return {name: self.dynamics.element.state_of(sides) for name, sides in evaluation.guess.items()}

    def check(self, time: float, state: Array) -> None:
        check_limits(self.dynamics, time, state)

    def describe(self, time: float, state: Array) -> str:
        return describe_wheelsets(self.dynamics, state)
