"""Results of a run as arrays over time."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.kinematics.frames import Side
from wheelrail.support.arrays import Array
from wheelrail.vehicle.dynamics.equations import Dynamics
from wheelrail.vehicle.dynamics.state import COUNT, split
from wheelrail.vehicle.integration.step_control import StepStatistics
from wheelrail.vehicle.simulation.contact_cost import ContactCost
from wheelrail.vehicle.simulation.row import Outputs, PatchPair, Row
from wheelrail.vehicle.track.speed_profile import SpeedProfile

if TYPE_CHECKING:
    from wheelrail.contact.loading.structure import Structure


@dataclass
class RunCost:
    """Cost of a run.

    Parameters:
        steps: statistics of the integrator.
        contact: call statistics by side, including the initial equilibrium.
        seconds: wall time, including the initial equilibrium.
    """

    steps: StepStatistics = field(default_factory=StepStatistics)
    contact: dict[Side, ContactCost] = field(default_factory=dict)
    seconds: float = 0.0


@dataclass(frozen=True)
class History:
    """Results of a run in n rows.

    Parameters:
        status: "completed", "interrupted" or "failed: ..." with the reason.
        speed: constant, m/s, or a `SpeedProfile`.
        radius: nominal rolling radius, m.
        time: (n,) s.
        state: (n, 20 + m + k), see `wheelrail.vehicle.dynamics.state`.
        outputs: force (n, 2, 3) N on the left and right wheel, moment (n, 2, 3) N m about the wheelset's centre, both
            in the track's axes; approach (n, 2) m; yaw_reaction (n,) N m; secondary_deflection (n,) m, lateral, of the
            car body relative to the bogie at the secondary springs; bumpstop_deflection (n,) m; bumpstop_force (n,) N
            on the car body; positive to the left.
        curvature: (n,) 1/m, positive to the left.
        lift: (n,) m, superelevation: height of the right rail above the left.
        patches, contact_status: n pairs (left, right).
        cost: of the run.
        irregularities: (n, 4) m as in `wheelrail.vehicle.track.irregularity`; None on smooth rails.
        structure: axle and rails with k motions; None: both are rigid.
    """

    status: str
    speed: float | SpeedProfile
    radius: float
    time: Array
    state: Array
    outputs: Outputs
    curvature: Array
    lift: Array
    patches: list[PatchPair]
    contact_status: list[tuple[str, str]]
    cost: RunCost
    irregularities: Array | None = None
    structure: Structure | None = None

    @classmethod
    def of(cls, dynamics: Dynamics, rows: list[Row], cost: RunCost, status: str) -> History:
        irregularities = dynamics.track.irregularities
        distances = [dynamics.speed_profile(row.time).distance for row in rows]
        return cls(
            status=status,
            speed=dynamics.speed,
            radius=dynamics.wagon.radius,
            time=np.array([row.time for row in rows]),
            state=np.array([row.state for row in rows]).reshape(-1, dynamics.size),
            outputs=Outputs.stacked([row.outputs for row in rows]),
            curvature=np.array([dynamics.track.curvature(s)[0] for s in distances]),
            lift=np.array([dynamics.track.superelevation(s)[0] for s in distances]),
            patches=[row.patches for row in rows],
            contact_status=[row.contact_status for row in rows],
            cost=cost,
            irregularities=irregularities.at(np.array(distances)) if irregularities else None,
            structure=dynamics.structure,
        )

    def __len__(self) -> int:
        return len(self.time)

    @property
    def distance(self) -> Array:
        """Distance along the track (n,), m."""
        return self._track_positions[:, 0]

    @property
    def speeds(self) -> Array:
        """Speed (n,), m/s."""
        return self._track_positions[:, 1]

    @cached_property
    def _track_positions(self) -> Array:
        return SpeedProfile.of(self.speed).positions(self.time)

    @property
    def car_body(self) -> Array:
        """y, z m and roll rad (n, 3), z from the nominal height."""
        return self.state[:, 0:3]

    @property
    def bogie(self) -> Array:
        """y, z m and roll rad (n, 3), z from the nominal height."""
        return self.state[:, 3:6]

    @property
    def wheelset(self) -> Array:
        """y, z m, roll and pitch rad (n, 4), z from the nominal height, pitch from time zero."""
        return _with_rolling(self.state[:, 6:COUNT], self.distance / self.radius)

    @property
    def car_body_rate(self) -> Array:
        """m/s and rad/s (n, 3)."""
        return self.state[:, COUNT : COUNT + 3]

    @property
    def bogie_rate(self) -> Array:
        """m/s and rad/s (n, 3)."""
        return self.state[:, COUNT + 3 : COUNT + 6]

    @property
    def wheelset_rate(self) -> Array:
        """m/s and rad/s (n, 4); the pitch rate is positive rolling forward."""
        return _with_rolling(self.state[:, COUNT + 6 : 2 * COUNT], self.speeds / self.radius)

    @property
    def series_deflection(self) -> Array:
        """Spring deflections (n, m) of Maxwell elements, m, outwards: left side, then right side."""
        return split(self.state, self._motions).series

    @property
    def structure_motion(self) -> Array:
        """Motions (n, k) of axle and rails, see `wheelrail.contact.loading.flexible_contact.MOTIONS`."""
        return split(self.state, self._motions).motions

    @property
    def _motions(self) -> int:
        return 0 if self.structure is None else self.structure.size


def _with_rolling(excess: Array, nominal: Array) -> Array:
    """Wheelset coordinates or rates (n, 4), with the nominal rolling (n,) added to the pitch."""
    total = excess.copy()
    total[:, 3] += nominal
    return total
