"""Axle without mass, and under each wheel a track with mass that moves along with it.

The motions of the hubs follow the loads as in `wheelrail.contact.loading.quasi_static_structure`. Rails and sleepers
have the equations of `wheelrail.contact.structure.ballast`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from wheelrail.contact.loading.flexible_state import MOTIONS
from wheelrail.contact.loading.structure import Structure
from wheelrail.contact.structure.ballast import CoRunningTrack
from wheelrail.support.arrays import Array

HUBS, RAILS, SLEEPERS = 12, 6, 4  # motions of both sides
TRACK = RAILS + SLEEPERS
BY_SIDE = np.array([0, 1, 2, 6, 7, 3, 4, 5, 8, 9])  # rails and sleepers of the left, then of the right track


@dataclass(frozen=True)
class CoRunningStructure(Structure):
    """Motions (32,): those of `FlexibleState.motions`, of the left and the right sleepers across and normal to the
    foot, the right ones mirrored, then rates of rails and sleepers.

    Parameters:
        tracks: under the left and the right wheel, as left-hand ones.
    """

    tracks: tuple[CoRunningTrack, CoRunningTrack] = field(kw_only=True)

    @property
    def size(self) -> int:
        return len(MOTIONS) + SLEEPERS + TRACK

    @property
    def velocities(self) -> int:
        return TRACK

    @cached_property
    def by_motions(self) -> Array:
        inverse = np.linalg.inv(self._mass)
        out = np.zeros((self.size, self.size))
        out[:HUBS, :HUBS] = -np.eye(HUBS) / self.time_constant
        track, rates = slice(HUBS, HUBS + TRACK), slice(HUBS + TRACK, None)
        out[track, rates] = np.eye(TRACK)
        out[rates, track], out[rates, rates] = -inverse @ self._stiffness, -inverse @ self._damping
        return out

    @cached_property
    def by_loads(self) -> Array:
        out = np.zeros((self.size, len(MOTIONS)))
        out[:HUBS] = self.pairs.flexibility.matrix[:HUBS] / self.time_constant
        out[HUBS + TRACK :, HUBS:] = np.linalg.inv(self._mass)[:, :RAILS]
        return out

    @cached_property
    def compliance(self) -> Array:
        out = np.zeros((self.size, len(MOTIONS)))
        out[:HUBS] = self.pairs.flexibility.matrix[:HUBS]
        out[HUBS : HUBS + TRACK, HUBS:] = np.linalg.inv(self._stiffness)[:, :RAILS]
        return out

    @cached_property
    def energy_matrix(self) -> Array:
        return np.asarray(block_diag(self._hubs, self._stiffness, self._mass))

    @cached_property
    def damping(self) -> Array:
        return np.asarray(block_diag(self.time_constant * self._hubs, self._damping, np.zeros((TRACK, TRACK))))

    @property
    def _hubs(self) -> Array:
        """Stiffness (12, 12) of the axle."""
        return np.linalg.pinv(self.pairs.flexibility.matrix[:HUBS, :HUBS], rcond=1e-12, hermitian=True)

    @cached_property
    def _mass(self) -> Array:
        return self._both("mass")

    @cached_property
    def _stiffness(self) -> Array:
        return self._both("stiffness")

    @cached_property
    def _damping(self) -> Array:
        return self._both("damping")

    def _both(self, name: str) -> Array:
        """Matrix (10, 10) of both tracks, rails first."""
        out = np.zeros((TRACK, TRACK))
        out[np.ix_(BY_SIDE, BY_SIDE)] = block_diag(*(getattr(track, name) for track in self.tracks))
        return out
