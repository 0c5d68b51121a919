"""Massless axle, and under each wheel a co-running track with mass.

The motions of the hubs follow the loads as in `wheelrail.contact.loading.quasi_static_structure`. Rails and sleepers
have the equations of `wheelrail.contact.structure.ballast`, at discrete sleepers with mass and stiffness of the place.
Their states are the motions q and the reduced momenta p = M_0^-1 M(x) q', with the mean mass M_0 over a span,

    q' = M^-1 M_0 p,    M_0 p' = (l, 0) - K q - D q',

so that no speed is needed; where sleepers are spread along the rail, p are the rates of q.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from wheelrail.contact.loading.flexible_state import HUB_MOTIONS, MOTIONS, RAIL_MOTIONS, of_parts, sums_and_differences
from wheelrail.contact.loading.structure import Structure
from wheelrail.contact.structure.ballast import CoRunningTrack, of_both_sides
from wheelrail.support.arrays import Array

SIDE = (len(RAIL_MOTIONS), 2)  # motions of one rail and its sleepers
HUBS, (RAILS, SLEEPERS) = 2 * len(HUB_MOTIONS), (2 * size for size in SIDE)
TRACK = RAILS + SLEEPERS
OF_SIDES = sums_and_differences(*SIDE)
OWN, MOMENTA = slice(HUBS, HUBS + TRACK), slice(HUBS + TRACK, None)  # of the motions: those of the track, its momenta
BY_SIDE = np.array([0, 1, 2, 6, 7, 3, 4, 5, 8, 9])  # rails and sleepers of the left, then of the right track


@dataclass(frozen=True)
class CoRunningStructure(Structure):
    """Motions (32,) of hubs, rails, and sleepers across and normal to the foot, then reduced momenta of rails and
    sleepers, m/s and rad/s.

    Parameters:
        tracks: under the left and the right wheel, as left-hand ones, at any place; on rigid sleepers those under loads
            to the same side.
        mirrored_tracks: on rigid sleepers, those under loads that are mirror images; None: sides are independent.
    """

    tracks: tuple[CoRunningTrack, CoRunningTrack] = field(kw_only=True)
    mirrored_tracks: tuple[CoRunningTrack, CoRunningTrack] | None = field(default=None, kw_only=True)

    @property
    def sizes(self) -> tuple[int, ...]:
        return (len(HUB_MOTIONS), *SIDE, *SIDE)

    @property
    def velocities(self) -> int:
        return TRACK

    @cached_property
    def by_motions(self) -> Array:
        out = np.zeros((self.size, self.size))
        out[:HUBS, :HUBS] = -np.eye(HUBS) / self.time_constant
        out[OWN, MOMENTA] = self._rates
        out[MOMENTA, OWN] = -np.linalg.solve(self._mean_mass, self._stiffness)
        out[MOMENTA, MOMENTA] = -np.linalg.solve(self._mean_mass, self._damping @ self._rates)
        return out

    @cached_property
    def by_loads(self) -> Array:
        out = np.zeros((self.size, len(MOTIONS)))
        out[:HUBS] = self._axle / self.time_constant
        out[MOMENTA, HUBS:] = np.linalg.inv(self._mean_mass)[:, :RAILS]
        return out

    @cached_property
    def compliance(self) -> Array:
        out = np.zeros((self.size, len(MOTIONS)))
        out[:HUBS] = self._axle
        out[OWN, HUBS:] = np.linalg.inv(self._stiffness)[:, :RAILS]
        return out

    @cached_property
    def energy_matrix(self) -> Array:
        return np.asarray(block_diag(self._hubs, self._stiffness, self._mean_mass @ self._rates))

    @cached_property
    def damping(self) -> Array:
        return np.asarray(block_diag(self.time_constant * self._hubs, self._damping, np.zeros((TRACK, TRACK))))

    def rates_by_distance(self, motions: Array, loads: Array) -> Array:
        out, (own, momenta) = np.zeros(self.size), (motions[OWN], motions[MOMENTA])
        rates, slopes = self._rates @ momenta, self._rates_slope @ momenta
        forces = self._slope("stiffness") @ own + self._slope("damping") @ rates + self._damping @ slopes
        out[OWN], out[MOMENTA] = slopes, -np.linalg.solve(self._mean_mass, forces)
        return out

    def energy_by_distance(self, motions: Array) -> float:
        own, momenta = motions[OWN], motions[MOMENTA]
        strain, kinetic = self._slope("stiffness"), self._mean_mass @ self._rates_slope
        return float(0.5 * own @ strain @ own + 0.5 * momenta @ kinetic @ momenta)

    @cached_property
    def _axle(self) -> Array:
        """Motions (12, 18) of the hubs by the loads."""
        return of_parts(self.pairs.flexibility.matrix)[:HUBS]

    @property
    def _hubs(self) -> Array:
        """Stiffness (12, 12) of the axle."""
        return np.linalg.pinv(self._axle[:, :HUBS], rcond=1e-12, hermitian=True)

    @cached_property
    def _rates(self) -> Array:
        """Rates (10, 10) of rails and sleepers by their reduced momenta."""
        return np.linalg.solve(self._here("mass"), self._mean_mass)

    @cached_property
    def _rates_slope(self) -> Array:
        """Derivative (10, 10) of the rates by the distance along the track, 1/m."""
        return -np.linalg.solve(self._here("mass"), self._slope("mass") @ self._rates)

    @cached_property
    def _mean_mass(self) -> Array:
        return self._both(lambda track: track.mass)

    @cached_property
    def _stiffness(self) -> Array:
        return self._here("stiffness")

    @cached_property
    def _damping(self) -> Array:
        return self._here("damping")

    def _here(self, name: str) -> Array:
        """Matrix (10, 10) of both tracks at this place, rails first."""
        return self._both(lambda track: getattr(track.at(self.pairs.flexibility.place), name))

    def _slope(self, name: str) -> Array:
        """Derivative (10, 10) of a matrix of both tracks by the distance along the track, per m."""
        return self._both(lambda track: getattr(track.slope(self.pairs.flexibility.place), name))

    def _both(self, value: Callable[[CoRunningTrack], Array]) -> Array:
        """Matrix (10, 10) of even and odd parts of both tracks, rails first, of values (5, 5) of one."""
        same, mirrored = ([value(t) for t in own] if own else None for own in (self.tracks, self.mirrored_tracks))
        out = np.zeros((TRACK, TRACK))
        out[np.ix_(BY_SIDE, BY_SIDE)] = of_both_sides(same or (), mirrored)
        return np.asarray(OF_SIDES @ (out @ OF_SIDES))
