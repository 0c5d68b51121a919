"""Twists of wheelsets with independent wheels: half the angle of the left wheel less that of the right one.

With the inertia J of both wheels about the axle e, a spring k and a damper c between them, and the moments M of the
contacts, J twist'' = (M_left - M_right) . e - 4 (k twist + c twist'). The mean of both angles is the pitch of the
wheelset: both wheels together have its angular momentum, so that its equations are those of a rigid one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import cos, sin
from typing import NamedTuple

import numpy as np

from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.coordinates import ROLL, YAW, Coordinates


class TwistSlopes(NamedTuple):
    """Derivatives of the accelerations (t,) of t twists.

    Parameters:
        by_state: (t, 2 c + m), at constant moments of the contacts.
        by_wrench: (t, 2, 6), by force and moment of the left and the right contact of the own wheelset.
    """

    by_state: Array
    by_wrench: Array


@dataclass(frozen=True)
class Twists:
    """Equations of t twists.

    Parameters:
        coordinates: of the vehicle.

    Wrenches (w, 2, 6) N and N m are those of the left and the right contacts of all w wheelsets.
    """

    coordinates: Coordinates

    def __bool__(self) -> bool:
        return bool(self.coordinates.vehicle.independent)

    def accelerations(self, state: Array, states: Mapping[str, WheelsetState], wrenches: Array) -> Array:
        """Accelerations (t,) rad/s2 in a state of the vehicle, and of its wheelsets."""
        twist, rate = state[self.coordinates.twists], state[self.coordinates.twist_rates]
        spring, damper = self._torsion
        moments = (self._axles(states) * self._pulls(wrenches)).sum(axis=1)
        return np.asarray((moments - 4.0 * (spring * twist + damper * rate)) / self._inertia)

    def slopes(self, states: Mapping[str, WheelsetState], wrenches: Array) -> TwistSlopes:
        """Derivatives of the accelerations."""
        c, own = self.coordinates, range(len(self._inertia))
        by_state, by_wrench = np.zeros((len(own), c.size)), np.zeros((len(own), 2, 6))
        spring, damper = self._torsion
        by_state[own, np.arange(c.size)[c.twists]] = -4.0 * spring
        by_state[own, np.arange(c.size)[c.twist_rates]] = -4.0 * damper
        by_wrench[:, 0, 3:] = self._axles(states)
        by_wrench[:, 1, 3:] = -by_wrench[:, 0, 3:]
        for i, (name, (x, y, z)) in enumerate(zip(c.vehicle.independent, self._pulls(wrenches).tolist(), strict=True)):
            roll, yaw = states[name].roll, states[name].yaw
            changes = {
                ROLL: x * sin(yaw) * sin(roll) - y * cos(yaw) * sin(roll) + z * cos(roll),
                YAW: -(x * cos(yaw) + y * sin(yaw)) * cos(roll),
            }
            for coordinate, index in c.free_indices(name, changes).items():
                by_state[i, index] = changes[coordinate]
        return TwistSlopes(by_state / self._inertia[:, None], by_wrench / self._inertia[:, None, None])

    def energy_rates(self, state: Array, states: Mapping[str, WheelsetState], wrenches: Array) -> tuple[float, ...]:
        """Energy J, and powers W of contacts and dampers."""
        twist, rate = state[self.coordinates.twists], state[self.coordinates.twist_rates]
        spring, damper = self._torsion
        power = rate @ (self._axles(states) * self._pulls(wrenches)).sum(axis=1)
        energy = 0.5 * self._inertia @ rate**2 + 2.0 * spring @ twist**2
        return float(energy), float(power), -4.0 * float(damper @ rate**2)

    def spins(self, state: Array) -> Array:
        """Spins (.., w, 2) rad/s of the left and the right wheels less the mean of their wheelset."""
        result = np.zeros((*state.shape[:-1], len(self.coordinates.vehicle.wheelsets), 2))
        rates = state[..., self.coordinates.twist_rates]
        result[..., self.wheelsets, :] = np.stack([rates, -rates], axis=-1)
        return result

    @cached_property
    def wheelsets(self) -> list[int]:
        """Indices (t,) among the wheelsets."""
        vehicle = self.coordinates.vehicle
        return [vehicle.wheelsets.index(name) for name in vehicle.independent]

    @cached_property
    def _inertia(self) -> Array:
        """(t,) kg m2."""
        bodies = self.coordinates.vehicle.bodies
        return np.array([bodies[name].inertia[1] for name in self.coordinates.vehicle.independent])

    @cached_property
    def _torsion(self) -> Array:
        """Springs (t,) N m/rad and dampers (t,) N m s/rad."""
        bodies = self.coordinates.vehicle.bodies
        return np.array([bodies[name].torsion for name in self.coordinates.vehicle.independent]).T

    def _axles(self, states: Mapping[str, WheelsetState]) -> Array:
        """Axes (t, 3)."""
        return np.array([states[name].rotation[:, 1] for name in self.coordinates.vehicle.independent])

    def _pulls(self, wrenches: Array) -> Array:
        """Moments (t, 3) N m of the left less the right contact."""
        own = wrenches[self.wheelsets]
        return np.asarray(own[:, 0, 3:] - own[:, 1, 3:])
