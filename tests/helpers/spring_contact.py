"""Contact model for tests of its users: a spring with force proportional to penetration^1.5 that counts its solves."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from wheelrail.contact.kinematics.frames import Pose, RigidMotion
from wheelrail.contact.results.result import ContactResult, Patch, Statistics
from wheelrail.support.arrays import Array


def patch(normal_force: float, force: Array, y: float = 0.0) -> Patch:
    """A patch 10 mm by 8 mm around a lateral position y m on the profiles."""
    return Patch(
        area=63e-6,
        max_pressure=1.5 * normal_force / 63e-6,
        normal_force=normal_force,
        force=force,
        tangential_force=(0.1 * normal_force, -0.05 * normal_force),
        semi_axes=(5e-3, 4e-3),
        contact_angle=0.02,
        wheel_s=y,
        rail_s=y + 0.001,
        wheel_y=y,
        rail_y=y + 0.001,
        wheel_band=(y - 4e-3, y + 4e-3),
        rail_band=(y - 3e-3, y + 5e-3),
        x=0.0,
        stick_area=20e-6,
    )


@dataclass
class SpringContact:
    """Force stiffness * penetration^1.5 upwards and a fraction of it laterally; penetration from the pose's height
    above touch m. Above the penetration deepest m the model fails, as a mesh does when the contact leaves it.
    """

    touch: float = 0.0
    stiffness: float = 1e11
    sideways: float = 0.05
    deepest: float = np.inf
    calls: list[ContactResult | None] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)

    def __call__(self, pose: Pose, motion: RigidMotion, guess: ContactResult | None) -> ContactResult:
        self.calls.append(guess)
        self.poses.append(pose)
        overlap = self.touch - float(pose.origin[2])
        if overlap <= 0.0:
            return ContactResult.separated(overlap)
        if overlap > self.deepest:
            return ContactResult(np.zeros(3), np.zeros(3), approach=overlap, status="failed: off the mesh")
        normal = self.stiffness * overlap**1.5
        force = np.array([0.1 * normal, self.sideways * normal, normal])
        lateral = float(pose.origin[1]) * 0.1
        return ContactResult(
            force=force,
            moment=np.zeros(3),
            patches=(patch(normal, force, lateral),),
            approach=overlap,
            status="converged",
            statistics=Statistics(newton=3, linear=12, points=50, residual=1e-12, seconds={"solve": 0.001}),
        )
