"""3D meshes of the bodies: a section extruded along x, then mapped (wheels are revolved, spheres bulged).

The contact surface has a structured strip of uniform cells; cells grow with the distance from it. Meshes are fixed in
the frame of the body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from wheelrail.meshes.bodies.triangulation import SectionMesh
from wheelrail.support.arrays import Array, Mask, Nodes

Cell = Literal["tetrahedron", "hexahedron"]


@dataclass(frozen=True)
class Solid:
    """Mesh of one body.

    Parameters:
        points: (n, 3) m.
        cells: (m, 4) or (m, 8), nodes in the order of dolfinx.
        grid: (nx, ns), nodes of the structured strip, along x and along the profile.
        faces: (k, 3) or (k, 4), nodes of the faces of that strip.
        clamped: (n,), mask of the fixed nodes.
    """

    points: Array
    cells: Nodes
    grid: Nodes
    faces: Nodes
    clamped: Mask

    @property
    def cell(self) -> Cell:
        return "tetrahedron" if self.cells.shape[1] == 4 else "hexahedron"

    def mapped(self, chart: Callable[[Array], Array]) -> Solid:
        """The mesh with its points mapped by a smooth function (n, 3) m -> (n, 3) m."""
        return replace(self, points=chart(self.points))

    def volume(self) -> float:
        """Volume [m3] (hexahedra by their eight-point rule)."""
        corners = self.points[self.cells]
        if self.cell == "tetrahedron":
            edges = corners[:, 1:] - corners[:, :1]
            return float(np.abs(np.linalg.det(edges)).sum() / 6)
        a = 0.5 / np.sqrt(3)
        total = 0.0
        for xi in np.array(np.meshgrid([-a, a], [-a, a], [-a, a])).reshape(3, -1).T + 0.5:
            shape = [np.array([1 - c, c]) for c in xi]
            slope = [np.array([-1.0, 1.0])] * 3
            jacobian = np.stack(
                [
                    np.einsum(
                        "nzyxc,z,y,x->nc",
                        corners.reshape(-1, 2, 2, 2, 3),
                        *(slope[m] if m == d else shape[m] for m in (2, 1, 0)),
                    )
                    for d in range(3)
                ],
                axis=1,
            )
            total += np.abs(np.linalg.det(jacobian)).sum() / 8
        return float(total)


def layers(half_strip: int, size: float, half_length: float, *, growth: float = 1.35, largest: float = 30e-3) -> Array:
    """Positions m of the layers along x, symmetric about zero.

    Parameters:
        half_strip: number of uniform steps on either side of zero.
        size: their length, m.
        half_length: of the body, m.
        growth: ratio of successive steps outside.
        largest: step, m.
    """
    steps: list[float] = []
    reach = half_strip * size
    step = size
    while reach + sum(steps) < half_length:
        step = min(step * growth, largest)
        steps.append(step)
    outer = reach + np.cumsum(steps) if steps else np.empty(0)
    if len(outer):
        outer = reach + (outer - reach) * (half_length - reach) / (outer[-1] - reach)
    inner = np.arange(-half_strip, half_strip + 1) * size
    return np.concatenate([-outer[::-1], inner, outer])


def extruded(section: SectionMesh, x: Array, half_strip: int) -> Solid:
    """Extrude a section (y, z) along the layers x [m].

    Triangles become three tetrahedra per layer, quadrilaterals hexahedra; half_strip layers on either side of the
    middle are the contact strip. All diagonals of the strip have the same direction: with alternating directions, nodes
    would be of two kinds, and the pressure would oscillate between them.
    """
    n, count = len(section.points), len(x)
    points = np.empty((count, n, 3))
    points[..., 0] = x[:, None]
    points[..., 1:] = section.points
    first = np.arange(count - 1)[:, None, None] * n
    middle = count // 2
    grid = np.arange(middle - half_strip, middle + half_strip + 1)[:, None] * n + section.surface
    low, high, low_next, high_next = (g.ravel() for g in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, :-1], grid[1:, 1:]))
    if section.cells.shape[1] == 3:
        # Diagonals run from the lower to the higher node number of the section, so that neighbours are conforming.
        a = np.sort(section.cells, axis=1) + first
        b = a + n
        cells = np.stack(
            [
                np.stack([a[..., 0], a[..., 1], a[..., 2], b[..., 2]], axis=-1),
                np.stack([a[..., 0], a[..., 1], b[..., 1], b[..., 2]], axis=-1),
                np.stack([a[..., 0], b[..., 0], b[..., 1], b[..., 2]], axis=-1),
            ],
            axis=2,
        ).reshape(-1, 4)
        faces = np.concatenate([np.stack([low, high, high_next], axis=1), np.stack([low, low_next, high_next], axis=1)])
    else:
        # gmsh numbers the corners around the face, dolfinx as a tensor product
        a = section.cells[:, [0, 1, 3, 2]] + first
        cells = np.concatenate([a, a + n], axis=-1).reshape(-1, 8)
        faces = np.stack([low, high, low_next, high_next], axis=1)
    return Solid(points.reshape(-1, 3), cells, grid, faces, np.tile(section.clamped, count))


def revolved(radius: float) -> Callable[[Array], Array]:
    """Map of (x, y, r) m to a body of revolution about y: the angle is x / radius, zero at the bottom, forward for
    x > 0.
    """

    def chart(points: Array) -> Array:
        angle, r = points[:, 0] / radius, points[:, 2]
        return np.stack([r * np.sin(angle), points[:, 1], -r * np.cos(angle)], axis=1)

    return chart


def bulged(radii: tuple[float, float], depth: float) -> Callable[[Array], Array]:
    """Map a block with its top at z = 0 to an ellipsoidal cap with principal radii [m] in x and y.

    inf is straight (a cylinder), negative hollow, equal radii give a sphere. The displacement decreases linearly to
    zero over the depth m, so that a clamped bottom remains flat. Raises ValueError for a block wider than the cap.
    """
    curvatures = np.array([1.0 / r for r in radii])
    hollow = bool((curvatures <= 0).all() and (curvatures < 0).any())
    curvatures = -curvatures if hollow else curvatures
    axis = 1.0 / np.abs(curvatures).max() if curvatures.any() else np.inf

    def chart(points: Array) -> Array:
        displaced = points.copy()
        if np.isfinite(axis):
            q = points[:, :2] ** 2 @ curvatures / axis
            if q.max() >= 1:
                raise ValueError(
                    f"a block of half width {np.abs(points[:, :2]).max():g} m cannot carry the radii {radii} m"
                )
            sag = axis * (1 - np.sqrt(1 - q))
            displaced[:, 2] += (sag if hollow else -sag) * (1 + points[:, 2] / depth)
        return displaced

    return chart


def block_section(half_strip: int, size: float, half_width: float, depth: float) -> tuple[Array, Array, Mask]:
    """Polygon of a rectangular block with its top at z = 0: surface points, the remaining corners, and which edges are
    clamped (the bottom).

    Parameters:
        half_strip: number of cells on either side of the middle.
        size: of the cells, m.
        half_width, depth: of the block, m.
    """
    y = np.arange(-half_strip, half_strip + 1) * size
    surface = np.stack([y, np.zeros_like(y)], axis=1)
    boundary = np.array([[half_width, 0.0], [half_width, -depth], [-half_width, -depth], [-half_width, 0.0]])
    return surface, boundary, np.array([False, False, True, False, False])
