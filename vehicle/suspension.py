"""Forces between car body, bogie and wheelset: springs, dampers, roll bar, bumpstop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicle.parts import Suspension
from vehicle.wagon import Wagon

Array = NDArray[np.float64]
CAR_BODY, BOGIE, WHEELSET = 0, 1, 2

Row = tuple[float, ...]  # upper and lower body, y and height, stiffness y z, damping y z, preload, turn


class SuspensionForces(NamedTuple):
    """on_bodies (..., 3, 3): lateral and vertical force N, roll moment N m about the centre, on car body, bogie,
    wheelset.

    deflection (..., n, 2) m and force (..., n, 2) N of the elements, lateral and vertical in their own axes, force on
    the upper body. Elements: primary spring and damper, secondary spring and damper of the left side, the same of the
    right side, bumpstop.
    """

    on_bodies: Array
    deflection: Array
    force: Array

    @property
    def secondary_deflection(self) -> float:
        """Lateral deflection at the secondary springs, mean of both sides, m."""
        return float(0.5 * (self.deflection[2, 0] + self.deflection[6, 0]))


def _rows(stage: Suspension, side: float, upper: int, lower: int, load: float) -> list[Row]:
    """Spring and damper on one side (+1 left, -1 right) of a stage that carries a static load N."""
    spring = (stage.lateral_stiffness, stage.vertical_stiffness, 0.0, 0.0, 0.5 * load, stage.turn)
    damper = (0.0, 0.0, stage.lateral_damping, stage.vertical_damping, 0.0, stage.turn)
    return [
        (upper, lower, side * stage.spring_y, stage.spring_height, *spring),
        (upper, lower, side * stage.damper_y, stage.damper_height, *damper),
    ]


@dataclass(frozen=True)
class Assembly:
    """All n force elements of the plane wagon, with finite rolls.

    An element joins a point of each body. Its force acts along axes that turn with the lower body (turn = 0), the upper
    (1) or in between, at a point that divides the distance of both in the same ratio: so it has a potential, and force
    and moment on the two bodies cancel in every position.

    ends (2, n) indices of upper and lower body; across, above (2, n) position of the points in their bodies, m;
    stiffness, damping (n, 2); preload, turn (n,); couple N m/rad between car body and bogie; stop: force over
    deflection.
    """

    ends: NDArray[np.int64]
    across: Array
    above: Array
    stiffness: Array
    damping: Array
    preload: Array
    turn: Array
    couple: float
    stop: Callable[[Array], Array]

    @classmethod
    def of(cls, wagon: Wagon) -> Assembly:
        """Preloads hold the nominal position on straight level track."""
        w = wagon.plane
        body, both = w.gravity * w.car_body.mass, w.gravity * (w.car_body.mass + w.bogie.mass)
        stop: Row = (CAR_BODY, BOGIE, 0.0, w.bumpstop.height, *[0.0] * 5, w.secondary.turn)
        sides = [
            [*_rows(w.primary, side, BOGIE, WHEELSET, both), *_rows(w.secondary, side, CAR_BODY, BOGIE, body)]
            for side in (1.0, -1.0)
        ]
        table = np.array([*sides[0], *sides[1], stop]).T
        ends = table[:2].astype(np.int64)
        heights = np.array([w.car_body.height, w.bogie.height, w.wheelset.height])
        return cls(
            ends=ends,
            across=np.stack([table[2], table[2]]),
            above=table[3] - heights[ends],
            stiffness=table[4:6].T,
            damping=table[6:8].T,
            preload=table[8],
            turn=table[9],
            couple=w.roll_bar + 2 * w.secondary.bending_stiffness,
            stop=w.bumpstop,
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

    def forces(self, position: Array, rate: Array) -> SuspensionForces:
        """Forces at position (..., 3, 3), y m, z m from the nominal height, roll rad of each body, and its rate."""
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
        force = -self.stiffness * deflection - self.damping * velocity
        force[..., 1] += self.preload
        force[..., -1, 0] -= self.stop(deflection[..., -1, 0])

        fy = c * force[..., 0] - s * force[..., 1]
        fz = s * force[..., 0] + c * force[..., 1]
        arm_y += self.reach * gap_y[..., None, :]
        arm_z += self.reach * gap_z[..., None, :]
        on_bodies = np.zeros(position.shape)
        for i, incidence in enumerate(self.incidence):
            each = np.stack([fy, fz, arm_y[..., i, :] * fz - arm_z[..., i, :] * fy], axis=-1)
            # Left and right first: the mirror image of a state then has the mirrored forces to the last bit.
            on_bodies += incidence @ np.concatenate([each[..., :4, :] + each[..., 4:8, :], each[..., 8:, :]], axis=-2)
        couple = self.couple * (position[..., CAR_BODY, 2] - position[..., BOGIE, 2])
        on_bodies[..., CAR_BODY, 2] -= couple
        on_bodies[..., BOGIE, 2] += couple
        return SuspensionForces(on_bodies, deflection, force)


def _upper_minus_lower(pair: Array) -> Array:
    return np.asarray(pair[..., 0, :] - pair[..., 1, :])
