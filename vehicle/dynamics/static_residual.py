"""Static residual: unbalanced forces on the wagon in a steady position."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Contacts, Dynamics, Wrench, wrenches
from wheelrail.vehicle.dynamics.jacobian import NO_TANGENT, Jacobian
from wheelrail.vehicle.dynamics.state import COUNT, PITCH, ROLL, Y, Z
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.track.frame import Frame

# Of nine positions and the relative excess of spin: difference steps, and the largest change in a Newton step.
DIFFERENCE_STEPS = np.array([1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 2e-6, 5e-7, 5e-7, 1e-5])
LARGE = np.array([3e-2, 3e-2, 2e-2, 3e-3, 3e-3, 5e-3, 1e-3, 2e-4, 1e-3, 1e-3])
MOST_ROLL = 5e-3  # rad: 7 mm difference of the wheels' radii
UNEVEN = 0.8  # difference of the wheels' loads over the axle load, above which the wheelset is rolled
CONTACT_UNKNOWNS = [Y, Z, ROLL, PITCH]
TANGENT_COLUMNS = [WheelsetState.coordinates.index(name) for name in ("y", "z", "roll", "pitch_rate")]
MOTION = 1e-3  # m and rad, of axle and rails: as much in the residual as the axle load, and largest in a Newton step


def size_of(vector: Array) -> float:
    return float(np.max(np.abs(vector)))


@dataclass(frozen=True)
class StaticResidual:
    """Unbalanced forces over the axle load; unknowns (10 + k,): positions, then relative excess of spin over nominal
    spin, then motions of axle and rails, whose errors are over 1 mm and 1 mrad.

    Parameters:
        dynamics: the equations of motion.
        frame: steady track frame.

    Springs of Maxwell elements are unloaded.
    """

    dynamics: Dynamics
    frame: Frame

    @cached_property
    def large(self) -> Array:
        """(10 + k,) largest changes of the unknowns in a Newton step."""
        return np.concatenate([LARGE, np.full(self.dynamics.motions, MOTION)])

    @cached_property
    def weights(self) -> Array:
        """(10,) masses and inertias over the axle load; lever arm of roll moments 1 m, of spin the wheel radius."""
        mass, roll, pitch, _, _ = self.dynamics.constants
        wagon = self.dynamics.wagon
        rows = np.stack([mass, mass, roll], axis=1).ravel()
        return np.append(rows, pitch[2] / wagon.radius) / wagon.axle_load

    def state(self, unknown: Array) -> Array:
        state = np.zeros(self.dynamics.size)
        state[:9], state[COUNT + PITCH] = unknown[:9], unknown[9] * self.dynamics.rolling_rate(self.frame)
        state[len(state) - self.dynamics.motions :] = unknown[COUNT:]
        return state

    def unknown(self, state: Array) -> Array:
        spin = state[COUNT + PITCH] / self.dynamics.rolling_rate(self.frame)
        return np.concatenate([state[:9], [spin], self.dynamics.split(state).motions])

    def contacts(self, unknown: Array, guess: Contacts | None) -> Contacts:
        return self.dynamics.solve_contacts(self.frame, self.state(unknown), guess)

    def residual(self, unknown: Array, contacts: Contacts) -> Array:
        unbalanced, structure = self._unbalanced(unknown, contacts), self.dynamics.structure
        if structure is None:
            return unbalanced
        wheelset = self.dynamics.wheelset_state(self.frame, self.state(unknown))
        here, loads = structure.at(self.frame.distance), structure.loads(wheelset, wrenches(contacts))
        return np.concatenate([unbalanced, here.imbalance(unknown[COUNT:], loads) / MOTION])

    def _unbalanced(self, unknown: Array, contacts: Contacts) -> Array:
        """Rows (10,) of the residual that belong to the bodies."""
        accelerations, _ = self.dynamics.accelerations(self.frame, self.state(unknown), Wrench.of(contacts))
        return np.asarray(self.weights * accelerations[:COUNT])

    def jacobian(self, unknown: Array, contacts: Contacts, residual: Array) -> Array:
        """Jacobian (10 + k, 10 + k) of the residual, by the contact's tangent or by four differences of the contact.

        Raises StepFailure where axle and rails move and the contact has no tangent.
        """
        d, state = self.dynamics, self.state(unknown)
        linear, wheelset = Jacobian(d, StepStatistics()), d.wheelset_state(self.frame, state)
        tangents, by_wrench = linear.analytical_tangents(wheelset, contacts), linear.by_wrench(state)
        result = np.zeros((len(unknown), len(unknown)))
        for i, step in enumerate(DIFFERENCE_STEPS):
            perturbed = unknown.copy()
            perturbed[i] += step
            solve = tangents is None and i in CONTACT_UNKNOWNS
            results = self.contacts(perturbed, contacts) if solve else contacts
            result[:COUNT, i] = (self._unbalanced(perturbed, results) - residual[:COUNT]) / step
        spin = np.array([1.0, 1.0, 1.0, d.rolling_rate(self.frame)])
        if tangents is not None:
            by_unknowns = tangents.sum(axis=0)[:, TANGENT_COLUMNS] * spin
            result[:COUNT, CONTACT_UNKNOWNS] += self.weights[:, None] * by_wrench @ by_unknowns
        if d.structure is not None:
            if tangents is None:
                raise StepFailure(NO_TANGENT)
            own, structure = len(WheelsetState.coordinates), d.structure.at(self.frame.distance)
            slopes = structure.load_slopes(wheelset, wrenches(contacts), tangents).sum(axis=0)
            slopes = structure.compliance @ slopes / MOTION
            moving = slice(COUNT, COUNT + tangents.shape[-1] - own)
            result[:COUNT, moving] = self.weights[:, None] * by_wrench @ tangents.sum(axis=0)[:, own:]
            result[COUNT:, CONTACT_UNKNOWNS] = slopes[:, TANGENT_COLUMNS] * spin
            result[COUNT:, moving] = slopes[:, own:]
            result[COUNT:, COUNT:] -= np.eye(d.motions) / MOTION
        return result

    def static(self) -> Array:
        """Unknowns (10 + k,) of upright bodies, axle and rails at rest, at the height where the contacts carry the axle
        load within 2 %.

        Where one wheel then carries nearly all, as with wheels of different radii, at the roll of the wheelset at which
        both carry the same load within 5 %. Raises StepFailure.
        """
        unknown, uneven = self._at_roll(0.0)
        low, high = -MOST_ROLL, MOST_ROLL
        while abs(uneven) > (UNEVEN if unknown[ROLL] == 0.0 else 0.05):
            low, high = (unknown[ROLL], high) if uneven > 0.0 else (low, unknown[ROLL])  # roll lifts the left wheel
            if high - low < 1e-9:
                raise StepFailure("no roll of the wheelset at which both wheels carry the same load")
            unknown, uneven = self._at_roll(0.5 * (low + high))
        return unknown

    def _at_roll(self, roll: float) -> tuple[Array, float]:
        """Unknowns (10 + k,) at the height for the axle load, and left minus right wheel load over the axle load.

        roll: of the wheelset, rad.
        """
        unknown = np.zeros(COUNT + self.dynamics.motions)
        unknown[ROLL] = roll
        contacts: Contacts = {}
        heights = [1, 4, Z]

        def load_fraction(z: float) -> float:
            unknown[heights] = z
            contacts.update(self.contacts(unknown, contacts))
            load = Wrench.of(contacts).force[2]
            # A Hertzian force grows as depth^(3/2): its power 2/3 is nearly straight.
            return float(np.cbrt(max(load, 0.0) / self.dynamics.wagon.axle_load) ** 2)

        z, stride = 0.0, 5e-5
        fraction = load_fraction(z)
        direction = -1.0 if fraction < 1.0 else 1.0
        other, other_fraction = z, fraction
        while (other_fraction < 1.0) == (fraction < 1.0):
            if abs(other) > 0.05:
                raise StepFailure("the wheels do not carry the axle load within 50 mm of the nominal height")
            z, fraction = other, other_fraction
            try:
                other_fraction = load_fraction(z + direction * stride)
            except StepFailure:
                if stride < 1e-7:
                    raise
                stride *= 0.25  # too deep for the contact model
                continue
            other, stride = z + direction * stride, 1.5 * stride
        for _ in range(40):
            middle = z + (1.0 - fraction) * (other - z) / (other_fraction - fraction)
            value = load_fraction(middle)
            if abs(value - 1.0) < 0.013:
                break
            if (value < 1.0) == (fraction < 1.0):
                z, fraction = middle, value
            else:
                other, other_fraction = middle, value
        left, right = (float(contacts[side].force[2]) for side in SIDES)
        return unknown, (left - right) / self.dynamics.wagon.axle_load
