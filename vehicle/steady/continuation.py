"""Initial guess for steady curving: a transient run from straight track into the curve."""

from __future__ import annotations

from dataclasses import replace

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.rosenbrock import ROSENBROCK
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import VehicleDynamics
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.track.piecewise import PiecewiseFunction

RAMP, DECAY = 3.0, 6.0  # s: transition into the curve; then until the slowest sway has decayed to 1 %
TOLERANCE = 3e-3
MOST_STEPS = 2000  # a transient takes some hundred; one that needs more does not come to rest


def is_curved(dynamics: VehicleDynamics, time: float) -> bool:
    """Whether the track at a time s is not straight and level."""
    line, s = dynamics.track, dynamics.speed_profile(time).distance
    return any(function(s)[0] != 0.0 for function in line.functions)


def transient_into_curve(dynamics: VehicleDynamics, time: float, start: Array) -> Array:
    """State (2 c + m + k,) at the end of a run at constant speed from straight level track into a curve.

    Parameters:
        dynamics: equations of motion.
        time: s, at which the speed, curvature, cant and gradient are taken.
        start: (2 c + m + k,) initial state on straight level track.

    Raises StepFailure, also after `MOST_STEPS`, and StepTooSmall.
    """
    line, (s, speed, *_) = dynamics.track, dynamics.speed_profile(time)
    ends = (0.0, RAMP * speed)
    into = line.changed(s, lambda function: PiecewiseFunction(ends, (0.0, function(s)[0])))
    transient = replace(dynamics, track=into, speed=speed)
    atol, longest = transient.tolerances(1e-3 * TOLERANCE), RAMP / 4  # which meets the transition
    state, settings = start, StepSettings(ROSENBROCK.name, TOLERANCE, atol, max_step=longest)
    jacobian = VehicleJacobian(transient, StepStatistics())
    steps = integrate(transient, 0.0, start, RAMP + DECAY, settings, jacobian=jacobian, settle=transient.settle)
    for number, step in enumerate(steps):
        if number == MOST_STEPS:
            raise StepFailure(
                f"the transient into the curve is at {step.t:.2f} of {RAMP + DECAY:g} s after {number} steps"
            )
        state = step.x
    return state
