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
        nx, ns = ((n - 1) * degree + 1 for n in solid.grid.shape)
        # grid coordinates of the faces' corners, doubled for degree 2: the middle of two corners is half their sum
        place = np.zeros((len(solid.points), 2), dtype=np.int64)
        place[solid.grid] = degree * np.moveaxis(np.indices(solid.grid.shape), 0, -1)
        corner, point = place[solid.faces], solid.points[solid.faces]
        rule = RULES[solid.faces.shape[1], degree]
        nodes = np.einsum("kc,fcd->fkd", rule.corners, corner).round().astype(np.int64)
        position, weight = np.empty((nx, ns, 3)), np.zeros((nx, ns))
        position[nodes[..., 0], nodes[..., 1]] = np.einsum("kc,fcd->fkd", rule.corners, point)
        if degree == 2:  # corners, too, where the rule leaves them out
            position[::2, ::2] = solid.points[solid.grid]
        area = _area(point)
        np.add.at(weight, (nodes[..., 0], nodes[..., 1]), area[:, None] * rule.weights)
        return cls(position, weight, 2 if rule.weights.size == 3 and degree == 2 else 1)


@dataclass(frozen=True)
class Rule:
    """Quadrature on a face whose points are displacement nodes: their shares of the corners; weights that add to 1."""

    corners: Array
    weights: Array


def _tensor(values: Array, weights: Array) -> Rule:
    """Rule on a quadrilateral from one on a line, corners in the order of dolfinx."""
    ends = np.stack([1 - values, values])
    return Rule(np.einsum("xa,yb->abxy", ends, ends).reshape(len(values) ** 2, 4), (weights[:, None] * weights).ravel())


# by corners of the face and degree of the displacements; exact for the shape functions
RULES: dict[tuple[int, int], Rule] = {
    (3, 1): Rule(np.eye(3), np.full(3, 1 / 3)),
    (3, 2): Rule(np.array([[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]]), np.full(3, 1 / 3)),
    (4, 1): _tensor(np.array([0.0, 1.0]), np.array([0.5, 0.5])),
    (4, 2): _tensor(np.array([0.0, 0.5, 1.0]), np.array([1.0, 4.0, 1.0]) / 6),
}


def _area(corners: Array) -> Array:
    """Area (f,) m2 of faces with corners (f, 3 or 4, 3) m."""

    def triangle(a: Array, b: Array, c: Array) -> Array:
        return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))

    total = triangle(corners[:, 0], corners[:, 1], corners[:, 2])
    return total if corners.shape[1] == 3 else total + triangle(corners[:, 1], corners[:, 2], corners[:, 3])
