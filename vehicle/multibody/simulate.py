"""Motion of a vehicle over time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.integrate import Step, StepSettings, StepTooSmall, integrate
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.rosenbrock import ROS34PW2
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import ROLL, YAW, Y, Z
from wheelrail.vehicle.multibody.equations import VehicleDynamics, VehicleEvaluation, WheelContacts
from wheelrail.vehicle.multibody.equilibrium import vehicle_equilibrium
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian

ROLL_LIMIT = 0.3  # rad, of a body: more than springs allow with both wheels on the rails
SHIFT_LIMIT, LIFT_LIMIT = 0.04, 0.03  # m, of a wheelset: a flange about 30 mm thick and 28 mm high no longer guides it


@dataclass(frozen=True)
class VehicleHistory:
    """Results of a run in n rows for w wheelsets.

    Parameters:
        dynamics: equations of motion.
        status: "completed" or "failed: ..." with the reason.
        time: (n,) s.
        state: (n, 2 c + m).
        force: (n, w, 2, 3) N on the left and right wheels, in the track frames of the wheelsets.
        frictional_power: (n, w, 2) W.
        steps: statistics of the integrator.
    """

    dynamics: VehicleDynamics
    status: str
    time: Array
    state: Array
    force: Array
    frictional_power: Array
    steps: StepStatistics

    def coordinate(self, body: str, coordinate: int) -> Array:
        """Values (n,) m or rad of a coordinate of a body, see `wheelrail.vehicle.multibody.coordinates`."""
        return np.asarray(self.state[:, self.dynamics.coordinates.index(body, coordinate)])


@dataclass
class _Rows:
    """Rows of a history."""

    time: list[float] = field(default_factory=list)
    state: list[Array] = field(default_factory=list)
    force: list[Array] = field(default_factory=list)
    frictional_power: list[Array] = field(default_factory=list)

    def add(self, time: float, state: Array, contacts: WheelContacts) -> None:
        wheels = [[sides[side] for side in SIDES] for sides in contacts.values()]
        self.time.append(time)
        self.state.append(state)
        self.force.append(np.array([[wheel.force for wheel in pair] for pair in wheels]))
        powers = [[sum(patch.frictional_power for patch in wheel.patches) for wheel in pair] for pair in wheels]
        self.frictional_power.append(np.array(powers))

    def history(self, dynamics: VehicleDynamics, status: str, steps: StepStatistics) -> VehicleHistory:
        time, state, force = np.array(self.time), np.array(self.state), np.array(self.force)
        return VehicleHistory(dynamics, status, time, state, force, np.array(self.frictional_power), steps)


def simulate_vehicle(
    dynamics: VehicleDynamics,
    span: tuple[float, float] = (0.0, 10.0),
    *,
    initial: Array | None = None,
    rtol: float = 3e-3,
    atol: float = 3e-5,
    interval: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> VehicleHistory:
    """Motion of a vehicle over a time span by a Rosenbrock-W method; the distance is zero at time zero.

    Parameters:
        dynamics: equations of motion.
        span: start and end, s.
        initial: (2 c + m,) state; None: the equilibrium at the speed, curvature and cant at time zero.
        rtol, atol: tolerances of the error of a step; atol in m and rad, 100 atol in m/s and rad/s. Smaller ones make
            the steps resolve the wheelsets' vibration on the contacts at 50 to 250 Hz, which is hardly damped.
        interval: between rows, s, at which the contacts are solved again; None: rows at accepted steps.
        progress: called with the time, s, at each accepted step.

    If the smallest step fails, a body rolls by more than 0.3 rad, or a wheelset leaves the rails, the history ends
    there; its status names the reason. Raises EquilibriumError, and ValueError for an invalid span or interval.
    """
    if interval is not None and not interval > 0.0:
        raise ValueError(f"interval = {interval} s: must be positive, or None for all accepted steps")
    state = vehicle_equilibrium(dynamics).state if initial is None else np.array(initial, dtype=float)
    if state.shape != (dynamics.size,):
        raise ValueError(f"initial: shape {state.shape}: must be ({dynamics.size},), the state of this vehicle")
    rows, counts = _Rows(), StepStatistics()
    status = "completed"
    try:
        start = dynamics.solve_contacts(span[0], state, None)
        rows.add(span[0], state, start)
        settings = StepSettings(ROS34PW2.name, rtol, dynamics.coordinates.tolerances(atol))
        jacobian = VehicleJacobian(dynamics, counts)
        for step in integrate(dynamics, span[0], state, span[1], settings, jacobian=jacobian, counts=counts):
            for time, row_state, contacts in _rows_of(dynamics, step, interval):
                rows.add(time, row_state, contacts)
            _check_limits(dynamics, step.t, step.x)
            if progress is not None:
                progress(step.t)
    except (StepFailure, StepTooSmall, _OffTrack) as error:
        status = f"failed: {error}"
    return rows.history(dynamics, status, counts)


class _OffTrack(RuntimeError):
    """The vehicle has overturned or derailed: the model is no longer valid."""


def _rows_of(
    dynamics: VehicleDynamics, step: Step[VehicleEvaluation], interval: float | None
) -> Iterator[tuple[float, Array, WheelContacts]]:
    """Times, states and contacts of the rows within a step. Raises StepFailure."""
    if interval is None:
        yield step.t, step.x, step.end.contacts
        return
    first, last = int(np.floor(step.t0 / interval * (1 + 1e-12))) + 1, int(np.floor(step.t / interval * (1 + 1e-12)))
    for time in (interval * np.arange(first, last + 1)).tolist():
        state = step.at(time)
        yield time, state, dynamics.solve_contacts(time, state, step.end.contacts)


def _check_limits(dynamics: VehicleDynamics, time: float, state: Array) -> None:
    """Raises _OffTrack beyond the limits."""
    position, _, _ = dynamics.coordinates.split(state)
    where = f"at t = {time:.3f} s, s = {dynamics.speed_profile(time).distance:.1f} m"
    for name, q in zip(dynamics.vehicle.names, position, strict=True):
        if abs(q[ROLL]) > ROLL_LIMIT or abs(q[YAW]) > ROLL_LIMIT:
            raise _OffTrack(f"{name} overturns {where}")
        if dynamics.vehicle.bodies[name].wheelset and (abs(q[Y]) > SHIFT_LIMIT or q[Z] > LIFT_LIMIT):
            raise _OffTrack(f"{name} leaves the rails {where}")
