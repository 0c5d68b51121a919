"""A way into a curve for those who look for the steady position there: the run that ends in it."""

from __future__ import annotations

from dataclasses import replace

from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics
from wheelrail.vehicle.dynamics.jacobian import Jacobian
from wheelrail.vehicle.dynamics.state import graded
from wheelrail.vehicle.integration.integrate import StepSettings, integrate
from wheelrail.vehicle.integration.rosenbrock import ROS34PW2
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track

RAMP, REST = 3.0, 6.0  # s, until the curve is reached and until the slowest sway has faded by a hundred
TOLERANCE = 3e-3


def bends(dynamics: Dynamics, time: float) -> bool:
    """Whether the track at a time s is not straight and level."""
    line, s = dynamics.track, dynamics.drive(time).distance
    return any(course(s)[0] != 0.0 for course in (line.curvature, line.lift, line.gradient))


def run_in(dynamics: Dynamics, time: float, start: Array) -> Array:
    """State at the end of a run at the speed of a time s, from a state on straight level track into the curvature,
    cant and gradient there.

    Raises StepFailure and StepTooSmall.
    """
    line, (s, speed, _) = dynamics.track, dynamics.drive(time)
    ends = (0.0, RAMP * speed)
    curvature, lift, gradient = (
        PiecewiseFunction(ends, (0.0, of(s)[0])) for of in (line.curvature, line.lift, line.gradient)
    )
    way = replace(dynamics, track=Track(curvature, lift, gradient, line.base), speed=speed)
    state, settings = start, StepSettings(ROS34PW2.name, TOLERANCE, graded(1e-3 * TOLERANCE, way.size))
    for step in integrate(way, 0.0, start, RAMP + REST, settings, jacobian=Jacobian(way, StepStatistics())):
        state = step.x
    return state
