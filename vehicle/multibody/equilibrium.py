"""Steady position of a vehicle on straight track or in a curve of constant radius and cant."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import X, Y, Z
from wheelrail.vehicle.multibody.equations import (
    VehicleDynamics,
    VehicleEvaluation,
    WheelContacts,
    wheelset_wrenches,
)
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian
from wheelrail.vehicle.steady.equilibrium import EquilibriumError
from wheelrail.vehicle.track.constant_curve import ConstantCurve
from wheelrail.vehicle.track.track import Track

LARGEST_CHANGE = (1e-2, 2e-2, 2e-2, 1e-2, 2e-3, 1e-2)  # m and rad of x, y, z, roll, pitch, yaw in a Newton step
LARGEST_SPIN = 0.3  # rad/s in a Newton step
LOWEST, STRIDE = -5e-3, 2e-5  # m: search for the height at which the contacts carry the vehicle


@dataclass(frozen=True)
class VehicleEquilibrium:
    """Steady position of a vehicle.

    Parameters:
        dynamics: equations of motion.
        state: (2 c + m,).
        contacts: results by wheelset and side.
        iterations: Newton steps.
        residual: largest unbalanced force over the mean wheel load.
    """

    dynamics: VehicleDynamics
    state: Array
    contacts: WheelContacts
    iterations: int
    residual: float


@dataclass(frozen=True)
class _SteadyProblem:
    """Unbalanced forces over the mean wheel load; unknowns: all coordinates but the angles of rolling, and the spins.

    Parameters:
        dynamics: on a track of constant curvature and cant, at constant speed.
        counts: call statistics.
    """

    dynamics: VehicleDynamics
    counts: StepStatistics = field(default_factory=StepStatistics)

    @cached_property
    def unknowns(self) -> NDArray[np.int64]:
        """Indices (c,) in the state."""
        coordinates = self.dynamics.coordinates
        indices = np.arange(coordinates.count)
        indices[coordinates.rolling_angles] += coordinates.count
        return indices

    @cached_property
    def largest(self) -> Array:
        """(c,) largest change of each unknown in a Newton step."""
        coordinates = self.dynamics.coordinates
        limits = np.tile(LARGEST_CHANGE, len(self.dynamics.vehicle.names))[coordinates.free]
        limits[coordinates.rolling_angles] = LARGEST_SPIN
        return np.asarray(limits)

    @cached_property
    def weights(self) -> Array:
        """(c,) masses and inertias over the mean wheel load; lever arm of moments 1 m."""
        return self.dynamics.coordinates.inertia / self.dynamics.vehicle.mean_wheel_load

    def residual(self, state: Array, contacts: WheelContacts) -> Array:
        accelerations = self.dynamics.accelerations(0.0, state, wheelset_wrenches(contacts)).rates
        return np.asarray(self.weights * accelerations[: self.dynamics.coordinates.count])

    def contacts(self, state: Array) -> WheelContacts:
        return self.dynamics.solve_contacts(0.0, state, None)

    def jacobian(self, state: Array, contacts: WheelContacts) -> Array:
        """(c, c) derivative of the residual by the unknowns."""
        c = self.dynamics.coordinates.count
        linearise = VehicleJacobian(self.dynamics, self.counts)
        matrix = linearise(0.0, state, VehicleEvaluation(np.zeros_like(state), contacts)).by_state
        return np.asarray(self.weights[:, None] * matrix[c : 2 * c, self.unknowns])


def vehicle_equilibrium(
    dynamics: VehicleDynamics,
    *,
    guess: Array | None = None,
    tolerance: float = 1e-7,
    acceptable: float = 1e-4,
    max_iterations: int = 60,
) -> VehicleEquilibrium:
    """State without acceleration at constant speed, curvature, cant and gradient on smooth rails.

    Parameters:
        dynamics: equations of motion; speed and track are those at time zero, and rails are smooth.
        guess: (2 c + m,) initial state; None: bodies lowered until the contacts carry them, shifted in a curve so that
            bodies stand above those that carry them.
        tolerance: of the residual.
        acceptable: residual that is accepted when the iteration stalls, limited by the accuracy of the contact.
        max_iterations: Newton steps.

    Damped Newton with the contact's tangent; the damping decreases with the residual (pseudo-transient continuation).
    Raises EquilibriumError, also for a vehicle without `speed_hold`.
    """
    if dynamics.vehicle.speed_hold is None and (dynamics.coordinates.held[:, X] == 0).all():
        raise EquilibriumError("no equilibrium: without a speed_hold the position along the track is undetermined")
    problem = _SteadyProblem(steady_dynamics(dynamics))
    try:
        start = first_guess(problem.dynamics) if guess is None else guess.copy()
        return _newton(problem, start, tolerance, acceptable, max_iterations)
    except StepFailure as error:
        raise EquilibriumError(f"no equilibrium: {error}") from error


def steady_dynamics(dynamics: VehicleDynamics) -> VehicleDynamics:
    """The vehicle at its speed at time zero on a smooth track of the curvature, cant and gradient there."""
    s, speed, _ = dynamics.speed_profile(0.0)
    line = dynamics.track
    functions = (line.curvature, line.superelevation, line.gradient)
    if dynamics.speed_profile.constant and line.irregularities is None and all(len(f.values) == 1 for f in functions):
        return dynamics
    curvature, superelevation, gradient = (type(f).constant(f(s)[0]) for f in functions)
    return replace(dynamics, track=Track(curvature, superelevation, gradient, line.base), speed=speed)


def curve_dynamics(dynamics: VehicleDynamics, curve: ConstantCurve) -> VehicleDynamics:
    """The vehicle at the speed of a curve on its track."""
    return replace(dynamics, track=curve.track, speed=curve.speed)


def first_guess(dynamics: VehicleDynamics) -> Array:
    """State (2 c + m,) at the height where the contacts carry the vehicle; raises StepFailure if there is none.

    In a curve of curvature k a body that is carried at a distance a before and behind its centre is k a^2 / 2 inwards
    of its own section's centre line.
    """
    vehicle, coordinates = dynamics.vehicle, dynamics.coordinates
    state = np.zeros(dynamics.size)
    curvature = dynamics.track.curvature(0.0)[0]
    offset = dict.fromkeys(vehicle.wheelsets, 0.0)
    while len(offset) < len(vehicle.names):
        carried = {part.upper for part in vehicle.elements.values() if part.lower in offset} - set(offset)
        if not carried:
            break
        for name in carried:
            offset[name] = _carried_offset(dynamics, name, offset, curvature)
    for name, y in offset.items():
        state[coordinates.index(name, Y)] = y
    heights = np.flatnonzero(coordinates.free % 6 == Z)
    z = 0.0
    while z > LOWEST:
        state[heights] = z
        load = wheelset_wrenches(dynamics.solve_contacts(0.0, state, None))[:, 2].sum()
        if load > vehicle.weight:
            return state
        z -= STRIDE
    raise StepFailure(f"the wheels do not carry the vehicle within {-1e3 * LOWEST:g} mm of the nominal height")


def _carried_offset(dynamics: VehicleDynamics, name: str, offset: dict[str, float], curvature: float) -> float:
    """Lateral position m of a body at which it stands above the bodies that carry it, on average over its elements."""
    bodies = dynamics.vehicle.bodies
    values = []
    for part in dynamics.vehicle.elements.values():
        if part.upper == name and part.lower in offset:
            from_lower, from_upper = part.point[0] - bodies[part.lower].x, part.point[0] - bodies[name].x
            values.append(offset[part.lower] + 0.5 * curvature * (from_upper**2 - from_lower**2))
    return float(np.mean(values))


def _newton(
    problem: _SteadyProblem, state: Array, tolerance: float, acceptable: float, max_iterations: int
) -> VehicleEquilibrium:
    """Newton's method from a state. Raises EquilibriumError, or StepFailure when no step reduces the residual."""
    contacts = problem.contacts(state)
    residual = problem.residual(state, contacts)
    damping, best = 0.0, VehicleEquilibrium(problem.dynamics, state, contacts, 0, _size(residual))
    for iteration in range(1, max_iterations + 1):
        stalled = best.residual <= acceptable and iteration > best.iterations + 4
        if best.residual <= tolerance or stalled:
            return best
        state, contacts, new, damping = _step(problem, state, contacts, residual, damping)
        damping *= min(0.5, _size(new) / _size(residual))
        residual = new
        if _size(residual) < best.residual:
            best = VehicleEquilibrium(problem.dynamics, state, contacts, iteration, _size(residual))
    if best.residual <= acceptable:
        return best
    raise EquilibriumError(f"residual of {best.residual:.3g} wheel loads after {max_iterations} Newton steps")


def _step(
    problem: _SteadyProblem, state: Array, contacts: WheelContacts, residual: Array, damping: float
) -> tuple[Array, WheelContacts, Array, float]:
    """The next state, contacts, residual and damping.

    The residual may temporarily increase up to threefold: a monotonic decrease stalls where a second contact begins.
    Raises StepFailure when no damping satisfies this bound.
    """
    jacobian, size = problem.jacobian(state, contacts), _size(residual)
    while damping < 1e6:
        try:
            change = np.linalg.solve(damping * np.diag(1.0 / problem.largest) - jacobian, residual)
            change /= max(1.0, _size(change / problem.largest))
            new_state = state.copy()
            new_state[problem.unknowns] += change
            new_contacts = problem.contacts(new_state)
            new = problem.residual(new_state, new_contacts)
            if _size(new) < 3.0 * size:
                return new_state, new_contacts, new, damping
        except (StepFailure, np.linalg.LinAlgError):
            pass
        damping = max(4.0 * damping, 1e-2 * size)
    raise StepFailure(f"Newton's method stalled at a residual of {size:.3g} wheel loads")


def _size(vector: Array) -> float:
    return float(np.max(np.abs(vector)))
