"""Forces between car body, bogie and wheelset: springs, dampers, roll bar, bumpstop."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicle.elements import Element, Elements, Place
from vehicle.parts import Suspension
from vehicle.wagon import Wagon

Array = NDArray[np.float64]
CAR_BODY, BOGIE, WHEELSET = 0, 1, 2

LEFT_PRIMARY, LEFT_SECONDARY, OTHER_SIDE, STOP = 0, 2, 4, 8  # springs among the elements, dampers follow

Row = tuple[float, ...]  # upper and lower body, y and height, preload, turn


class SuspensionForces(NamedTuple):
    """on_bodies (..., 3, 3): lateral and vertical force N, roll moment N m about the centre, on car body, bogie,
    wheelset.

    deflection (..., n, 2) m and force (..., n, 2) N of the elements, lateral and vertical in their own axes, force on
    the upper body. Elements: primary spring and damper, secondary spring and damper of the left side, the same of the
    right side, bumpstop. series_rate (..., m) m/s: of the springs in series with dampers.
    """

    on_bodies: Array
    deflection: Array
    force: Array
    series_rate: Array

    @property
    def secondary_deflection(self) -> float:
        """Lateral deflection at the secondary springs, mean of both sides, m."""
        return float(0.5 * (self.deflection[2, 0] + self.deflection[6, 0]))


class Strain(NamedTuple):
    """deflection, velocity (..., n, 2) of elements in their own axes; cosine, sine (..., n) of how far these lean; arms
    (..., 2, n) m from the centres of both bodies to where the force acts.
    """

    deflection: Array
    velocity: Array
    cosine: Array
    sine: Array
    arm_y: Array
    arm_z: Array


def _rows(stage: Suspension, side: float, upper: int, lower: int, load: float) -> list[Row]:
    """Spring and damper on one side (+1 left, -1 right) of a stage that carries a static load N."""
    return [
        (upper, lower, side * stage.spring_y, stage.spring_height, 0.5 * load, stage.turn),
        (upper, lower, side * stage.damper_y, stage.damper_height, 0.0, stage.turn),
    ]


def _laws(stage: Suspension, spring: int) -> list[Element]:
    """Springs and dampers on both sides of a stage, whose left spring is the given element."""
    springs, dampers = (spring, spring + OTHER_SIDE), (spring + 1, spring + 1 + OTHER_SIDE)
    return [
        Element(Place(*springs, 0), spring=stage.lateral_stiffness),
        Element(Place(*springs, 1), spring=stage.vertical_stiffness),
        Element(Place(*dampers, 0), damper=stage.lateral_damping, series=stage.lateral_series_stiffness),
        Element(Place(*dampers, 1), damper=stage.vertical_damping, series=stage.vertical_series_stiffness),
    ]


@dataclass(frozen=True)
class Assembly:
    """All n force elements of the plane wagon, with finite rolls.

    An element joins a point of each body. Its force acts along axes that turn with the lower body (turn = 0), the upper
    (1) or in between, at a point that divides the distance of both in the same ratio: so it has a potential, and force
    and moment on the two bodies cancel in every position.

    ends (2, n) indices of upper and lower body; across, above (2, n) position of the points in their bodies, m;
    preload, turn (n,); couple (2,) N m/rad between car body and bogie, bogie and wheelset; laws of the elements' forces.
    series in arguments: deflections (..., m) of the springs in series with dampers as in `vehicle.elements`, none
    stretched if not given.
    """

    ends: NDArray[np.int64]
    across: Array
    above: Array
    preload: Array
    turn: Array
    couple: Array
    laws: Elements

    @classmethod
    def of(cls, wagon: Wagon) -> Assembly:
        """Preloads hold the nominal position on straight level track."""
        w = wagon.plane
        body, both = w.gravity * w.car_body.mass, w.gravity * (w.car_body.mass + w.bogie.mass)
        stop: Row = (CAR_BODY, BOGIE, 0.0, w.bumpstop_height, 0.0, w.secondary.turn)
        sides = [
            [*_rows(w.primary, side, BOGIE, WHEELSET, both), *_rows(w.secondary, side, CAR_BODY, BOGIE, body)]
            for side in (1.0, -1.0)
        ]
        table = np.array([*sides[0], *sides[1], stop]).T
        ends = table[:2].astype(np.int64)
        heights = np.array([w.car_body.height, w.bogie.height, w.wheelset.height])
        laws = [
            *_laws(w.primary, LEFT_PRIMARY),
            *_laws(w.secondary, LEFT_SECONDARY),
            Element(Place(STOP, STOP, 0), spring=w.bumpstop),
        ]
        return cls(
            ends=ends,
            across=np.stack([table[2], table[2]]),
            above=table[3] - heights[ends],
            preload=table[4],
            turn=table[5],
            couple=np.array([w.roll_bar + 2 * w.secondary.bending_stiffness, 2 * w.primary.bending_stiffness]),
            laws=Elements.of(laws, len(table.T)),
        )

    @cached_property
    def reach(self) -> Array:
        """(2, n): from the element's end on each body to where its force acts, as a share of the gap."""
        return np.stack([-self.turn, 1.0 - self.turn])

    @cached_property
    def incidence(self) -> tuple[Array, Array]:
        """Two of (3, 5): which body is the upper, less which is the lower one, of a pair of elements or the stop."""
        pairs = self.ends[:, [0, 1, 2, 3, 8]]
        upper, lower = (np.arange(3)[:, None] == pairs[:, None, :]).astype(float)
        return upper, -lower

    def strain(self, position: Array, rate: Array) -> Strain:
        """At position (..., 3, 3), y m, z m from the nominal height, roll rad of each body, and its rate."""
        where, moving = position[..., self.ends, :], rate[..., self.ends, :]
        # NumPy's sine of an array with gaps depends, in the last bit, on where in memory it lies.
        y, z, roll = where[..., 0], where[..., 1], np.ascontiguousarray(where[..., 2])
        vy, vz, spin = moving[..., 0], moving[..., 1], moving[..., 2]
        c, s = np.cos(roll), np.sin(roll)
        arm_y, arm_z = self.across * c - self.above * s, self.across * s + self.above * c
        gap_y, gap_z = _upper_minus_lower(y + arm_y), _upper_minus_lower(z + arm_z - self.above)
        slide_y, slide_z = _upper_minus_lower(vy - spin * arm_z), _upper_minus_lower(vz + spin * arm_y)

        upper = self.turn
        lean = upper * roll[..., 0, :] + (1.0 - upper) * roll[..., 1, :]
        lean_rate = upper * spin[..., 0, :] + (1.0 - upper) * spin[..., 1, :]
        c, s = np.cos(lean), np.sin(lean)
        slide_y, slide_z = slide_y + lean_rate * gap_z, slide_z - lean_rate * gap_y
        deflection = np.stack([c * gap_y + s * gap_z, c * gap_z - s * gap_y], axis=-1)
        velocity = np.stack([c * slide_y + s * slide_z, c * slide_z - s * slide_y], axis=-1)
        arm_y += self.reach * gap_y[..., None, :]
        arm_z += self.reach * gap_z[..., None, :]
        return Strain(deflection, velocity, c, s, arm_y, arm_z)

    def forces(self, position: Array, rate: Array, series: Array | None = None) -> SuspensionForces:
        """Forces at position and rate (..., 3, 3) as for `strain`."""
        series = self._unstretched(position) if series is None else series
        deflection, velocity, c, s, arm_y, arm_z = self.strain(position, rate)
        force = self.laws.force(deflection, velocity, series)
        force[..., 1] += self.preload

        fy = c * force[..., 0] - s * force[..., 1]
        fz = s * force[..., 0] + c * force[..., 1]
        on_bodies = np.zeros(position.shape)
        for i, incidence in enumerate(self.incidence):
            each = np.stack([fy, fz, arm_y[..., i, :] * fz - arm_z[..., i, :] * fy], axis=-1)
            # Left and right first: the mirror image of a state then has the mirrored forces to the last bit.
            on_bodies += incidence @ np.concatenate([each[..., :4, :] + each[..., 4:8, :], each[..., 8:, :]], axis=-2)
        couple = self.couple * (position[..., :2, 2] - position[..., 1:, 2])
        on_bodies[..., :2, 2] -= couple
        on_bodies[..., 1:, 2] += couple
        return SuspensionForces(on_bodies, deflection, force, self.laws.series_rate(velocity, series))

    def stored_energy(self, position: Array, series: Array | None = None) -> Array:
        """Potential energy (...) J of springs, preloads, roll bar, bending and bumpstop; 0 in the nominal position."""
        series = self._unstretched(position) if series is None else series
        deflection = self.strain(position, np.zeros(position.shape)).deflection
        turned = position[..., :2, 2] - position[..., 1:, 2]
        bent, lifted = 0.5 * turned**2 @ self.couple, deflection[..., 1] @ self.preload
        return np.asarray(self.laws.energy(deflection, series) + bent - lifted)

    def dissipated_power(self, position: Array, rate: Array, series: Array | None = None) -> Array:
        """Power (...) W that the dampers turn into heat."""
        series = self._unstretched(position) if series is None else series
        return self.laws.dissipated(self.strain(position, rate).velocity, series)

    def _unstretched(self, position: Array) -> Array:
        return np.zeros((*position.shape[:-2], self.laws.states))


def _upper_minus_lower(pair: Array) -> Array:
    return np.asarray(pair[..., 0, :] - pair[..., 1, :])
