"""The structured grid of contact points on a body's strip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.pose import Array
from meshes.solids import Solid


@dataclass(frozen=True)
class ContactGrid:
    """Displacement nodes of a strip as a structured grid, and the quadrature rule that lives on them.

    position (nx, ns, 3) m of the nodes; weight (nx, ns) m2, the exact integral of each node's shape function (zero at
    the vertices of quadratic triangles: no contact point there); stride: nodes to the next point of the same kind
    along x.
    """

    position: Array
    weight: Array
    stride: int

    @property
    def shape(self) -> tuple[int, int]:
        return self.weight.shape  # type: ignore[return-value]

    @classmethod
    def on(cls, solid: Solid, degree: int) -> ContactGrid:
        """Grid of the strip of a mesh for displacements of the given degree (1 or 2)."""
        vertex = solid.points[solid.grid]
        triangles = solid.cell == "tetrahedron"
        low, high, low_next, high_next = vertex[:-1, :-1], vertex[:-1, 1:], vertex[1:, :-1], vertex[1:, 1:]
        lower = 0.5 * np.linalg.norm(np.cross(high - low, high_next - low), axis=2)  # holds the edge along the profile
        upper = 0.5 * np.linalg.norm(np.cross(low_next - low, high_next - low), axis=2)
        nx, ns = vertex.shape[:2]
        if degree == 1:
            weight = np.zeros((nx, ns))
            parts = (
                (2 * lower + 2 * upper, 2 * lower, 2 * upper, 2 * lower + 2 * upper)
                if triangles
                else (1.5 * (lower + upper),) * 4
            )
            for (i, j), part in zip(((0, 0), (0, 1), (1, 0), (1, 1)), parts, strict=True):
                weight[i : nx - 1 + i, j : ns - 1 + j] += part / 6
            return cls(vertex, weight, 1)
        position = np.empty((2 * nx - 1, 2 * ns - 1, 3))
        position[::2, ::2] = vertex
        position[1::2, ::2] = 0.5 * (vertex[1:] + vertex[:-1])
        position[::2, 1::2] = 0.5 * (vertex[:, 1:] + vertex[:, :-1])
        position[1::2, 1::2] = 0.5 * (low + high_next) if triangles else 0.25 * (low + high + low_next + high_next)
        weight = np.zeros(position.shape[:2])
        if triangles:
            weight[1::2, 1::2] = (lower + upper) / 3
            weight[::2, 1::2][:-1] += lower / 3
            weight[::2, 1::2][1:] += upper / 3
            weight[1::2, ::2][:, :-1] += upper / 3
            weight[1::2, ::2][:, 1:] += lower / 3
            # lower holds the profile edge of its first row, upper that of the next one: see `meshes.solids.extruded`
            return cls(position, weight, 2)
        area = lower + upper
        simpson = np.array([1.0, 4.0, 1.0]) / 6
        for i in range(3):
            for j in range(3):
                weight[i : i + 2 * nx - 2 : 2, j : j + 2 * ns - 2 : 2] += simpson[i] * simpson[j] * area
        return cls(position, weight, 1)
