"""Runs a wagon over a track on a contact model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy
from time import perf_counter

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.results.vehicle_contact import VehicleContact
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import deferred_interrupts
from wheelrail.vehicle.dynamics.equations import Dynamics, Evaluation
from wheelrail.vehicle.dynamics.jacobian import Jacobian
from wheelrail.vehicle.dynamics.state import COUNT, graded
from wheelrail.vehicle.integration.explicit import METHODS as EXPLICIT
from wheelrail.vehicle.integration.explicit import Tableau
from wheelrail.vehicle.integration.integrate import StepTooSmall, integrate
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.rosenbrock import ROS34PW2, RosenbrockCoefficients
from wheelrail.vehicle.integration.step_control import StepController
from wheelrail.vehicle.simulation.checkpoint import Checkpoint, Checkpoints
from wheelrail.vehicle.simulation.contact_cost import ContactCost, CountedContact
from wheelrail.vehicle.simulation.history import History, RunCost
from wheelrail.vehicle.simulation.limits import LIMITS, Limits, OutOfBounds, whereabouts
from wheelrail.vehicle.simulation.recorder import Recorder
from wheelrail.vehicle.steady.equilibrium import EquilibriumError, equilibrium
from wheelrail.vehicle.track.speed_profile import SpeedProfile
from wheelrail.vehicle.track.track import Track
from wheelrail.vehicle.wagon.wagon import Wagon

Progress = Callable[[float, Mapping[str, float]], None]

METHODS: dict[str, Tableau | RosenbrockCoefficients] = {**EXPLICIT, ROS34PW2.name: ROS34PW2}


def simulate(
    wagon: Wagon,
    track: Track,
    contact: VehicleContact,
    *,
    speed: float | SpeedProfile,
    span: tuple[float, float] = (0.0, 10.0),
    method: str = "ode23",
    rtol: float = 1e-3,
    atol: float | Array = 1e-6,
    initial: Array | None = None,
    every: float | None = None,
    max_step: float = np.inf,
    min_step: float = 1e-8,
    control: StepController | None = None,
    limits: Limits = LIMITS,
    progress: Progress | None = None,
    checkpoints: Checkpoints | None = None,
) -> History:
    """Motion of the wagon over the times span s at constant speed m/s or on a drive; distance is zero at time zero.

    method: "ode23" and "ode45" are explicit and follow the contact's 150 Hz; "rosenbrock" is linearly implicit and uses
    the contact's tangent where there is one. atol: see `tolerances`. initial: a state (see
    `wheelrail.vehicle.dynamics.state`), else the equilibrium at the start. Rows at accepted steps, or `every` so many
    seconds. Each contact solve starts from the result before, the first of a step from the latest accepted one. A solve
    that fails makes the step shorter; when min_step s does not help either, beyond the limits, or on Ctrl-C, the
    history ends there and its status tells. progress gets the share done and figures at each accepted step. With
    checkpoints the run goes on from the latest one; all else given must be the same. Raises ValueError for senseless
    input.
    """
    if method not in METHODS:
        raise ValueError(f"method {method!r}: one of {', '.join(METHODS)}")
    if every is not None and not every > 0.0:
        raise ValueError(f"every = {every} s: positive, or None for all accepted steps")
    (t0, t1), status = span, "completed"
    at = checkpoints.latest if checkpoints else None
    cost = deepcopy(at.cost) if at else RunCost(contact={side: ContactCost() for side in SIDES})
    dynamics = Dynamics(wagon, track, CountedContact(contact, cost.contact), speed)
    if initial is not None and np.shape(initial) != (dynamics.size,):
        raise ValueError(f"initial: shape {np.shape(initial)}: a state of this wagon has {dynamics.size} numbers")
    recorder = Recorder(dynamics, every, list(at.rows) if at else [])
    began = perf_counter() - cost.seconds

    def here(time: float, state: Array, step: float | None, error: float) -> Checkpoint:
        cost.seconds = perf_counter() - began
        return Checkpoint(time, state, step, error, deepcopy(cost), recorder.rows)

    try:
        with deferred_interrupts():
            if at is None:
                state = equilibrium(dynamics, time=t0).state if initial is None else np.array(initial, dtype=float)
                at = here(t0, state, None, 1.0)
            start = dynamics(at.time, at.state)
            while True:
                recorder.begin(at.time, at.state, start)
                if checkpoints is not None:
                    checkpoints.keep(at)
                leg = integrate(
                    dynamics,
                    at.time,
                    at.state,
                    t1,
                    tableau=METHODS[method],
                    jacobian=Jacobian(dynamics, cost.steps),
                    rtol=rtol,
                    atol=tolerances(method, atol, dynamics.size),
                    control=control,
                    start=start,
                    first_step=at.step,
                    before=at.error,
                    max_step=max_step,
                    min_step=min_step,
                    counts=cost.steps,
                )
                for done, step in enumerate(leg, start=1):
                    recorder.add(step)
                    limits.check(dynamics, step.t, step.x)
                    if progress is not None:
                        distance = dynamics.drive(step.t).distance
                        progress((step.t - t0) / (t1 - t0), _figures(step.t, step.t - step.t0, distance, cost))
                    if checkpoints is not None and done >= checkpoints.every and step.t < t1:
                        at = here(step.t, step.x, step.following, step.error)
                        if (anew := _anew(dynamics, at)) is not None:
                            start = anew
                            break
                else:
                    break
    except KeyboardInterrupt:
        status = "interrupted"
    except StepTooSmall as error:
        (last,) = recorder.latest
        status = f"failed: {error}; {whereabouts(dynamics, last.time, last.state)}"
    except (StepFailure, EquilibriumError, OutOfBounds) as error:
        status = f"failed: {error}"
    cost.seconds = perf_counter() - began
    return History.of(recorder, cost, status)


def _anew(dynamics: Dynamics, at: Checkpoint) -> Evaluation | None:
    """The evaluation at a checkpoint, from nothing; None where contacts need the results before to be solved."""
    try:
        return dynamics(at.time, at.state)
    except StepFailure:
        return None


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
