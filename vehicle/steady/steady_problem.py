"""Unbalanced forces of a vehicle at rest in its track frames, and their derivatives."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from wheelrail.support.arrays import Array
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.multibody.equations import (
    VehicleDynamics,
    VehicleEvaluation,
    WheelContacts,
)
from wheelrail.vehicle.multibody.jacobian import VehicleJacobian

# Largest changes in a Newton step, m and rad, of x, y, z, roll, pitch, yaw of bodies and of wheelsets.
LARGEST_CHANGE = (1e-2, 2e-2, 2e-2, 1e-2, 2e-3, 1e-2)
LARGEST_OF_WHEELSETS = (1e-2, 5e-3, 1e-3, 2e-3, 2e-3, 5e-3)
LARGEST_SPIN = 1e-3  # of nominal rolling
LARGEST_TWIST = 1e-2  # rad
MOTION = 1e-3  # m and rad, of axle and rails: as much in the residual as a wheel load, and largest in a Newton step
NEEDED = ("y", "z", "roll", "yaw", "pitch_rate")  # coordinates of the wheelsets among the unknowns


@dataclass(frozen=True)
class SteadyProblem:
    """Unbalanced forces over the mean wheel load; unknowns (u,): free coordinates but the angles of rolling, the spins
    in place of these, and motions of axle and rails, whose errors are over 1 mm and 1 mrad.

    Parameters:
        dynamics: on a track of constant curvature, cant and gradient, at constant speed.
        time: s, that of its distance along the track.
        counts: call statistics.
    """

    dynamics: VehicleDynamics
    time: float
    counts: StepStatistics = field(default_factory=StepStatistics)

    @classmethod
    def of(cls, dynamics: VehicleDynamics, time: float) -> SteadyProblem:
        """At the speed, curvature, cant and gradient at a time s, on smooth rails."""
        (s, speed, *_), line = dynamics.speed_profile(time), dynamics.track
        if (
            line.irregularities is None
            and all(len(f.values) == 1 for f in (*line.functions, line.friction))
            and dynamics.speed_profile.constant
        ):
            return cls(dynamics, time)
        track = line.changed(s, lambda f: type(f).constant(f(s)[0]))
        return cls(replace(dynamics, track=track, speed=speed), s / speed)

    @cached_property
    def unknowns(self) -> NDArray[np.int64]:
        """Indices (u,) in the state."""
        coordinates = self.dynamics.coordinates
        indices = np.arange(coordinates.count)
        indices[coordinates.forceless] += coordinates.count
        return np.concatenate([indices, np.arange(coordinates.size, self.dynamics.size)])

    def at_rest(self, state: Array) -> Array:
        """The state with its unknowns only: no rates but the spins, internal variables of elements zero."""
        result = np.zeros_like(state)
        result[self.unknowns] = state[self.unknowns]
        return result

    def settled(self, state: Array) -> Array:
        """The state with sliders of friction after motion in one direction from the nominal position."""
        if self.dynamics.settle is None:
            return state
        return self.dynamics.settle(self.time, state, self.time, state)[0]

    @cached_property
    def largest(self) -> Array:
        """(u,) largest change of each unknown in a Newton step."""
        d, bodies = self.dynamics, self.dynamics.vehicle.bodies.values()
        limits = np.ravel([LARGEST_OF_WHEELSETS if body.wheelset else LARGEST_CHANGE for body in bodies])
        limits = np.concatenate([limits[d.coordinates.free], np.full(len(d.vehicle.independent), LARGEST_TWIST)])
        limits[d.coordinates.forceless] = LARGEST_SPIN * d.speed_profile(self.time).speed / d.vehicle.radius
        return np.concatenate([limits, np.full(d.structures.size, MOTION)])

    @cached_property
    def weights(self) -> Array:
        """(c,) masses and inertias over the mean wheel load; lever arm of moments 1 m."""
        return np.asarray(self.dynamics.coordinates.inertia / self.dynamics.vehicle.mean_wheel_load)

    def contacts(self, state: Array, guess: WheelContacts | None) -> WheelContacts:
        return self.dynamics.solve_contacts(self.time, state, guess)

    def residual(self, state: Array, contacts: WheelContacts) -> Array:
        """(u,) at a state."""
        d, c = self.dynamics, self.dynamics.coordinates.count
        accelerations = d.accelerations_by(self.time, state, contacts)
        motions = self._static(state, d.structure_rates(self.time, state, contacts))
        return np.concatenate([self.weights * accelerations[:c], motions])

    def jacobian(self, state: Array, contacts: WheelContacts) -> Array:
        """(u, u) derivative of the residual by the unknowns. Raises StepFailure as `VehicleJacobian`."""
        coordinates = self.dynamics.coordinates
        linearise = VehicleJacobian(self.dynamics, self.counts, needed=NEEDED)
        matrix = linearise(self.time, state, VehicleEvaluation(np.zeros_like(state), contacts)).by_state
        matrix = matrix[:, self.unknowns]
        bodies = self.weights[:, None] * matrix[coordinates.count : 2 * coordinates.count]
        return np.concatenate([bodies, self._static(state, matrix[coordinates.size :])])

    def _static(self, state: Array, rates: Array) -> Array:
        """Distances (k, ...) of motions of axles and rails from static ones, over `MOTION`, by rates (k, ...)."""
        d = self.dynamics
        return d.structures.static(rates, d.distances(d.speed_profile(self.time), state)) / -MOTION
