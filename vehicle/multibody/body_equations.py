"""Equations of motion of all bodies of a vehicle under given contact forces, in compiled code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.applied_forces import AppliedForces
from wheelrail.vehicle.multibody.compiled.bodies import Travel
from wheelrail.vehicle.multibody.compiled.derivatives import derivatives
from wheelrail.vehicle.multibody.compiled.equations import (
    VehicleArrays,
    accelerations,
    element_states,
    near,
    sections,
)
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.suspension_forces import SuspensionForces
from wheelrail.vehicle.multibody.vehicle_arrays import vehicle_arrays
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.track.speed_profile import TrackPosition


class Accelerations(NamedTuple):
    """Accelerations under given contact forces.

    Parameters:
        rates: (c + m,) of the free coordinates, then m/s of the components for the springs of Maxwell elements.
        reactions: (n, 6) N and N m, generalised forces of the constraints of held coordinates; for free ones, their
            accelerations.
    """

    rates: Array
    reactions: Array


class BodyDerivatives(NamedTuple):
    """Derivatives of the accelerations (c,) of the coordinates and the rates (m,) of the components for the springs of
    Maxwell elements.

    Parameters:
        by_state: (c + m, 2 c + m).
        by_wrench: (6, c), by a component of the contact force or moment on each wheelset.
        by_time: (c + m,) at constant contact forces.
    """

    by_state: Array
    by_wrench: Array
    by_time: Array


@dataclass(frozen=True)
class BodyEquations:
    """Accelerations of n bodies, each described in the track frame at its own distance.

    Parameters:
        suspension: of the vehicle.
        track: sections of the track.
        applied: torques and forces on the vehicle.
    """

    suspension: SuspensionForces
    track: TrackSections
    applied: AppliedForces

    @property
    def coordinates(self) -> Coordinates:
        return self.suspension.coordinates

    @cached_property
    def arrays(self) -> VehicleArrays:
        return vehicle_arrays(self.suspension, self.track, self.applied)

    def sections(self, travel: TrackPosition, state: Array) -> Array:
        """Track sections (n, 6, 3) at the bodies: position m, axes, rotation per length rad/m and its derivative.

        Parameters:
            travel: reference motion along the track.
            state: (2 c + m,).
        """
        distance, whole = float(travel.distance), self._all(state)
        return sections(self.arrays, distance, near(distance, whole), whole)

    def accelerations(self, travel: TrackPosition, state: Array, wrenches: Array, at: Array) -> Accelerations:
        """Accelerations of the coordinates, rates of Maxwell elements, and forces of constraints.

        Parameters:
            travel: reference motion along the track.
            state: (2 c + m,).
            wrenches: (w, 6) force N and moment N m about the centre of each wheelset, in its track frame.
            at: (n, 6, 3), sections of the track at the bodies.
        """
        contact = self._contact(wrenches)
        values = accelerations(self.arrays, at, _travel(travel), self._all(state), contact)
        reactions = values[: self.coordinates.held.size].reshape(-1, 6)
        return Accelerations(self._in_components(values[self._rows]), reactions)

    def derivatives(self, travel: TrackPosition, jerk: float, state: Array, wrenches: Array) -> BodyDerivatives:
        """Exact derivatives; jerk m/s3 of the reference motion, other parameters as for `accelerations`."""
        rates = Travel(travel.speed, travel.acceleration, jerk, 1.0)
        contact, coordinates, count = self._contact(wrenches), self.coordinates, self.coordinates.count
        columns = coordinates.within_all
        found = derivatives(self.arrays, _travel(travel), rates, self._all(state), columns, contact)
        by_state, by_time = found.by_state, found.by_time
        if coordinates.maxwell:
            by_state[count:], by_time[count:] = (coordinates.from_series @ v[count:] for v in (by_state, by_time))
            by_state[:, 2 * count :] = by_state[:, 2 * count :] @ coordinates.series
        return BodyDerivatives(by_state, found.by_wrench[:, :count], by_time)

    def element_states(self, travels: Sequence[TrackPosition], states: Array) -> tuple[Array, Array]:
        """Deflections m and forces N (r, e, 3) of the suspension elements on the upper bodies, in the elements' axes.

        Parameters:
            travels: reference motion along the track, of r states.
            states: (r, 2 c + m).
        """
        motion = np.array(travels, dtype=float).reshape(-1, 4)
        values = element_states(self.arrays, motion, self._all(states))
        return values[:, 0], values[:, 1]

    @cached_property
    def _rows(self) -> NDArray[np.int64]:
        """Indices (c + m,) of free coordinates and Maxwell elements among all."""
        return self.coordinates.within_all[self.coordinates.count :] - self.coordinates.held.size

    def _in_components(self, rates: Array) -> Array:
        """Rates (..., c + m) with those of the springs of Maxwell elements as components of the state."""
        if self.coordinates.maxwell:
            springs = rates[..., self.coordinates.count :]
            rates[..., self.coordinates.count :] = springs @ self.coordinates.from_series.T
        return rates

    def _all(self, state: Array) -> Array:
        """States (..., 12 n + m) with held coordinates."""
        return self.coordinates.expanded(state)

    def _contact(self, wrenches: Array) -> Array:
        """Contact forces and moments (n, 2, 3) on all bodies."""
        result = np.zeros((len(self.coordinates.vehicle.names), 2, 3))
        result[self.coordinates.wheelset_bodies] = wrenches.reshape(-1, 2, 3)
        return result


def _travel(travel: TrackPosition) -> Travel:
    return Travel(*(float(value) for value in travel))
