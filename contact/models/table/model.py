"""Contact model that looks forces up in a table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from math import isfinite

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.table.force_table import ForceTable, TableForce
from wheelrail.contact.results.result import ContactResult, LazyPatches, Patch
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array

UNKNOWN = float("nan")  # of a patch: tables hold forces only
UNDEFINED = "table: z of the wheel = {:.4g} m, or its velocities: must be finite"


@dataclass(frozen=True, eq=False)
class TableContact:
    """Contact model of a left-hand pair: pose and velocities in, `ContactResult` out. The guess is not used.

    Parameters:
        table: of forces.

    A pose or a load outside the table fails, naming the variable, its value and its range. The result has no fields;
    its one patch has the resultant, and NaN for what a table does not hold.
    """

    table: ForceTable

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        return self.of(self.table.force(pose, motion), pose, motion)

    def of(self, force: TableForce, pose: Pose, motion: RigidMotion) -> ContactResult:
        """Result of a force of the table at a pose and motion."""
        if outside := self.table.outside(force.position):
            return ContactResult.failed(outside)
        if not (isfinite(force.depth) and all(map(isfinite, force.values))):
            return ContactResult.failed(UNDEFINED.format(force.position[3]))
        if force.level <= 0.0:
            return ContactResult.separated(force.depth)
        high = self.table.loads[1]
        if force.level**1.5 > high:
            load = f"{1e-3 * force.level**1.5:.4g} kN"
            text = f"table: load without friction = {load}: must be at most {1e-3 * high:.4g} kN"
            return ContactResult.failed(text, force.depth)
        if not force.speed > 0.0:
            return ContactResult.failed(
                f"friction needs a positive rolling speed, got {force.speed:g} m/s", force.depth
            )
        return ContactResult(
            force=force.values[:3],
            moment=force.values[3:],
            patches=LazyPatches(partial(resultant_patch, force)),
            approach=force.depth,
            status="converged",
            force_tangent=ContactTangent(_Derivative(self.table, pose, motion)),
        )


@dataclass(frozen=True, eq=False)
class _Derivative:
    """Derivative of a table's force, computed on demand."""

    table: ForceTable
    pose: Pose
    motion: RigidMotion

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        return self.table.derivative(self.pose, self.motion)[:6]


def resultant_patch(force: TableForce) -> tuple[Patch]:
    """The resultant as a patch."""
    normal = np.array([0.0, *force.resultant[1:]]) / np.hypot(force.resultant[1], force.resultant[2])
    lateral = np.array([0.0, normal[2], -normal[1]])
    load = force.values[:3]
    patch = Patch(
        area=UNKNOWN,
        max_pressure=UNKNOWN,
        normal_force=float(load @ normal),
        force=load,
        tangential_force=(float(load[0]), float(load @ lateral)),
        semi_axes=(UNKNOWN, UNKNOWN),
        contact_angle=float(np.arctan2(-normal[1], normal[2])),
        wheel_s=UNKNOWN,
        rail_s=UNKNOWN,
        wheel_y=UNKNOWN,
        rail_y=force.point[1],
        wheel_band=(UNKNOWN, UNKNOWN),
        rail_band=(UNKNOWN, UNKNOWN),
        x=force.point[0],
        stick_area=UNKNOWN,
        creepage=(UNKNOWN, UNKNOWN, UNKNOWN),
        frictional_power=UNKNOWN,
    )
    return (patch,)
