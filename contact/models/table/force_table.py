"""Table of contact forces of one wheel on one rail, and its range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.table.lookup import FrictionTable, NormalTable, table_force, tread_position
from wheelrail.support.arrays import Array

STEP = 1e-30  # of complex arguments: their squares vanish, and derivatives are exact to round-off
UNITS = {"y": "m", "roll": "rad", "yaw": "rad"}


@dataclass(frozen=True)
class TreadFrame:
    """Position of the tread, the lowest point of the rolling circle, of a left-hand wheel on its rail.

    Parameters:
        radius: nominal rolling radius, m.
        lateral: nominal position of the tread from the rail's origin, m.
    """

    radius: float
    lateral: float

    def pose(self, y: float, z: float, roll: float, yaw: float) -> Pose:
        """Pose of the wheel.

        Parameters:
            y, z: of the tread from its nominal position, m.
            roll: sine of the roll angle.
            yaw: tangent of the yaw angle.
        """
        c, s = 1.0 / np.hypot(1.0, yaw), yaw / np.hypot(1.0, yaw)
        level = np.sqrt(1.0 - roll**2)
        rotation = np.array([[c, -s * level, s * roll], [s, c * level, -c * roll], [0.0, roll, level]])
        return Pose(np.array([0.0, y + self.lateral, z]) + self.radius * rotation[:, 2], rotation)

    def position(self, pose: Pose) -> dict[str, float]:
        """Values of y, z, roll and yaw of a pose, see `pose`."""
        values = tread_position(pose.origin, pose.rotation, self.radius, self.lateral)
        return {name: value.real for name, value in zip(("y", "z", "roll", "yaw"), values, strict=True)}


@dataclass(frozen=True)
class TableForce:
    """Force from a table.

    Parameters:
        values: force N and moment N m (6,) about the rail's origin; zero without contact.
        level: (vertical load without friction / N)^(2/3), negative without contact.
        depth: below the height at which wheel and rail touch, m.
        speed: rolling speed, m/s; 1 without friction or contact.
        point: (3,) m of the resultant without friction.
        resultant: (3,) N, force without friction.
    """

    values: Array
    level: float
    depth: float
    speed: float
    point: Array
    resultant: Array


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Contact forces of a left-hand wheel on its rail, a function of pose and motion.

    Parameters:
        frame: of the tread.
        normal: contact without friction.
        friction: change of forces by friction.
    """

    frame: TreadFrame
    normal: NormalTable
    friction: FrictionTable

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest y, m, roll and yaw, rad."""
        nodes = {"y": self.normal.y, "roll": self.normal.roll, "yaw": self.normal.yaw}
        return {name: (float(values[0]), float(values[-1])) for name, values in nodes.items()}

    @property
    def loads(self) -> tuple[float, float]:
        """Smallest vertical load with values of its own, and the largest, N."""
        return float(self.normal.level[1] ** 1.5), float(self.normal.level[-1] ** 1.5)

    def outside(self, pose: Pose) -> str:
        """The first variable of a pose outside its range, with value and range; empty where there is none."""
        position = self.frame.position(pose)
        for name, (low, high) in self.ranges.items():
            if not low <= position[name] <= high:
                value, unit = position[name], UNITS[name]
                return f"table: {name} of the wheel = {value:.4g} {unit}: must be from {low:.4g} to {high:.4g} {unit}"
        return ""

    def force(self, pose: Pose, motion: RigidMotion) -> TableForce:
        """Force at a pose within the range."""
        return TableForce(*self._looked_up(pose.origin, pose.rotation, _twists(motion)))

    def derivative(self, pose: Pose, motion: RigidMotion) -> Array:
        """Derivative (6, 12) of force and moment, see `wheelrail.contact.results.result.ContactResult.tangent`."""
        columns = np.zeros((6, 12))
        for k in range(12):
            origin, rotation, twists = pose.origin + 0j, pose.rotation + 0j, [part + 0j for part in _twists(motion)]
            change = 1j * STEP * np.eye(3)[k % 3]
            if k < 3:
                origin, twists[2] = origin + change, twists[2] + change
            elif k < 6:
                rotation = rotation + np.cross(change, rotation, axisb=0, axisc=0)
                twists[2] = twists[2] + np.cross(change, twists[2] - origin)
            else:
                twists[k // 3 - 2] = twists[k // 3 - 2] + change
            columns[:, k] = self._looked_up(origin, rotation, tuple(twists))[0].imag / STEP
        return columns

    def _looked_up(self, origin: NDArray[Any], rotation: NDArray[Any], twists: tuple[NDArray[Any], ...]) -> Any:
        """Results of `table_force`, of real or of complex arrays."""
        place = self.frame.radius, self.frame.lateral
        return table_force(self.normal, self.friction, place, (origin, np.ascontiguousarray(rotation)), twists)


def _twists(motion: RigidMotion) -> tuple[Array, ...]:
    """Velocity, angular velocity and reference of wheel and rail."""
    wheel, rail = motion.wheel, motion.rail
    return wheel.velocity, wheel.rotation, wheel.reference, rail.velocity, rail.rotation, rail.reference
