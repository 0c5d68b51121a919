"""Displacement and stress at the points of a mesh of one body, for visualisation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wheelrail.contact.kinematics.frames import MIRROR, Pose
from wheelrail.forms.stress import von_mises
from wheelrail.support.arrays import Array, Nodes

Shape = Literal["triangle", "quadrilateral", "wedge", "tetrahedron", "hexahedron"]
CORNERS: dict[Shape, int] = {"triangle": 3, "quadrilateral": 4, "wedge": 6, "tetrahedron": 4, "hexahedron": 8}
CIRCULAR_ORDER = [0, 1, 3, 2, 4, 5, 7, 6]  # corners of a hexahedron: from the order of dolfinx, and back


@dataclass(frozen=True)
class BodyFields:
    """Fields on a mesh, in the frame of a result's fields or its mirror image.

    Parameters:
        points: (n, 3) m.
        cells: (m, k), corners in circular order, of wedges and hexahedra first those of one face, then of the opposite
            one.
        shape: of the cells.
        displacement: (n, 3) m.
        stress: (n, 3, 3) Pa.

    Raises ValueError for arrays of inconsistent shapes.
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
            raise ValueError(
                f"cells must hold point numbers from 0 to {n - 1}, got {self.cells.min()} to {self.cells.max()}"
            )

    @property
    def von_mises(self) -> Array:
        """Von Mises stress (n,) Pa."""
        return von_mises(self.stress)

    def in_frame(self, frame: Pose) -> BodyFields:
        """The fields in the frame in which the present axes have this pose."""
        rotation = frame.rotation
        return replace(
            self,
            points=frame.origin + self.points @ rotation.T,
            displacement=self.displacement @ rotation.T,
            stress=np.asarray(rotation @ self.stress @ rotation.T),
        )

    def mirrored(self) -> BodyFields:
        """The fields in the mirror y = 0."""
        return replace(
            self,
            points=self.points * MIRROR,
            displacement=self.displacement * MIRROR,
            stress=self.stress * np.outer(MIRROR, MIRROR),
        )
