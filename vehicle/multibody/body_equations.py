"""Equations of motion of all bodies of a vehicle under given contact forces, in compiled code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wheelrail.bindings._vehicle import Vehicle
from wheelrail.support.arrays import Array
from wheelrail.vehicle.multibody.applied_forces import AppliedForces
from wheelrail.vehicle.multibody.coordinates import Coordinates
from wheelrail.vehicle.multibody.suspension_arrays import SuspensionArrays
from wheelrail.vehicle.multibody.vehicle_core import vehicle_core
from wheelrail.vehicle.track.section_poses import TrackSections
from wheelrail.vehicle.track.speed_profile import TrackPosition


class Accelerations(NamedTuple):
    """Accelerations under given contact forces.

    Parameters:
        rates: (c + m,) of the free coordinates, then m/s of the components for internal variables of elements.
        reactions: (n, 6) N and N m, generalised forces of the constraints of held coordinates; for free ones, their
            accelerations.
    """

    rates: Array
    reactions: Array


class BodyDerivatives(NamedTuple):
    """Derivatives of the accelerations (c,) of the coordinates and the rates (m,) of the components for internal
    variables. Sliders stay where they are within a step: derivatives by their places are zero.

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

    suspension: SuspensionArrays
    track: TrackSections
    applied: AppliedForces

    @property
    def coordinates(self) -> Coordinates:
        return self.suspension.coordinates

    @cached_property
    def core(self) -> Vehicle:
        return vehicle_core(self.suspension, self.track, self.applied)

    def sections(self, travel: TrackPosition, state: Array) -> Array:
        """Track sections (n, 6, 3) at the bodies: position m, axes, rotation per length rad/m and its derivative.

        Parameters:
            travel: reference motion along the track.
            state: (2 c + m,).
        """
        return self.core.sections(travel.distance, self._all(state))

    def accelerations(self, travel: TrackPosition, state: Array, wrenches: Array, at: Array) -> Accelerations:
        """Accelerations of the coordinates, rates of internal variables, and forces of constraints.

        Parameters:
            travel: reference motion along the track.
            state: (2 c + m,).
            wrenches: (w, 6) force N and moment N m about the centre of each wheelset, in its track frame.
            at: (n, 6, 3), sections of the track at the bodies.
        """
        values = self.core.accelerations(travel, self._all(state), at, self._contact(wrenches))
        reactions = values[: self.coordinates.held.size].reshape(-1, 6)
        return Accelerations(self._in_components(values[self._rows]), reactions)

    def derivatives(self, travel: TrackPosition, jerk: float, state: Array, wrenches: Array) -> BodyDerivatives:
        """Exact derivatives; jerk m/s3 of the reference motion, other parameters as for `accelerations`."""
        coordinates, count = self.coordinates, len(self.coordinates.free)
        rates = travel.speed, travel.acceleration, jerk, 1.0
        found = self.core.derivatives(travel, rates, self._all(state), self._contact(wrenches))
        by_state, by_time = found[0][self._rows[:, None], coordinates.within_all], found[1][self._rows]
        if coordinates.internal:
            by_state[count:], by_time[count:] = (coordinates.from_series @ v[count:] for v in (by_state, by_time))
            by_state[:, 2 * count :] = by_state[:, 2 * count :] @ coordinates.series
        by_wrench = np.zeros_like(found[2])
        by_wrench[coordinates.wheelset_bodies] = found[2][coordinates.wheelset_bodies]
        return BodyDerivatives(by_state, by_wrench.reshape(-1, 6)[coordinates.free].T, by_time)

    def element_states(self, travels: Sequence[TrackPosition], states: Array) -> tuple[Array, Array]:
        """Deflections m and forces N (r, e, 3) of the suspension elements on the upper bodies, in the elements' axes.

        Parameters:
            travels: reference motion along the track, of r states.
            states: (r, 2 c + m).
        """
        whole = zip(travels, self._all(states), strict=True)
        rows = [self.core.element_states(at, state, self.core.sections(at.distance, state)) for at, state in whole]
        values = np.array(rows).reshape(-1, 5, len(self.coordinates.vehicle.elements), 3)
        return values[:, 0], values[:, 2]

    def friction_limits(self, travel: TrackPosition, state: Array) -> Array:
        """Largest friction (f,) N of the sliders."""
        whole = self._all(state)
        rows = self.core.element_states(travel, whole, self.core.sections(travel.distance, whole))
        return np.array([rows[4][place] for place in self.coordinates.sliders])

    def stuck(self, travel: TrackPosition, state: Array) -> Array:
        """State with all sliders where their springs are unloaded."""
        found, components = state.copy(), self.coordinates.slider_components
        (deflections,), _ = self.element_states([travel], state[None])
        places = np.zeros(len(self.coordinates.internal))
        numbers = components - 2 * self.coordinates.count
        places[numbers] = [deflections[place] for place in self.coordinates.sliders]
        found[components] = (self.coordinates.from_series @ places)[numbers]
        return found

    def settled(self, travels: tuple[TrackPosition, TrackPosition], states: tuple[Array, Array]) -> tuple[Array, Array]:
        """State at the end of a step with sliders drawn along, and errors m of the sliders, (2 c + m + k,) each.

        Errors are those of stages, in which deflections that turn back do not draw sliders along.

        Parameters:
            travels: reference motion along the track at the start and the end.
            states: (2 c + m + k,) there; the sliders count from the start.
        """
        whole = [self._all(state) for state in states]
        sections = [self.core.sections(at.distance, state) for at, state in zip(travels, whole, strict=True)]
        internal, turned = self.core.settled(travels, whole, sections)
        state, errors, components = states[1].copy(), np.zeros_like(states[1]), self.coordinates.slider_components
        numbers = components - 2 * self.coordinates.count
        state[components] = (self.coordinates.from_series @ internal)[numbers]
        errors[components] = (np.abs(self.coordinates.from_series) @ turned)[numbers]
        return state, errors

    def motions(self, travel: TrackPosition, state: Array) -> tuple[Array, Array]:
        """Position m, velocity m/s, axes and angular velocity rad/s (n, 6, 3) of bodies. Force N and moment N m (n, 2,
        3) of suspension, loads and speed hold about their centres; all in common axes.

        Parameters:
            travel: reference motion along the track.
            state: (2 c + m,).
        """
        whole = self._all(state)
        return self.core.motions(travel, whole, self.core.sections(travel.distance, whole))

    def load_values(self, travel: TrackPosition, state: Array) -> tuple[Array, Array]:
        """Torques (p,) N m about the axles, and components (f, 3) N of the forces along the axes of the sections."""
        whole = self._all(state)
        return self.core.load_values(travel, whole, self.core.sections(travel.distance, whole))

    def energy_rates(self, travel: TrackPosition, state: Array, wrenches: Array) -> tuple[float, ...]:
        """Kinetic and elastic energy J in the moving track frames, and powers W; parameters as for `accelerations`.

        Powers are those of contacts, dampers, gravity, inertial forces of the frames, applied loads, and friction.
        """
        whole = self._all(state)
        at = self.core.sections(travel.distance, whole)
        return tuple(self.core.energy_rates(travel, whole, at, self._contact(wrenches)))

    @cached_property
    def _rows(self) -> NDArray[np.int64]:
        """Indices (c + m,) of free coordinates and internal variables among all."""
        return self.coordinates.within_all[len(self.coordinates.free) :] - self.coordinates.held.size

    def _in_components(self, rates: Array) -> Array:
        """Rates (..., c + m) of the state, of which internal variables are components."""
        if self.coordinates.internal:
            count = len(self.coordinates.free)
            springs = rates[..., count:]
            rates[..., count:] = springs @ self.coordinates.from_series.T
        return rates

    def _all(self, state: Array) -> Array:
        """States (..., 12 n + m) with held coordinates."""
        return self.coordinates.expanded(state)

    def _contact(self, wrenches: Array) -> Array:
        """Contact forces and moments (n, 2, 3) on all bodies."""
        result = np.zeros((len(self.coordinates.vehicle.names), 2, 3))
        result[self.coordinates.wheelset_bodies] = wrenches.reshape(-1, 2, 3)
        return result
