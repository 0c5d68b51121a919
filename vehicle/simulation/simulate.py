"""Time simulation of a vehicle on a track."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings
from wheelrail.vehicle.integration.rosenbrock import ROSENBROCK, RosenbrockPair
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.simulation.limits import LIMITS, Limits
from wheelrail.vehicle.simulation.time_run import Progress, Recording, TimeRun

FORCE_SCALE = 10.0  # tolerance of forces, in static wheel loads, over the relative one of the state
GRAVITY = 9.81  # m/s2, of these loads, for models without weight, too
IMPLICIT = StepSettings(ROSENBROCK.name, 3e-3, 3e-5)


def simulate(
    dynamics: VehicleDynamics,
    span: tuple[float, float] = (0.0, 10.0),
    *,
    initial: Array | None = None,
    steps: StepSettings | None = None,
    recording: Recording | None = None,
    limits: Limits = LIMITS,
    progress: Progress | None = None,
    until: float = np.inf,
) -> History:
    """Motion of a vehicle over a time span; the distance is zero at time zero.

    Parameters:
        dynamics: equations of motion.
        span: start and end, s.
        initial: (2 c + m + k,) state (see `wheelrail.vehicle.multibody.coordinates`); None: the equilibrium at the
            speed, curvature, cant, torques and forces at the start, see `start_state`.
        steps: None: `IMPLICIT`. "ode23" and "ode45" are explicit and resolve the contact's 150 Hz and, where yaw is
            free, the fast decay of creep; "rosenbrock" is linearly implicit and uses the contact's tangent if it has
            one, "rosenbrock_ends" alike with contacts solved once a step, and so is "rosenbrock4", of higher order for
            sustained oscillations. Tolerances are best not too
            small: smaller ones make steps resolve the wheelsets' vibration on the contacts at 50 to 250 Hz, which is
            hardly damped. atol: see `step_settings`.
        recording: rows and checkpoints. With a latest checkpoint the run resumes from it; all other arguments must
            be those of the interrupted run.
        limits: bounds beyond which the run ends.
        progress: called at each accepted step with the completed fraction and statistics.
        until: distance m at which the run is complete, with the step that reaches it; see `History.distance`.

    A vehicle that runs free and has slowed down to 0.1 m/s has stopped, and the run is complete. Steps end at the kinks
    of torques and forces over time and resolve what else is prescribed, see `Excitation`. The initial guess of a
    contact solve is the previous result, at the start of a step that of the latest accepted state. A failed solve
    shortens the step. If the smallest step fails, beyond the limits, or on Ctrl-C, the history ends there; its status
    names the reason. Raises ValueError for invalid input.
    """
    if initial is not None and np.shape(initial) != (dynamics.size,):
        raise ValueError(f"initial: shape {np.shape(initial)}: must be ({dynamics.size},), the state of this vehicle")
    settings = step_settings(dynamics, steps or IMPLICIT)
    run = TimeRun(dynamics, span, settings, recording or Recording(), limits, progress, until)
    status = run.run(None if initial is None else np.array(initial, dtype=float))
    return History(dynamics, status, run.recorder.rows, run.cost)


def step_settings(dynamics: VehicleDynamics, steps: StepSettings) -> StepSettings:
    """Settings with the absolute tolerance of each component of the state.

    Parameters:
        dynamics: equations of motion.
        steps: settings, of which atol, if it is a number, is that of positions and deflections, m and rad. Explicit
            methods, limited by stability, use it for rates, too; for implicit ones see `VehicleDynamics.tolerances`,
            forces of wheels have a tolerance of 10 rtol times the mean static load, and displacements from the
            reference motion have no relative one where they are not small.
    """
    atol, rtol, output_tolerance = steps.atol, steps.rtol, steps.output_tolerance
    if isinstance(atol, float | int) and isinstance(steps.tableau, RosenbrockPair):
        atol = dynamics.tolerances(atol)
        if dynamics.drifts:
            rtol = np.where(dynamics.drifting, 0.0, rtol)
        masses, wheels = dynamics.mass.sum(), len(SIDES) * len(dynamics.vehicle.wheelsets)
        output_tolerance = float(FORCE_SCALE * np.max(steps.rtol) * GRAVITY * masses / wheels) or np.inf
    return replace(steps, rtol=rtol, atol=atol, output_tolerance=output_tolerance)
