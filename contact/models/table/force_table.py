"""Table of contact forces of one wheel on one rail, and its range."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod
from typing import Any, NamedTuple

import numpy as np

from wheelrail.bindings._contact import Grid, TableData, table_derivative, table_force
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.support.arrays import Array

UNITS = {"y": "m", "roll": "rad", "yaw": "rad"}
NORMAL_AXES = ("y", "roll", "yaw", "level")
FRICTION_AXES = (*NORMAL_AXES, "longitudinal", "lateral")
NORMAL_COLUMNS, FRICTION_COLUMNS = 9, 6  # numbers at a node
BORDER_Y, BORDER = 5e-4, 0.1  # m, width of a border in y; share of the largest roll, yaw and load


@dataclass(frozen=True, eq=False)
class NormalTable:
    """Contact without friction.

    Parameters:
        y, roll, yaw: nodes m, rad, rad.
        level: nodes of (vertical load / N)^(2/3) from 0.
        values: (y * roll * yaw * level * 9,): height m of the tread above the nominal one; point of the resultant from
            the tread, m; lateral force, longitudinal force over the vertical one; moment about that point over it, m.

    The tread is the lowest point of the rolling circle, (0, 0, -radius) in the axes of the wheel without spin. Raises
    ValueError for arrays that the core cannot look up, see `check_grid`.
    """

    y: Array
    roll: Array
    yaw: Array
    level: Array
    values: Array

    def __post_init__(self) -> None:
        if len(self.level) < 2:
            raise ValueError(f"level: {len(self.level)} nodes: must be at least 2")
        check_grid({name: getattr(self, name) for name in NORMAL_AXES}, self.values, NORMAL_COLUMNS)

    @cached_property
    def grid(self) -> Grid:
        """The table for the core."""
        return _grid(NORMAL_COLUMNS, self.values, self.y, self.roll, self.yaw, self.level)


@dataclass(frozen=True, eq=False)
class FrictionTable:
    """Change of force and moment by friction.

    Parameters:
        y, roll, yaw, level: nodes as for `NormalTable`.
        longitudinal, lateral: nodes of asinh(creepage / scale), see
            the core's `scale_of_creepage`.
        values: (y * roll * yaw * level * longitudinal * lateral * 6,): change of force along x, along the lateral
            tangent and along the normal, and of the moment about the same point in the axes of the track over
            the core's `ARM`, all over friction coefficient times vertical load.
        coefficient: of friction; 0: the values are not read.

    Raises ValueError as `NormalTable`, and for a coefficient that is negative or not finite.
    """

    y: Array
    roll: Array
    yaw: Array
    level: Array
    longitudinal: Array
    lateral: Array
    values: Array
    coefficient: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.coefficient < np.inf:
            raise ValueError(f"coefficient of friction = {self.coefficient}: must be a number from 0")
        check_grid({name: getattr(self, name) for name in FRICTION_AXES}, self.values, FRICTION_COLUMNS)

    @cached_property
    def grid(self) -> Grid:
        """The table for the core."""
        return _grid(
            FRICTION_COLUMNS, self.values, self.y, self.roll, self.yaw, self.level, self.longitudinal, self.lateral
        )


def check_grid(axes: Mapping[str, Array], values: Array, columns: int) -> None:
    """Raise ValueError unless values can be looked up.

    Parameters:
        axes: nodes by name; at least one each, finite and increasing.
        values: finite, as many as nodes times columns.
        columns: numbers at a node.
    """
    for name, nodes in {**axes, "values": values}.items():
        if nodes.dtype != np.float64 or nodes.ndim != 1 or not nodes.size or not np.isfinite(nodes).all():
            raise ValueError(f"{name}: {nodes.dtype} of shape {nodes.shape}: must be finite numbers in a row")
        if name in axes and not (np.diff(nodes) > 0.0).all():
            raise ValueError(f"{name}: its nodes must increase")
    if values.size != (size := prod(map(len, axes.values())) * columns):
        raise ValueError(f"values: {values.size} numbers: must be {size}, {columns} at each node")


def _grid(columns: int, values: Array, *axes: Array) -> Grid:
    return Grid(np.concatenate(axes), tuple(map(len, axes)), values, columns)


@dataclass(frozen=True)
class TreadFrame:
    """Position of the tread, the lowest point of the rolling circle, of a left-hand wheel on its rail.

    Parameters:
        radius: nominal rolling radius, m.
        lateral: nominal position of the tread from the rail's origin, m.

    Raises ValueError for a radius that is not positive, and for numbers that are not finite.
    """

    radius: float
    lateral: float

    def __post_init__(self) -> None:
        if not (0.0 < self.radius < np.inf and np.isfinite(self.lateral)):
            raise ValueError(f"radius = {self.radius}, lateral = {self.lateral}: must be lengths in m")

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


class TableForce(NamedTuple):
    """Force from a table.

    Parameters:
        values: force N and moment N m (6,) about the rail's origin; zero without contact.
        position: y m, roll and yaw rad, z m of the tread, see `TreadFrame.pose`.
        level: (vertical load without friction / N)^(2/3), not positive without contact.
        depth: below the height at which wheel and rail touch, m.
        speed: rolling speed, m/s; 1 without friction or contact.
        point: (3,) m of the resultant without friction.
        resultant: (3,) N, force without friction.
        share: of the table beside an elastic contact, from 1 inside of its border to 0 outside.
    """

    values: Array
    position: list[float]
    level: float
    depth: float
    speed: float
    point: list[float]
    resultant: list[float]
    share: float

    @classmethod
    def of(cls, values: Array) -> TableForce:
        """From the numbers (20,) of the core."""
        numbers = values.tolist()
        level, depth, speed = numbers[10:13]
        return cls(values[:6], numbers[6:10], level, depth, speed, numbers[13:16], numbers[16:19], numbers[19])


@dataclass(frozen=True, eq=False)
class ForceTable:
    """Contact forces of a left-hand wheel on its rail, a function of pose and motion.

    Parameters:
        frame: of the tread.
        normal: contact without friction.
        friction: change of forces by friction.
        border: widths (4,) of the border in which `TableForce.share` falls to 0, in y m, roll and yaw rad, and level;
            empty: none.
    """

    frame: TreadFrame
    normal: NormalTable
    friction: FrictionTable
    border: tuple[float, ...] = ()

    def __str__(self) -> str:
        """Ranges, and the largest load."""
        own = [f"{name} from {low:.3g} to {high:.3g} {UNITS[name]}" for name, (low, high) in self.ranges.items()]
        return f"table: {', '.join(own)}, load up to {1e-3 * self.loads[1]:.4g} kN"

    def bordered(self) -> ForceTable:
        """The table with a border: 0.5 mm in y, a tenth of the largest roll, yaw and load."""
        roll, yaw = (BORDER * 0.5 * (high - low) for low, high in (self.ranges["roll"], self.ranges["yaw"]))
        level = (1.0 - (1.0 - BORDER) ** (2.0 / 3.0)) * float(self.normal.level[-1])
        return replace(self, border=(BORDER_Y, roll, yaw, level))

    @cached_property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest y, m, roll and yaw, rad."""
        nodes = {"y": self.normal.y, "roll": self.normal.roll, "yaw": self.normal.yaw}
        return {name: (float(values[0]), float(values[-1])) for name, values in nodes.items()}

    @cached_property
    def loads(self) -> tuple[float, float]:
        """Smallest vertical load with values of its own, and the largest, N."""
        return float(self.normal.level[1] ** 1.5), float(self.normal.level[-1] ** 1.5)

    def outside(self, position: Sequence[float]) -> str:
        """The first of y, roll and yaw outside its range, with value and range; empty where there is none."""
        for (name, (low, high)), value in zip(self.ranges.items(), position, strict=False):
            if not low <= value <= high:
                unit = UNITS[name]
                return f"table: {name} of the wheel = {value:.4g} {unit}: must be from {low:.4g} to {high:.4g} {unit}"
        return ""

    def force(self, pose: Pose, motion: RigidMotion) -> TableForce:
        """Force at a pose; beyond the ranges interpolants continue, see `outside`."""
        values = table_force(*self.arguments(pose, motion))
        return TableForce.of(values)

    def derivative(self, pose: Pose, motion: RigidMotion) -> Array:
        """Derivative (7, 12) of force and moment, see `wheelrail.contact.results.result.ContactResult.tangent`, and of
        the share.
        """
        return table_derivative(*self.arguments(pose, motion))

    def arguments(self, pose: Pose, motion: RigidMotion) -> Any:
        """Arguments of `table_force`."""
        wheel, rail = motion.wheel, motion.rail
        vectors = wheel.velocity, wheel.rotation, wheel.reference, rail.velocity, rail.rotation, rail.reference
        arrays = (np.ascontiguousarray(part, dtype=float) for part in (pose.origin, pose.rotation, *vectors))
        return self.data, *arrays

    @cached_property
    def data(self) -> TableData:
        """The table for the core."""
        friction, frame = self.friction, self.frame
        return TableData(
            self.normal.grid,
            friction.grid,
            float(friction.coefficient),
            float(frame.radius),
            float(frame.lateral),
            np.array(self.border, dtype=float),
        )
