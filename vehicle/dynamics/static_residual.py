"""What is left of the forces on a wagon that should be at rest."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Contacts, Dynamics, Wrench
from wheelrail.vehicle.dynamics.jacobian import Jacobian
from wheelrail.vehicle.dynamics.state import COUNT, PITCH, ROLL, Y, Z
from wheelrail.vehicle.integration.problem import StepFailure
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.track.frame import Frame

# Of nine positions and the relative excess of spin: what is small (for differences), and the most one step changes.
SMALL = np.array([1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 2e-6, 5e-7, 5e-7, 1e-5])
LARGE = np.array([3e-2, 3e-2, 2e-2, 3e-3, 3e-3, 5e-3, 1e-3, 2e-4, 1e-3, 1e-3])
SEEN_BY_CONTACT = [Y, Z, ROLL, PITCH]
SEEN_IN_TANGENT = [0, 1, 2, 7]  # y, z, roll and the rate of pitch


def size_of(vector: Array) -> float:
    return float(np.max(np.abs(vector)))


@dataclass(frozen=True)
class StaticResidual:
    """Forces that are left, over the axle load; unknown (10,): positions, then spin over nominal spin, less one.

    Springs in series with dampers are not stretched at rest. Contacts are solved from nothing: where they depend a
    little on where they come from, a balance would depend on the way to it.
    """

    dynamics: Dynamics
    frame: Frame

    @cached_property
    def weights(self) -> Array:
        """Masses and inertias over the axle load, which act on arms of 1 m (roll) and one wheel radius (spin)."""
        mass, roll, pitch, _, _ = self.dynamics.constants
        wagon = self.dynamics.wagon
        rows = np.stack([mass, mass, roll], axis=1).ravel()
        return np.append(rows, pitch[2] / wagon.radius) / wagon.axle_load

    def state(self, unknown: Array) -> Array:
        state = np.zeros(self.dynamics.size)
        state[:9], state[COUNT + PITCH] = unknown[:9], unknown[9] * self.dynamics.rolling_rate(self.frame)
        return state

    def unknown(self, state: Array) -> Array:
        return np.append(state[:9], state[COUNT + PITCH] / self.dynamics.rolling_rate(self.frame))

    def contacts(self, unknown: Array) -> Contacts:
        return self.dynamics.solve_contacts(self.frame, self.state(unknown), None)

    def residual(self, unknown: Array, contacts: Contacts) -> Array:
        left, _ = self.dynamics.accelerations(self.frame, self.state(unknown), Wrench.of(contacts))
        return self.weights * left[:COUNT]

    def jacobian(self, unknown: Array, contacts: Contacts, residual: Array) -> Array:
        """By the contact's tangent, or four differences of the contact."""
        state, linear = self.state(unknown), Jacobian(self.dynamics, StepStatistics())
        tangents = linear.known(self.dynamics.wheelset_state(self.frame, state), contacts)
        columns = []
        for i, small in enumerate(SMALL):
            moved = unknown.copy()
            moved[i] += small
            solved = tangents is None and i in SEEN_BY_CONTACT
            there = self.contacts(moved) if solved else contacts
            columns.append((self.residual(moved, there) - residual) / small)
        result: Array = np.stack(columns, axis=1)
        if tangents is not None:
            seen = tangents.sum(axis=0)[:, SEEN_IN_TANGENT] * [1.0, 1.0, 1.0, self.dynamics.rolling_rate(self.frame)]
            result[:, SEEN_BY_CONTACT] += self.weights[:, None] * linear.by_wrench(state) @ seen
        return result

    def settled(self) -> Array:
        """All bodies upright, lowered until the contacts carry the axle load within 2 %; raises StepFailure."""
        unknown = np.zeros(COUNT)
        heights = [1, 4, Z]

        def lifted(z: float) -> float:
            unknown[heights] = z
            carried = Wrench.of(self.contacts(unknown)).force[2]
            # A Hertzian force grows as depth^(3/2): its power 2/3 is nearly straight.
            return float(np.cbrt(max(carried, 0.0) / self.dynamics.wagon.axle_load) ** 2)

        z, stride = 0.0, 5e-5
        carried = lifted(z)
        way = -1.0 if carried < 1.0 else 1.0
        other, carried_other = z, carried
        while (carried_other < 1.0) == (carried < 1.0):
            if abs(other) > 0.05:
                raise StepFailure("the wheels do not come to rest within 50 mm of the nominal height")
            z, carried = other, carried_other
            try:
                carried_other = lifted(z + way * stride)
            except StepFailure:
                if stride < 1e-7:
                    raise
                stride *= 0.25  # too deep for the contact model: more slowly from here
                continue
            other, stride = z + way * stride, 1.5 * stride
        for _ in range(40):
            middle = z + (1.0 - carried) * (other - z) / (carried_other - carried)
            value = lifted(middle)
            if abs(value - 1.0) < 0.013:
                break
            if (value < 1.0) == (carried < 1.0):
                z, carried = middle, value
            else:
                other, carried_other = middle, value
        return unknown
