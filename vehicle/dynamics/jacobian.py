"""Derivative of the equations of motion by the state and by time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Contacts, Dynamics, Evaluation, Wrench
from wheelrail.vehicle.dynamics.state import COUNT, PITCH, ROLL, Y, Z
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.track.frame import Frame

# Fields of a WheelsetState that the state moves, their places in the state, in the order of a contact's tangent (which
# also has the yaw, its fourth), and how far a difference goes: far above a contact's noise, far below its curvature.
SEEN = ("y", "z", "roll", "y_rate", "z_rate", "roll_rate", "pitch_rate")
PLACES = np.array([Y, Z, ROLL, COUNT + Y, COUNT + Z, COUNT + ROLL, COUNT + PITCH])
COLUMNS = [0, 1, 2, 4, 5, 6, 7]
ODD = ("y", "roll", "y_rate", "roll_rate")  # change their sign in the mirror: differences to both sides keep it exact
SMALL = (1e-6, 1e-6, 2e-6, 1e-3, 1e-3, 2e-3, 2e-3)
STEP = 1e-7  # m, rad, m/s or rad/s: for what is smooth and costs nothing
MOMENT = 1e-5  # s
KEPT = 8  # Jacobians that share one set of differences of the contact: 2 of 3 solves saved, a third more steps


@dataclass(frozen=True)
class Linearised:
    """Derivatives of the rate (n,) by the state (n, n) and by time (n,), n = 20 + m. By time contacts are held but for
    what irregular rails do to them: these move a stiff contact as much as the wheelset does.
    """

    by_state: Array
    by_time: Array


@dataclass
class Jacobian:
    """Linearisation at a time s and state (n,) with its evaluation; what it costs goes to the counts.

    Suspension, inertia and kinematics by differences under held contact forces (all n columns in one vectorised look);
    contact forces by the contact's tangent or, when it has none, by differences of 11 solves a side at every eighth
    call: the methods of `wheelrail.vehicle.integration.rosenbrock` keep their order with any matrix. central: all
    differences to both sides, of second order, for whom the matrix itself matters. The mirror image has the mirrored
    matrix, to the last bit.
    """

    dynamics: Dynamics
    counts: StepStatistics
    central: bool = False
    differences: Array | None = field(default=None, init=False)
    age: int = field(default=0, init=False)

    def __call__(self, time: float, state: Array, at: Evaluation) -> Linearised:
        """Raises StepFailure when a contact cannot be solved or gives no tangent."""
        self.counts.jacobians += 1
        d = self.dynamics
        frame, later = (d.frame(t) for t in (time, time + MOMENT))
        wrench = Wrench.of(at.contacts)
        by_state = np.zeros((len(state), len(state)))
        by_state[:COUNT, COUNT : 2 * COUNT] = np.eye(COUNT)
        small = STEP * np.eye(len(state))
        looks, _ = d.accelerations(frame, np.vstack([state + small, state - small, state]), wrench)
        ahead, behind, (here,) = np.split(looks, [len(state), 2 * len(state)])
        by_state[COUNT:] = (ahead - behind).T / (2 * STEP)
        by_wrench, tangents = self.by_wrench(state), self.tangents(frame, state, at.contacts)
        by_state[COUNT : 2 * COUNT, PLACES] += by_wrench @ tangents.sum(axis=0)[:, COLUMNS]
        by_time = np.zeros(len(state))
        by_time[COUNT:] = (d.accelerations(later, state, wrench)[0] - here) / MOMENT
        if frame.rails is not None and later.rails is not None:
            rates = (np.array(later.rails) - np.array(frame.rails)) / MOMENT
            # A rail that moves is a wheelset that moves the other way, wherever both are together.
            by_time[COUNT : 2 * COUNT] -= by_wrench @ np.einsum("sij,sj->i", tangents[:, :, :2], rates)
        return Linearised(by_state, by_time)

    def by_wrench(self, state: Array) -> Array:
        """Accelerations by force and moment on the wheelset (10, 6)."""
        mass, ixx, iyy, _, _ = self.dynamics.constants[:, 2]
        c, s = np.cos(state[ROLL]), np.sin(state[ROLL])
        result = np.zeros((COUNT, 6))
        result[Y, 1] = result[Z, 2] = 1.0 / mass
        result[ROLL, 3] = 1.0 / ixx
        result[PITCH, 4:] = c / iyy, s / iyy
        return result

    def tangents(self, frame: Frame, state: Array, contacts: Contacts) -> Array:
        """Force and moment of the left and the right wheel by the wheelset's position and rates (2, 6, 8)."""
        wheelset = self.dynamics.wheelset_state(frame, state)
        known = self.known(wheelset, contacts)
        return self._differences(wheelset, contacts) if known is None else known

    def known(self, wheelset: WheelsetState, contacts: Contacts) -> Array | None:
        """The same from the contact itself, if it can tell."""
        contact = self.dynamics.contact
        try:
            contact.ahead_tangent(wheelset, contacts["right"])
            found = np.array([contact.tangent(wheelset, side, contacts[side]) for side in SIDES])
        except ValueError:  # not every model, and not every result, has one
            return None
        except (ArithmeticError, RuntimeError, np.linalg.LinAlgError) as error:
            raise StepFailure(f"tangent of a contact: {type(error).__name__}: {error}") from error
        return found if np.isfinite(found).all() else None

    def _differences(self, wheelset: WheelsetState, contacts: Contacts) -> Array:
        self.age = (self.age + 1) % KEPT
        if self.differences is not None and self.age:
            return self.differences
        result, here = np.zeros((2, 6, 8)), _six(contacts)
        for column, name, small in zip(COLUMNS, SEEN, SMALL, strict=True):
            ahead = self._moved(wheelset, contacts, name, small)
            both = self.central or name in ODD
            behind = self._moved(wheelset, contacts, name, -small) if both else here
            result[:, :, column] = (ahead - behind) / (2 * small if both else small)
        self.differences, self.age = result, 0
        return result

    def _moved(self, wheelset: WheelsetState, contacts: Contacts, name: str, by: float) -> Array:
        self.counts.differences += 1
        moved = replace(wheelset, **{name: getattr(wheelset, name) + by})
        return _six(self.dynamics.solve_wheelset(moved, contacts))


def _six(contacts: Contacts) -> Array:
    """Force and moment of the left and the right wheel (2, 6)."""
    return np.array([np.concatenate([contacts[side].force, contacts[side].moment]) for side in SIDES])
