"""Forces between car body, bogie and wheelset: springs, dampers, roll bar, bumpstop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from wheelrail.support.arrays import Array
from wheelrail.vehicle.wagon.attachments import Attachments
from wheelrail.vehicle.wagon.components import Suspension
from wheelrail.vehicle.wagon.elements import ElementPair, ForceElement, ForceElements
from wheelrail.vehicle.wagon.wagon import Wagon

CAR_BODY, BOGIE, WHEELSET = 0, 1, 2

LEFT_PRIMARY, LEFT_SECONDARY, OTHER_SIDE, STOP = 0, 2, 4, 8  # indices of springs; their dampers follow

Row = tuple[float, ...]  # upper and lower body, y and height, preload, turn


class SuspensionForces(NamedTuple):
    """Forces of the suspension.

    Parameters:
        on_bodies: (..., 3, 3) lateral and vertical force N, roll moment N m about the centre, on car body, bogie and
            wheelset.
        deflection: (..., n, 2) m, of the elements, lateral and vertical in their own axes.
        force: (..., n, 2) N, of the elements on the upper body.
        series_rate: (..., m) m/s, rates of the spring deflections of Maxwell elements.

    Elements: primary spring and damper, secondary spring and damper of the left side, the same of the right side,
    bumpstop.
    """

    on_bodies: Array
    deflection: Array
    force: Array
    series_rate: Array

    @property
    def secondary_deflection(self) -> float:
        """Lateral deflection at the secondary springs, mean of both sides, m."""
        return float(0.5 * (self.deflection[2, 0] + self.deflection[6, 0]))


def _rows(stage: Suspension, side: float, upper: int, lower: int, load: float) -> list[Row]:
    """Spring and damper on one side (+1 left, -1 right) of a stage under a static load N."""
    return [
        (upper, lower, side * stage.spring_y, stage.spring_height, 0.5 * load, stage.turn),
        (upper, lower, side * stage.damper_y, stage.damper_height, 0.0, stage.turn),
    ]


def _laws(stage: Suspension, spring: int) -> list[ForceElement]:
    """Springs and dampers on both sides of a stage; spring: element index of the left spring."""
    springs, dampers = (spring, spring + OTHER_SIDE), (spring + 1, spring + 1 + OTHER_SIDE)
    return [
        ForceElement(ElementPair(*springs, 0), spring=stage.lateral_stiffness),
        ForceElement(ElementPair(*springs, 1), spring=stage.vertical_stiffness),
        ForceElement(ElementPair(*dampers, 0), damper=stage.lateral_damping, series=stage.lateral_series_stiffness),
        ForceElement(ElementPair(*dampers, 1), damper=stage.vertical_damping, series=stage.vertical_series_stiffness),
    ]


@dataclass(frozen=True)
class Assembly:
    """All n force elements of the plane wagon.

    Parameters:
        attachments: attachment points.
        laws: force laws.
        preload: (n,) N, vertical.
        couple: (2,) N m/rad, roll stiffness between car body and bogie, bogie and wheelset.

    Arguments of the methods: position (..., 3, 3), y m, z m from the nominal height, roll rad of each body; rate
    (..., 3, 3), its time derivative; series (..., m) m, spring deflections of Maxwell elements as in
    `wheelrail.vehicle.wagon.elements`; None: zero.
    """

    attachments: Attachments
    laws: ForceElements
    preload: Array
    couple: Array

    @classmethod
    def of(cls, wagon: Wagon) -> Assembly:
        """Suspension with the preloads of the nominal position on straight level track."""
        w = wagon.plane
        secondary_load, primary_load = w.gravity * w.car_body.mass, w.gravity * (w.car_body.mass + w.bogie.mass)
        stop: Row = (CAR_BODY, BOGIE, 0.0, w.bumpstop_height, 0.0, w.secondary.turn)
        sides = [
            [
                *_rows(w.primary, side, BOGIE, WHEELSET, primary_load),
                *_rows(w.secondary, side, CAR_BODY, BOGIE, secondary_load),
            ]
            for side in (1.0, -1.0)
        ]
        table = np.array([*sides[0], *sides[1], stop]).T
        ends = table[:2].astype(np.int64)
        heights = np.array([w.car_body.height, w.bogie.height, w.wheelset.height])
        laws = [
            *_laws(w.primary, LEFT_PRIMARY),
            *_laws(w.secondary, LEFT_SECONDARY),
            ForceElement(ElementPair(STOP, STOP, 0), spring=w.bumpstop),
        ]
        return cls(
            attachments=Attachments(ends, np.stack([table[2], table[2]]), table[3] - heights[ends], table[5]),
            laws=ForceElements.of(laws, len(table.T)),
            preload=table[4],
            couple=np.array([w.roll_bar + 2 * w.secondary.bending_stiffness, 2 * w.primary.bending_stiffness]),
        )

    def forces(self, position: Array, rate: Array, series: Array | None = None) -> SuspensionForces:
        """Forces at positions and rates (..., 3, 3)."""
        series = self._unloaded(position) if series is None else series
        strain = self.attachments.strain(position, rate)
        force = self.laws.force(strain.deflection, strain.velocity, series)
        force[..., 1] += self.preload
        on_bodies = self.attachments.on_bodies(force, strain)
        couple = self.couple * (position[..., :2, 2] - position[..., 1:, 2])
        on_bodies[..., :2, 2] -= couple
        on_bodies[..., 1:, 2] += couple
        return SuspensionForces(on_bodies, strain.deflection, force, self.laws.series_rate(strain.velocity, series))

    def stored_energy(self, position: Array, series: Array | None = None) -> Array:
        """Potential energy (...) J of springs, preloads, roll bar, bending and bumpstop; 0 in the nominal position."""
        series = self._unloaded(position) if series is None else series
        deflection = self.attachments.strain(position, np.zeros(position.shape)).deflection
        roll = position[..., :2, 2] - position[..., 1:, 2]
        roll_energy, preload_work = 0.5 * roll**2 @ self.couple, deflection[..., 1] @ self.preload
        return np.asarray(self.laws.energy(deflection, series) + roll_energy - preload_work)

    def dissipated_power(self, position: Array, rate: Array, series: Array | None = None) -> Array:
        """Power (...) W dissipated in the dampers."""
        series = self._unloaded(position) if series is None else series
        return self.laws.dissipated(self.attachments.strain(position, rate).velocity, series)

    def _unloaded(self, position: Array) -> Array:
        return np.zeros((*position.shape[:-2], self.laws.states))
