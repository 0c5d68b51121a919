"""Derivatives of the equations of motion of a vehicle with respect to the state and time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.results.result import ContactResult
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.contact_differences import ContactDifferences, renewed
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.coordinates import PITCH, ROLL, YAW, X, Y, Z
from wheelrail.vehicle.multibody.equations import (
    VehicleDynamics,
    VehicleEvaluation,
    WheelContacts,
    wheelset_wrenches,
)

# Steps of `WheelsetState.coordinates`, well above the residual noise of a contact solve; those antisymmetric in y are
# differentiated centrally, which keeps the mirror symmetry.
DIFFERENCE_STEPS = (1e-6, 1e-6, 2e-6, 2e-6, 1e-3, 1e-3, 2e-3, 2e-3, 2e-3)
ODD = ("y", "roll", "yaw", "y_rate", "roll_rate", "yaw_rate")
FIRST_RATE = WheelsetState.coordinates.index("y_rate")
TIME_STEP = 1e-5  # s, forward difference in time of irregular rails


@dataclass(frozen=True)
class VehicleLinearisation:
    """Derivatives of the rate (n,), n = 2 c + m.

    Parameters:
        by_state: (n, n).
        by_time: (n,) at constant contact forces, but for the motion of irregular rails.
    """

    by_state: Array
    by_time: Array


@dataclass
class VehicleJacobian:
    """Linearisation at a time s and state (n,) with its evaluation.

    Parameters:
        dynamics: the equations of motion.
        counts: statistics to which Jacobians and contact differences are added.
        central: central differences of contacts throughout, for uses of the matrix itself such as modes.
        differences: contact tangents (w, 2, 6, 9) by differences at an earlier state; None: none yet.

    Suspension, inertia and kinematics: exact, at constant contact forces. Contact forces: the contact's tangent or,
    without one, differences.
    """

    dynamics: VehicleDynamics
    counts: StepStatistics
    central: bool = False
    differences: ContactDifferences | None = None

    def __call__(self, time: float, state: Array, at: VehicleEvaluation) -> VehicleLinearisation:
        """Derivatives of the rate.

        Parameters:
            time: s.
            state: (n,).
            at: evaluation at this time and state.

        Raises StepFailure when a contact solve or its tangent fails.
        """
        self.counts.jacobians += 1
        d, c, n = self.dynamics, self.dynamics.coordinates.count, self.dynamics.size
        travel, (_, _, jerk) = d.speed_profile(time), d.speed_profile.speeds(time)
        bodies = d.bodies.derivatives(travel, jerk, state, wheelset_wrenches(at.contacts))
        by_state, by_time = np.zeros((n, n)), np.zeros(n)
        by_state[:c, c : 2 * c] = np.eye(c)
        by_state[c:], by_time[c:] = bodies.by_state, bodies.by_time
        states = d.wheelset_states(time, state)
        later = d.wheelset_states(time + TIME_STEP, state) if d.track.irregularities is not None else {}
        tangents = self.tangents(states, at.contacts)
        for i, (body, name) in enumerate(zip(d.coordinates.wheelset_bodies.tolist(), states, strict=True)):
            own = d.coordinates.of_body(body)
            rows, by_wrench = c + own, bodies.by_wrench[:, own].T
            columns, free = self._columns(body)
            by_state[rows[:, None], columns] += by_wrench @ tangents[i].sum(axis=0)[:, free]
            if later:
                shift, later_shift = states[name].rail_shift, later[name].rail_shift
                rates = (np.array(later_shift) - np.array(shift)) / TIME_STEP
                # Contact forces depend on the relative position only: rail motion is the opposite wheelset motion.
                by_time[rows] -= by_wrench @ np.einsum("sij,sj->i", tangents[i][:, :, :2], rates)
        return VehicleLinearisation(by_state, by_time)

    def _columns(self, body: int) -> tuple[list[int], list[int]]:
        """Indices in the state of `WheelsetState.coordinates` and of the speed, and of these columns in the tangents,
        of a body without its held coordinates.
        """
        places = {coordinate: i for i, coordinate in enumerate(self.dynamics.coordinates.within_all.tolist())}
        total = self.dynamics.coordinates.held.size
        columns = [6 * body + k for k in (Y, Z, ROLL, YAW)]
        columns += [total + 6 * body + k for k in (Y, Z, ROLL, YAW, PITCH, X)]
        free = [i for i, column in enumerate(columns) if column in places]
        return [places[columns[i]] for i in free], free

    def tangents(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array:
        """Derivatives (w, 2, 6, 10) of force and moment of each wheel by `WheelsetState.coordinates` and the speed.

        With friction that does not depend on speed, forces depend on the ratio of all rates, that of the track frame
        included, to the speed V: dF/dV = -sum(rate dF/drate) / V.
        """
        by_coordinates = self._analytical_tangents(states, contacts)
        if by_coordinates is None:
            by_coordinates = self._differences(states, contacts)
        rates = np.array([[getattr(s, name) for name in s.coordinates[FIRST_RATE:]] for s in states.values()])
        speeds = np.array([s.speed for s in states.values()])
        by_speed = -np.einsum("wsij,wj->wsi", by_coordinates[..., FIRST_RATE:], rates / speeds[:, None])
        return np.concatenate([by_coordinates, by_speed[..., None]], axis=-1)

    def _analytical_tangents(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array | None:
        """The tangents (w, 2, 6, 9) of the contact model; None if it has none. Raises StepFailure when one fails."""
        try:
            for name, state in states.items():
                self.dynamics.contact.ahead_tangent(state, contacts[name][SIDES[-1]])
            tangents = [self.dynamics.element.side_tangents(state, contacts[name]) for name, state in states.items()]
        except ValueError:  # some models and results have no tangent
            return None
        except (ArithmeticError, RuntimeError, np.linalg.LinAlgError) as error:
            raise StepFailure(f"tangent of a contact: {type(error).__name__}: {error}") from error
        return np.array(tangents) if np.isfinite(tangents).all() else None

    def _differences(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array:
        """Tangents (w, 2, 6, 9) by differences, those of an earlier call as long as they may be reused."""
        self.differences = renewed(self.differences, lambda: self._differentiated(states, contacts))
        return self.differences.tangents

    def _differentiated(self, states: Mapping[str, WheelsetState], contacts: WheelContacts) -> Array:
        result = np.zeros((len(states), len(SIDES), 6, len(WheelsetState.coordinates)))
        for i, (name, state) in enumerate(states.items()):
            centre = _wheel_wrenches(contacts[name])
            for column, (key, step) in enumerate(zip(WheelsetState.coordinates, DIFFERENCE_STEPS, strict=True)):
                central = self.central or key in ODD
                plus = self._perturbed(name, state, contacts, key, step)
                minus = self._perturbed(name, state, contacts, key, -step) if central else centre
                result[i, :, :, column] = (plus - minus) / (2 * step if central else step)
        return result

    def _perturbed(self, name: str, state: WheelsetState, contacts: WheelContacts, key: str, step: float) -> Array:
        self.counts.differences += 1
        perturbed = replace(state, **{key: getattr(state, key) + step})
        return _wheel_wrenches(self.dynamics.solve_wheelset(name, perturbed, contacts))


def _wheel_wrenches(contacts: Mapping[Side, ContactResult]) -> Array:
    """Force and moment of the left and the right wheel (2, 6)."""
    return np.array([np.concatenate([contacts[side].force, contacts[side].moment]) for side in SIDES])
