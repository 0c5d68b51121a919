"""Contacts solved at the ends of steps, with their forces within steps by values and slopes there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import SIDES, Side
from wheelrail.contact.kinematics.wheelset_state import NO_SHIFT, WheelsetState
from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.problem import Ends, HasDerivatives, StepFailure
from wheelrail.vehicle.multibody.equations import (
    VehicleDynamics,
    VehicleEvaluation,
    WheelContacts,
    all_side_wrenches,
)
from wheelrail.vehicle.multibody.jacobian import VehicleLinearisation, by_speed


def values_on_rail(state: WheelsetState, side: Side, radius: float) -> Array:
    """Values (n + 1,) of a state by which forces of a side vary: its coordinates relative to the rail, and the speed.

    Parameters:
        state: of the wheelset.
        side: of the wheel.
        radius: height m of the wheelset's centre over the origin of the track frame.

    The motion of the track frame is that of all bodies against the rail: to first order in yaw and roll its rotation is
    added to the rates and the speed.
    """
    values = np.array([*(getattr(state, name) for name in WheelsetState.coordinates), *_motions(state), state.speed])
    (wx, wy, wz), y, z = state.frame_rate, state.y, radius + state.z
    shift = (state.rail_shift or NO_SHIFT)[SIDES.index(side)]
    values[:2] -= shift
    values[4:9] += -wx * z, wx * y, wx, wz, wy
    values[-1] += wy * z - wz * y
    return values


def _motions(state: WheelsetState) -> tuple[float, ...]:
    return getattr(state, "motions", ())


@dataclass(frozen=True, eq=False)
class ContactsAtEnd:
    """Right-hand side near a state where the contacts are solved, F(x) = F(x_n) + F'(x_n) (x - x_n).

    Parameters:
        dynamics: equations of motion.
        state: (2 c + m + k,).
        there: its evaluation.
        tangents: (w, 2, 6, n) of its contacts.

    x is `values_on_rail`. Contacts have the patches, tangents and warm starts of those that are solved.
    """

    dynamics: VehicleDynamics
    state: Array
    there: VehicleEvaluation
    tangents: Array

    @staticmethod
    def at_start(dynamics: VehicleDynamics) -> Ends[VehicleEvaluation]:
        """Solutions at the starts of steps; none without tangents, or with friction along the track."""

        def found(x: Array, start: VehicleEvaluation, linear: HasDerivatives) -> ContactsAtEnd | None:
            if not isinstance(linear, VehicleLinearisation) or not linear.exact or dynamics.track.rubs:
                return None
            return None if linear.tangents is None else ContactsAtEnd(dynamics, x, start, linear.tangents)

        return found

    @classmethod
    def of(cls, dynamics: VehicleDynamics, state: Array, there: VehicleEvaluation) -> ContactsAtEnd:
        """Contacts of an evaluation, with their tangents. Raises StepFailure where one fails."""
        assert there.states is not None
        states, contacts = list(there.states.values()), [there.contacts[name] for name in there.states]
        try:
            tangents = dynamics.element.tangents(states, contacts)
        except (ArithmeticError, ValueError, RuntimeError, np.linalg.LinAlgError) as error:
            raise StepFailure(f"tangent of a contact: {type(error).__name__}: {error}") from error
        if not np.isfinite(tangents).all():
            raise StepFailure("tangent of a contact: not finite")
        return cls(dynamics, state, there, tangents)

    def at(self, state: Array, there: VehicleEvaluation) -> ContactsAtEnd:
        return self.of(self.dynamics, state, there)

    def __call__(self, time: float, state: Array, previous: VehicleEvaluation | None) -> VehicleEvaluation:
        own = self.dynamics.under(time, state, self._contacts(0.0))
        return changed(own, guess=self.there.contacts, solved=(self.state, self.there.guess))

    def missed(self, time: float, state: Array, within: VehicleEvaluation, share: float, end: ContactsAtEnd) -> Array:
        """Rates (2, n) that an evaluation within the step, at a share of its length, lacks.

        What the forces lack is c^2 a + c^3 b, with value and slope at the end; its second row without the slope, c^2
        times the value.
        """
        assert within.states is not None
        v0, v, v1, c = self._values, self._values_of(within.states), end._values, share
        rise = (1.0 - c) / c * v0 - v / (c * (1.0 - c)) + (2.0 - c) / (1.0 - c) * v1  # dv/dc at the end
        value = end._wrenches - self._wrenches - _products(self._slopes, v1 - v0)
        slope = _products(end._slopes - self._slopes, rise)
        rates = []
        for lack in (c * c * (3.0 * value - slope) + c**3 * (slope - 2.0 * value), c * c * value):
            rates.append(self.dynamics.under(time, state, self._contacts(lack)).rate - within.rate)
        return np.array(rates)

    def _contacts(self, lack: Array | float) -> Callable[[Mapping[str, WheelsetState]], WheelContacts]:
        """Contacts by the states of the wheelsets, with forces (w, 2, 6) added."""

        def contacts(states: Mapping[str, WheelsetState]) -> WheelContacts:
            wrenches = self._wrenches + _products(self._slopes, self._values_of(states) - self._values) + lack
            return {
                name: {
                    side: changed(self.there.contacts[name][side], force=wrench[:3], moment=wrench[3:])
                    for side, wrench in zip(SIDES, of, strict=True)
                }
                for name, of in zip(states, wrenches, strict=True)
            }

        return contacts

    def _values_of(self, states: Mapping[str, WheelsetState]) -> Array:
        """Values (w, 2, n + 1) of all wheels; motions that a wheelset does not have are zero."""
        values = np.zeros((len(states), 2, self.tangents.shape[-1] + 1))
        for of_wheelset, state in zip(values, states.values(), strict=True):
            for row, side in zip(of_wheelset, SIDES, strict=True):
                *own, row[-1] = values_on_rail(state.turning_as(side), side, self.dynamics.vehicle.radius)
                row[: len(own)] = own
        return values

    @cached_property
    def _values(self) -> Array:
        assert self.there.states is not None
        return self._values_of(self.there.states)

    @cached_property
    def _wrenches(self) -> Array:
        """(w, 2, 6) N and N m."""
        return np.asarray(all_side_wrenches(self.there.contacts))

    @cached_property
    def _slopes(self) -> Array:
        """(w, 2, 6, n + 1), derivatives by the values."""
        assert self.there.states is not None
        parts = []
        for k, side in enumerate(SIDES):
            turning = [own.turning_as(side) for own in self.there.states.values()]
            parts.append(by_speed(self.tangents[:, [k]], turning))
        return np.concatenate([self.tangents, np.concatenate(parts, axis=1)], axis=-1)


def _products(slopes: Array, change: Array) -> Array:
    """Changes (w, 2, 6) by slopes (w, 2, 6, n), with sums of all wheels in the same order: mirrored bit for bit."""
    return np.asarray((slopes * change[:, :, None]).sum(axis=-1))
