"""Derivatives of the equations of motion with respect to the state and time."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.contact_differences import ContactDifferences, renewed
from wheelrail.vehicle.dynamics.equations import Contacts, Dynamics, Evaluation, Wrench, wrenches
from wheelrail.vehicle.dynamics.state import COUNT, PITCH, ROLL, Y, Z
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.track.frame import Frame

# Fields of a WheelsetState that depend on the state, their indices in the state and in the contact tangent (which has
# yaw and its rate as well); difference steps well above the residual noise of a contact solve and small enough
# for its curvature.
FIELDS = ("y", "z", "roll", "y_rate", "z_rate", "roll_rate", "pitch_rate")
INDICES = np.array([Y, Z, ROLL, COUNT + Y, COUNT + Z, COUNT + ROLL, COUNT + PITCH])
COLUMNS = [WheelsetState.coordinates.index(name) for name in FIELDS]
ODD = ("y", "roll", "y_rate", "roll_rate")  # antisymmetric: central differences keep the mirror symmetry exact
DIFFERENCE_STEPS = (1e-6, 1e-6, 2e-6, 1e-3, 1e-3, 2e-3, 2e-3)
STEP = 1e-7  # m, rad, m/s or rad/s: for suspension and inertial forces, which are smooth
TIME_STEP = 1e-5  # s, forward difference in time
NO_TANGENT = "the contact has no tangent, which elastic axles and rails on pads need"


@dataclass(frozen=True)
class Linearised:
    """Derivatives of the rate (n,), n = 20 + m + k.

    Parameters:
        by_state: (n, n).
        by_time: (n,); contact forces are constant except for the motion of irregular rails, which affects the stiff
            contact as much as that of the wheelset.
    """

    by_state: Array
    by_time: Array


@dataclass
class Jacobian:
    """Linearisation at a time s and state (n,) with its evaluation.

    Parameters:
        dynamics: the equations of motion.
        counts: statistics to which Jacobians and contact differences are added.
        central: central differences throughout (second order), for uses of the matrix itself such as modes.
        differences: contact tangents by differences at an earlier state; None: none yet.

    Suspension, inertia and kinematics: differences at constant contact forces, all n columns in one vectorised
    evaluation. Contact forces: the contact's tangent or, without one, differences with 11 solves a side at every eighth
    call; the methods of `wheelrail.vehicle.integration.rosenbrock` keep their order with any matrix. The mirror image
    of a state has the mirrored matrix, bit for bit.
    """

    dynamics: Dynamics
    counts: StepStatistics
    central: bool = False
    differences: ContactDifferences | None = None

    def __call__(self, time: float, state: Array, at: Evaluation) -> Linearised:
        """Derivatives of the rate.

        Parameters:
            time: s.
            state: (n,).
            at: evaluation at this time and state.

        Raises StepFailure when a contact solve or its tangent fails.
        """
        self.counts.jacobians += 1
        d = self.dynamics
        frame, later = (d.frame(t) for t in (time, time + TIME_STEP))
        wrench = Wrench.of(at.contacts)
        by_state = np.zeros((len(state), len(state)))
        by_state[:COUNT, COUNT : 2 * COUNT] = np.eye(COUNT)
        steps = STEP * np.eye(len(state))
        accelerations, _ = d.accelerations(frame, np.vstack([state + steps, state - steps, state]), wrench)
        plus, minus, (centre,) = np.split(accelerations, [len(state), 2 * len(state)])
        bodies = slice(COUNT, len(state) - d.motions)
        by_state[bodies] = (plus - minus).T / (2 * STEP)
        by_wrench, tangents = self.by_wrench(state), self.tangents(frame, state, at.contacts)
        indices, columns = _indices(bodies.stop, tangents.shape[-1])
        by_state[COUNT : 2 * COUNT, indices] += by_wrench @ tangents.sum(axis=0)[:, columns]
        if d.structure is not None:
            structure, wheelset = d.structure.at(frame.distance), d.wheelset_state(frame, state)
            slopes = structure.by_loads @ structure.load_slopes(wheelset, wrenches(at.contacts), tangents)
            by_state[bodies.stop :, indices] = slopes.sum(axis=0)[:, columns]
            by_state[bodies.stop :, bodies.stop :] += structure.by_motions
        by_time = np.zeros(len(state))
        by_time[bodies] = (d.accelerations(later, state, wrench)[0] - centre) / TIME_STEP
        if d.structure is not None:
            loads = structure.loads(wheelset, wrenches(at.contacts))
            by_time[bodies.stop :] = frame.speed * structure.rates_by_distance(d.split(state).motions, loads)
        if frame.rails is not None and later.rails is not None:
            rates = (np.array(later.rails) - np.array(frame.rails)) / TIME_STEP
            # Contact forces depend on the relative position only: rail motion is the opposite wheelset motion.
            by_time[COUNT : 2 * COUNT] -= by_wrench @ np.einsum("sij,sj->i", tangents[:, :, :2], rates)
            if d.structure is not None:
                by_time[bodies.stop :] -= np.einsum("sij,sj->i", slopes[:, :, :2], rates)
        return Linearised(by_state, by_time)

    def by_wrench(self, state: Array) -> Array:
        """Derivatives (10, 6) of the accelerations with respect to force and moment on the wheelset."""
        mass, ixx, iyy, _, _ = self.dynamics.constants[:, 2]
        c, s = np.cos(state[ROLL]), np.sin(state[ROLL])
        result = np.zeros((COUNT, 6))
        result[Y, 1] = result[Z, 2] = 1.0 / mass
        result[ROLL, 3] = 1.0 / ixx
        result[PITCH, 4:] = c / iyy, s / iyy
        return result

    def tangents(self, frame: Frame, state: Array, contacts: Contacts) -> Array:
        """Derivatives (2, 6, 9 + k) of force and moment of the left and the right wheel with respect to the wheelset's
        position and rates, and to the motions of hubs and rails. Raises StepFailure where these move and the contact
        has no tangent.
        """
        wheelset = self.dynamics.wheelset_state(frame, state)
        tangents = self.analytical_tangents(wheelset, contacts)
        if tangents is None and self.dynamics.structure is not None:
            raise StepFailure(NO_TANGENT)
        return self._differences(wheelset, contacts) if tangents is None else tangents

    def analytical_tangents(self, wheelset: WheelsetState, contacts: Contacts) -> Array | None:
        """The tangents (2, 6, 9 + k) of the contact model; None if it has none. Raises StepFailure when one fails."""
        try:
            tangents = self.dynamics.element.side_tangents(wheelset, contacts)
        except ValueError:  # some models and results have no tangent
            return None
        except (ArithmeticError, RuntimeError, np.linalg.LinAlgError) as error:
            raise StepFailure(f"tangent of a contact: {type(error).__name__}: {error}") from error
        return tangents if np.isfinite(tangents).all() else None

    def _differences(self, wheelset: WheelsetState, contacts: Contacts) -> Array:
        self.differences = renewed(self.differences, lambda: self._differentiated(wheelset, contacts))
        return self.differences.tangents

    def _differentiated(self, wheelset: WheelsetState, contacts: Contacts) -> Array:
        result, centre = np.zeros((2, 6, len(WheelsetState.coordinates))), wrenches(contacts)
        for column, name, step in zip(COLUMNS, FIELDS, DIFFERENCE_STEPS, strict=True):
            plus = self._perturbed(wheelset, contacts, name, step)
            central = self.central or name in ODD
            minus = self._perturbed(wheelset, contacts, name, -step) if central else centre
            result[:, :, column] = (plus - minus) / (2 * step if central else step)
        return result

    def _perturbed(self, wheelset: WheelsetState, contacts: Contacts, name: str, step: float) -> Array:
        self.counts.differences += 1
        perturbed = replace(wheelset, **{name: getattr(wheelset, name) + step})
        return wrenches(self.dynamics.solve_wheelset(perturbed, contacts))


def _indices(bodies: int, columns: int) -> tuple[Array, Array]:
    """Indices in a state on which contact forces depend, and their columns in the tangents.

    Parameters:
        bodies: size of a state without motions of axle and track.
        columns: of the tangents.
    """
    own = len(WheelsetState.coordinates)
    moving = np.arange(columns - own)
    return np.concatenate([INDICES, bodies + moving]), np.concatenate([COLUMNS, own + moving])
