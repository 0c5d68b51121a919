"""Axle and rails as massless springs with dampers in parallel, whose motions are states of a time integration.

With the compliance C, the motions e_0 without load and the loads w of the contacts, the motions e follow

    tau e' = e_0 + C w - e.

Dampers are proportional to the springs. Below 1 / (2 pi tau) the motions are those of static equilibrium; there are no
resonances of axle and rails, the lowest of which is that of a wheel turning on its axle, near 100 Hz. On discrete
sleepers C changes along the track.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.loading.flexible_state import HUB_MOTIONS, MOTIONS, RAIL_MOTIONS, of_parts
from wheelrail.contact.loading.structure import Structure
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class QuasiStaticStructure(Structure):
    """Rates of the motions of hubs and rails."""

    @property
    def sizes(self) -> tuple[int, ...]:
        return len(HUB_MOTIONS), len(RAIL_MOTIONS)

    @cached_property
    def by_motions(self) -> Array:
        return -np.eye(len(MOTIONS)) / self.time_constant

    @cached_property
    def by_loads(self) -> Array:
        return self.compliance / self.time_constant

    @cached_property
    def compliance(self) -> Array:
        return of_parts(self.pairs.flexibility.matrix)

    @cached_property
    def energy_matrix(self) -> Array:
        return np.asarray(np.linalg.pinv(self.compliance, rcond=1e-12, hermitian=True))

    @property
    def damping(self) -> Array:
        return self.time_constant * self.energy_matrix

    def rates(self, motions: Array, loads: Array) -> Array:
        return np.asarray((self.unloaded + self.compliance @ loads - motions) / self.time_constant)

    def rates_by_distance(self, motions: Array, loads: Array) -> Array:
        return np.asarray(of_parts(self.pairs.flexibility.matrix_slope) @ loads / self.time_constant)

    def energy_by_distance(self, motions: Array) -> float:
        load = self.energy_matrix @ (motions - self.unloaded)
        return float(-0.5 * load @ of_parts(self.pairs.flexibility.matrix_slope) @ load)
