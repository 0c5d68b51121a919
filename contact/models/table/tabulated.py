"""Contact by a table in its range, and by the elastic contact beyond."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import isfinite

import numpy as np

from wheelrail.bindings._contact import left_pairs, table_slopes, table_wheels
from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.left_pair import motion_of, pose_of
from wheelrail.contact.models.table.force_table import ForceTable, TableForce
from wheelrail.contact.models.table.model import TableContact, resultant_patch
from wheelrail.contact.results.result import ContactResult, ForceTangent, LazyPatches, Patch
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array

ContactModel = Callable[[Pose, RigidMotion, ContactResult | None], ContactResult]


@dataclass(frozen=True, eq=False)
class TabulatedContact:
    """Contact model of a left-hand pair: pose and velocities in, `ContactResult` out.

    Parameters:
        table: of forces.
        elastic: contact that it was made of.

    In the border of the table the force is F = w T + (1 - w) E, of the table T and the elastic contact E, with
    w = `TableForce.share`: force and derivative are continuous. Outside it is E, and the patches are its patches where
    it is solved. Its warm start is passed on through results of the table alone.
    """

    table: ForceTable
    elastic: ContactModel

    @cached_property
    def inside(self) -> TableContact:
        """The table alone, with a border."""
        return TableContact(self.table.bordered())

    def at_states(self, wheels: TableWheels, guesses: Sequence[ContactResult | None]) -> list[ContactResult | None]:
        """Results of wheels of a side, in the axes of the track; None where the elastic contact is to be solved."""
        results = list[ContactResult | None]()
        for i, (row, guess) in enumerate(zip(wheels.numbers, guesses, strict=True)):
            share, level, depth, speed = row[[25, 16, 17, 18]].tolist()
            if not (share == 1.0 and speed > 0.0 and isfinite(row[:6].sum())):
                results.append(None)
                continue
            start = None if guess is None else guess.warm_start
            if level <= 0.0:
                results.append(changed(ContactResult.separated(depth), warm_start=start))
                continue
            patches, tangent = LazyPatches(partial(wheels.patches, i)), AtState(wheels, i)
            results.append(
                ContactResult(
                    row[:3], row[3:6], patches, None, depth, "converged", force_tangent=tangent, warm_start=start
                )
            )
        return results

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None = None) -> ContactResult:
        inside = self.inside
        force = inside.table.force(pose, motion)
        share = force.share
        if not share > 0.0:
            return self.elastic(pose, motion, guess)
        tabulated = inside.of(force, pose, motion)
        if tabulated.ok and share == 1.0:
            return changed(tabulated, warm_start=None if guess is None else guess.warm_start)
        solved = self.elastic(pose, motion, guess)
        if not (tabulated.ok and solved.ok) or solved.status == tabulated.status == "separated":
            return solved
        difference = tabulated.force - solved.force, tabulated.moment - solved.moment
        return changed(
            solved,
            force=solved.force + share * difference[0],
            moment=solved.moment + share * difference[1],
            patches=solved.patches if solved.status == "converged" else tabulated.patches,
            status="converged",
            force_tangent=ContactTangent(_Blend(inside.table, pose, motion, share, solved, np.concatenate(difference))),
        )


@dataclass(frozen=True, eq=False)
class _Blend:
    """Derivative of a force in the border, computed on demand.

    Parameters:
        table: with a border.
        pose, motion: of the wheel.
        share: of the table.
        solved: result of the elastic contact.
        difference: (6,) force and moment of the table less those of the elastic contact.
    """

    table: ForceTable
    pose: Pose
    motion: RigidMotion
    share: float
    solved: ContactResult
    difference: Array

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        tabulated, elastic = self.table.derivative(self.pose, self.motion), self.solved.tangent()
        by_share = np.outer(self.difference, tabulated[6])
        return np.asarray(elastic + self.share * (tabulated[:6] - elastic) + by_share)


@dataclass(frozen=True, eq=False)
class TableWheels:
    """Wheels of one side of several wheelsets on a table with a border.

    Parameters:
        model: contact of the left-hand pair.
        values: (w, 17) of the states, see `WheelsetState.values`.
        dimensions: of a `Mounting`.
        mirror: whether the side is the right one.
    """

    model: TabulatedContact
    values: Array
    dimensions: tuple[float, float, float]
    mirror: bool

    @cached_property
    def numbers(self) -> Array:
        """Numbers (w, 26) of the core's `table_wheels`."""
        return table_wheels(self.model.inside.table.data, self.values, self.dimensions, self.mirror)

    def slopes(self) -> Array:
        """Derivatives (w, 6, 9) of force and moment by the coordinates of the wheelsets."""
        return table_slopes(self.model.inside.table.data, self.values, self.dimensions, self.mirror)

    def patches(self, number: int) -> tuple[Patch, ...]:
        """Patch of the resultant of one wheel."""
        (patch,) = resultant_patch(TableForce.of(self.numbers[number, 6:]))
        return (patch.mirrored() if self.mirror else patch,)

    def tangent(self, number: int) -> ForceTangent:
        """Derivative by position and motion of one wheel."""
        pairs = left_pairs(self.values[[number]], self.dimensions, self.mirror)
        pose, motion = pose_of(pairs, 0), motion_of(pairs, 0)
        result = self.model(pose, motion).about(motion.wheel.reference)
        found = (result.mirrored() if self.mirror else result).force_tangent
        assert found is not None
        return found


@dataclass(frozen=True, eq=False)
class AtState:
    """Derivative of the force of one of several wheels on a table, computed on demand.

    Parameters:
        wheels: of one side.
        number: of the wheel.
    """

    wheels: TableWheels
    number: int

    def about(self, centre: Array) -> ForceTangent:
        return self.wheels.tangent(self.number).about(centre)

    def mirrored(self) -> ForceTangent:
        return self.wheels.tangent(self.number).mirrored()

    def __call__(self) -> Array:
        return self.wheels.tangent(self.number)()
