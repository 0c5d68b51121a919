"""Structured grid of contact points on the strip of a body's surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class ContactGrid:
    """Displacement nodes of a strip as a structured grid with a nodal quadrature rule.

    Parameters:
        position: (nx, ns, 3) m, of the nodes.
        weight: (nx, ns) m2, integral of each node's shape function; zero at the vertices of quadratic triangles, which
            are no contact points.
        stride: nodes to the next point of the same kind along x.
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
        # grid coordinates of the faces' corners, doubled for degree 2, so that midpoints are integers, too
        index = np.zeros((len(solid.points), 2), dtype=np.int64)
        index[solid.grid] = degree * np.moveaxis(np.indices(solid.grid.shape), 0, -1)
        corner, point = index[solid.faces], solid.points[solid.faces]
        rule = RULES[solid.faces.shape[1], degree]
        nodes = np.einsum("kc,fcd->fkd", rule.corners, corner).round().astype(np.int64)
        position, weight = np.empty((nx, ns, 3)), np.zeros((nx, ns))
        position[nodes[..., 0], nodes[..., 1]] = np.einsum("kc,fcd->fkd", rule.corners, point)
        if degree == 2:  # corners that the rule omits
            position[::2, ::2] = solid.points[solid.grid]
        area = _area(point)
        np.add.at(weight, (nodes[..., 0], nodes[..., 1]), area[:, None] * rule.weights)
        return cls(position, weight, 2 if rule.weights.size == 3 and degree == 2 else 1)


@dataclass(frozen=True)
class FaceQuadrature:
    """Nodal quadrature on a face: barycentric coordinates (k, c) of the nodes, and weights (k,) that sum to 1."""

    corners: Array
    weights: Array


def _tensor(values: Array, weights: Array) -> FaceQuadrature:
    """Tensor-product rule on a quadrilateral, corners in the order of dolfinx."""
    ends = np.stack([1 - values, values])
    return FaceQuadrature(
        np.einsum("xa,yb->abxy", ends, ends).reshape(len(values) ** 2, 4), (weights[:, None] * weights).ravel()
    )


# by corners of the face and degree of the displacements; exact for the shape functions
RULES: dict[tuple[int, int], FaceQuadrature] = {
    (3, 1): FaceQuadrature(np.eye(3), np.full(3, 1 / 3)),
    (3, 2): FaceQuadrature(np.array([[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]]), np.full(3, 1 / 3)),
    (4, 1): _tensor(np.array([0.0, 1.0]), np.array([0.5, 0.5])),
    (4, 2): _tensor(np.array([0.0, 0.5, 1.0]), np.array([1.0, 4.0, 1.0]) / 6),
}


def _area(corners: Array) -> Array:
    """Area (f,) m2 of faces with corners (f, 3 or 4, 3) m."""

    def triangle(a: Array, b: Array, c: Array) -> Array:
        return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))

    total = triangle(corners[:, 0], corners[:, 1], corners[:, 2])
    return total if corners.shape[1] == 3 else total + triangle(corners[:, 1], corners[:, 2], corners[:, 3])


def surface_points(corners: Array, degree: int) -> Array:
    """Displacement nodes (ns, 2) m of degree 1 or 2 on the straight edges between corners (m, 2) m."""
    if degree == 1:
        return corners
    out = np.empty((2 * len(corners) - 1, 2))
    out[::2], out[1::2] = corners, 0.5 * (corners[1:] + corners[:-1])
    return out


def invariant_grid(points: Array, rows: int, step: float, *, radius: float | None = None) -> ContactGrid:
    """Contact grid of a body invariant along x or in angle.

    Parameters:
        points: (ns, 2) m, nodes of the surface of the section.
        rows: number of cells along x.
        step: m, their length along x, on the circle of the radius.
        radius: m, of the circle about y; None: straight.

    Weights are the integrals of the piecewise linear shape functions across, times the step.
    """
    x = (np.arange(rows) - rows // 2) * step
    length = np.hypot(*np.diff(points, axis=0).T)
    ratio = np.ones(len(points)) if radius is None else points[:, 1] / radius
    tributary = np.zeros(len(points))
    tributary[:-1] += length * (2 * ratio[:-1] + ratio[1:]) / 6
    tributary[1:] += length * (ratio[:-1] + 2 * ratio[1:]) / 6
    position = np.empty((rows, len(points), 3))
    position[..., 1] = points[:, 0]
    if radius is None:
        position[..., 0], position[..., 2] = x[:, None], points[:, 1]
    else:
        position[..., 0] = np.sin(x / radius)[:, None] * points[:, 1]
        position[..., 2] = -np.cos(x / radius)[:, None] * points[:, 1]
    return ContactGrid(position, np.broadcast_to(step * tributary, (rows, len(points))), 1)
