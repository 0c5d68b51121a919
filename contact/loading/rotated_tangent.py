"""Derivative of a contact force in rotated axes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR
from wheelrail.contact.results.result import ForceTangent
from wheelrail.support.arrays import Array


@dataclass(frozen=True, eq=False)
class RotatedTangent(ForceTangent):
    """Derivative of a force and its moment, both and the changes of pose and motion in rotated axes.

    Parameters:
        tangent: in the axes of the body.
        axes: of the body as columns (3, 3).
    """

    tangent: ForceTangent
    axes: Array

    def __call__(self) -> Array:
        rotated = np.kron(np.eye(4), self.axes)
        return np.asarray(rotated[:6, :6] @ self.tangent() @ rotated.T)

    def about(self, centre: Array) -> RotatedTangent:
        """The derivative with the moment about another point (3,) m, in the rotated axes."""
        return replace(self, tangent=self.tangent.about(self.axes.T @ centre))

    def mirrored(self) -> RotatedTangent:
        """The derivative in the mirror y = 0."""
        return RotatedTangent(self.tangent.mirrored(), MIRROR[:, None] * self.axes * MIRROR)
