"""Axle and rails as massless springs with dampers in parallel, whose motions are states of a time integration.

With the compliance C, the motions e_0 without load and the loads w of the contacts, the motions e follow

    tau e' = e_0 + C w - e.

Dampers are proportional to the springs. Below 1 / (2 pi tau) the motions are those of static equilibrium; there are no
resonances of axle and rails, the lowest of which is that of a wheel turning on its axle, near 100 Hz. On discrete
sleepers C changes along the track.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.loading.flexible_contact import FlexiblePairs
from wheelrail.contact.loading.flexible_state import MOTIONS, FlexibleState
from wheelrail.contact.loading.flexible_wheelset import COLUMNS, structural
from wheelrail.contact.solvers.tangent import MIRRORED
from wheelrail.support.arrays import Array

TIME_CONSTANT = 1e-3  # s


@dataclass(frozen=True)
class QuasiStaticStructure:
    """Rates of the motions of hubs and rails, in the order of `FlexibleState.motions`.

    Parameters:
        pairs: of both sides.
        time_constant: tau, s, damping over stiffness.
    """

    pairs: FlexiblePairs
    time_constant: float = TIME_CONSTANT

    @property
    def size(self) -> int:
        """Number of motions."""
        return len(MOTIONS)

    @property
    def period(self) -> float:
        """Distance m along the track after which the compliance is the same again; infinite where it is constant."""
        return min((rail.spacing for rail in self.pairs.flexibility.rails or ()), default=np.inf)

    def at(self, distance: float) -> QuasiStaticStructure:
        """The structure at a distance m along the track."""
        flexibility = self.pairs.flexibility
        if not flexibility.varies:
            return self
        return replace(self, pairs=replace(self.pairs, flexibility=flexibility.moved(distance)))

    def moved(self, state: WheelsetState, motions: Array) -> FlexibleState:
        """State of the wheelset with motions (18,) m and rad."""
        values = {f.name: getattr(state, f.name) for f in fields(WheelsetState)}
        return FlexibleState(**values, motions=tuple(motions.tolist()))

    def loads(self, state: WheelsetState, wrenches: Array) -> Array:
        """Loads (18,) N and N m on both hubs, then on both rails, conjugate to the motions.

        Parameters:
            state: of the wheelset with its motions, from `moved`.
            wrenches: (2, 6), force N on the left and the right wheel, and moment N m about the wheelset's centre.
        """
        mirrored = self._mirrored(wrenches)
        return structural(
            np.stack([self.pairs.pair(state, s).load_matrix @ w for s, w in zip(SIDES, mirrored, strict=True)])
        )

    def rates(self, motions: Array, loads: Array) -> Array:
        """Rates (18,) m/s and rad/s of motions (18,) under loads (18,)."""
        elastic = self.pairs.flexibility
        return np.asarray((elastic.unloaded + elastic.matrix @ loads - motions) / self.time_constant)

    def rate_slopes(self, state: WheelsetState, wrenches: Array, tangents: Array) -> Array:
        """Derivatives (2, 18, 27) of the rates at constant motions, by `FlexibleState.coordinates`: parts of the left
        and the right contact.

        Parameters:
            state, wrenches: as for `loads`.
            tangents: (2, 6, 27), derivatives of the wrenches.
        """
        slopes = np.zeros((2, 2, 9, COLUMNS))  # of both contacts, loads by side
        for index, (side, wrench) in enumerate(zip(SIDES, self._mirrored(wrenches), strict=True)):
            pair, tangent = self.pairs.pair(state, side), tangents[index]
            by_wrench = pair.load_matrix @ (MIRRORED[:, None] * tangent if index else tangent)
            slopes[index, index] = by_wrench + self.pairs.by_coordinates(pair.load_change(wrench), side)
        loads = np.stack([structural(own) for own in slopes])
        return np.asarray(self.pairs.flexibility.matrix @ loads / self.time_constant)

    def rates_by_distance(self, loads: Array) -> Array:
        """Derivative (18,) of the rates by the distance along the track at constant motions, for loads (18,)."""
        return np.asarray(self.pairs.flexibility.matrix_slope @ loads / self.time_constant)

    def energy_by_distance(self, motions: Array) -> float:
        """Derivative J/m of the elastic energy of motions (18,) by the distance: force along the track."""
        load = self._stiffness @ (motions - self.pairs.flexibility.unloaded)
        return float(-0.5 * load @ self.pairs.flexibility.matrix_slope @ load)

    def energy(self, motions: Array) -> Array:
        """Elastic energy (...) J of motions (..., 18), without that of the wheelset's own weight."""
        strain = motions - self.pairs.flexibility.unloaded
        return np.asarray(0.5 * np.einsum("...i,ij,...j->...", strain, self._stiffness, strain))

    def dissipated_power(self, rates: Array) -> Array:
        """Power (...) W of the dampers at rates (..., 18)."""
        return np.asarray(self.time_constant * np.einsum("...i,ij,...j->...", rates, self._stiffness, rates))

    @cached_property
    def _stiffness(self) -> Array:
        return np.linalg.pinv(self.pairs.flexibility.matrix, rcond=1e-12, hermitian=True)

    @staticmethod
    def _mirrored(wrenches: Array) -> Array:
        """Wrenches of both wheels as left-hand ones."""
        return np.stack([wrenches[0], MIRRORED * wrenches[1]])
