"""Displacement and stress at the points of a mesh of one body: what pictures are drawn from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR, Pose
from wheelrail.forms.stress import von_mises
from wheelrail.support.arrays import Array, Nodes

Shape = Literal["triangle", "quadrilateral", "wedge", "tetrahedron", "hexahedron"]
CORNERS: dict[Shape, int] = {"triangle": 3, "quadrilateral": 4, "wedge": 6, "tetrahedron": 4, "hexahedron": 8}


@dataclass(frozen=True)
class BodyFields:
    """points (n, 3) m, cells (m, k) of their corners, displacement (n, 3) m, stress (n, 3, 3) Pa, in the frame of a
    result's fields or its mirror image. Corners go round faces, of wedges and hexahedra first one end, then the other.

    Raises ValueError for arrays that do not go together.
    """

    points: Array
    cells: Nodes
    shape: Shape
    displacement: Array
    stress: Array

    def __post_init__(self) -> None:
        n, corners = len(self.points), CORNERS[self.shape]
        shapes = [a.shape for a in (self.points, self.displacement, self.stress)]
        if shapes != [(n, 3), (n, 3), (n, 3, 3)] or self.cells.ndim != 2 or self.cells.shape[1] != corners:
            raise ValueError(
                f"points, displacement, stress and cells must be (n, 3), (n, 3), (n, 3, 3) and (m, {corners}), not "
                f"{', '.join(map(str, shapes))} and {self.cells.shape}"
            )
        if len(self.cells) and not 0 <= self.cells.min() <= self.cells.max() < n:
            raise ValueError(f"cells must point at 0 .. {n - 1}, not {self.cells.min()} .. {self.cells.max()}")

    @property
    def von_mises(self) -> Array:
        return von_mises(self.stress)

    def seen_from(self, frame: Pose) -> BodyFields:
        """The same in the frame in which a body's axes have this pose."""
        turn = frame.rotation
        return replace(
            self,
            points=frame.origin + self.points @ turn.T,
            displacement=self.displacement @ turn.T,
            stress=np.asarray(turn @ self.stress @ turn.T),
        )

    def mirrored(self) -> BodyFields:
        """The same in the mirror y = 0."""
        return replace(
            self,
            points=self.points * MIRROR,
            displacement=self.displacement * MIRROR,
            stress=self.stress * np.outer(MIRROR, MIRROR),
        )
