"""Forces of wheels on rails with Piotrowski and Kik's pressures, all wheels of a side in one call of the core; their
derivatives in one more, and the patches of a wheel, on demand, from the interpenetration regions of the forces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from wheelrail.bindings._contact import (
    Parameters,
    WheelForces,
    WheelPairs,
    forces_in_states,
    tangents_in_states,
    wheel_forces,
    wheel_patches,
    wheel_tangents,
)
from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.kinematics.left_pair import Dimensions, one_pair
from wheelrail.contact.results.patch_sums import patches_of
from wheelrail.contact.results.result import ContactResult, ForceTangent, Patch
from wheelrail.contact.solvers.tangent import ContactTangent
from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True, eq=False)
class SolvedWheels:
    """Wheels of one side, solved together.

    Parameters:
        parameters: of the pair.
        pairs: poses and motions.
        forces: with moments about the pairs' centres.
        mirror: whether the forces are those in the mirror y = 0.
    """

    parameters: Parameters
    pairs: WheelPairs
    forces: WheelForces
    mirror: bool

    @classmethod
    def at_pair(cls, parameters: Parameters, pose: Pose, motion: RigidMotion) -> SolvedWheels:
        """One wheel, with the moment about the rail's origin."""
        pairs = one_pair(pose, motion)
        return cls(parameters, pairs, wheel_forces(parameters, pairs, False), False)

    @classmethod
    def at_states(cls, parameters: Parameters, states: Array, dimensions: Dimensions, mirror: bool) -> SolvedWheels:
        """Wheels of one side; other parameters as for `forces_in_states`."""
        return cls(parameters, *forces_in_states(parameters, states, dimensions, mirror), mirror)

    def patches(self, i: int) -> tuple[Patch, ...]:
        """Patches of a wheel that touches its rail."""
        own = self.patches_of_pair(i)
        return tuple(patch.mirrored() for patch in own) if self.mirror else own

    def patches_of_pair(self, i: int) -> tuple[Patch, ...]:
        """The same of the pair, in its axes."""
        return patches_of(wheel_patches(self.parameters, self.pairs, self.forces, i))

    def tangent(self, i: int) -> ForceTangent:
        """Tangent of a result."""
        return ContactTangent(WheelDerivative(self, i), self.pairs.centre[i], self.mirror)

    def by_states(self, wheels: Nodes, states: Array, dimensions: Dimensions) -> Array:
        """Derivatives (m, 6, 9) by the coordinates of wheelsets; parameters as for `tangents_in_states`."""
        p, pairs, forces = self.parameters, self.pairs, self.forces
        return tangents_in_states(p, pairs, forces, wheels, states, dimensions, self.mirror)


@dataclass(frozen=True, eq=False)
class WheelDerivative:
    """Derivative of the force of a wheel on a rail.

    Parameters:
        of: wheels that were solved together.
        wheel: index.
    """

    of: SolvedWheels
    wheel: int

    @cached_property
    def matrix(self) -> Array:
        """Derivative (6, 12) of force and moment about the rail's origin."""
        solved, wheels = self.of, np.array([self.wheel])
        return np.asarray(wheel_tangents(solved.parameters, solved.pairs, solved.forces, wheels)[0])


class WheelsTogether(NamedTuple):
    """Wheels of a batched solve, and indices (m,) of a selection; -1: separated."""

    of: SolvedWheels
    indices: Nodes


def solved_together(results: Sequence[ContactResult]) -> WheelsTogether | None:
    """The wheels of results whose tangents one call computes; None if they were not solved together."""
    solved, indices = None, []
    for result in results:
        tangent = result.force_tangent
        of = tangent.of if isinstance(tangent, ContactTangent) else None
        if not isinstance(of, WheelDerivative) or (solved is not None and of.of is not solved):
            if result.status != "separated":
                return None
            indices.append(-1)
        else:
            solved = of.of
            indices.append(of.wheel)
    return None if solved is None else WheelsTogether(solved, np.array(indices))
