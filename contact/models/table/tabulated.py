"""Contact by a table in its range, and by the elastic contact beyond."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.kinematics.copies import changed
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.models.table.force_table import ForceTable
from wheelrail.contact.models.table.model import TableContact
from wheelrail.contact.results.result import ContactResult
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

    @property
    def alone(self) -> TableContact:
        """The table without a border, and without the elastic contact."""
        return TableContact(self.table)

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
