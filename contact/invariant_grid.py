"""The contact grid of a body invariant along x or in angle: no 3D mesh, any step."""

from __future__ import annotations

import numpy as np

from contact.grid import ContactGrid
from contact.pose import Array


def surface_points(corners: Array, degree: int) -> Array:
    """Nodes (ns, 2) m of displacements of the degree (1 or 2) on the straight edges between corners (m, 2) m."""
    if degree == 1:
        return corners
    out = np.empty((2 * len(corners) - 1, 2))
    out[::2], out[1::2] = corners, 0.5 * (corners[1:] + corners[:-1])
    return out


def invariant_grid(points: Array, rows: int, step: float, *, radius: float | None = None) -> ContactGrid:
    """Contact grid of cells of the length step [m] along x (on the circle of the radius [m] about y, or straight) by
    the points (ns, 2) m of the surface, weighted by the integral of their hats.
    """
    x = (np.arange(rows) - rows // 2) * step
    length = np.hypot(*np.diff(points, axis=0).T)
    stretch = np.ones(len(points)) if radius is None else points[:, 1] / radius
    tributary = np.zeros(len(points))
    tributary[:-1] += length * (2 * stretch[:-1] + stretch[1:]) / 6
    tributary[1:] += length * (stretch[:-1] + 2 * stretch[1:]) / 6
    position = np.empty((rows, len(points), 3))
    position[..., 1] = points[:, 0]
    if radius is None:
        position[..., 0], position[..., 2] = x[:, None], points[:, 1]
    else:
        position[..., 0] = np.sin(x / radius)[:, None] * points[:, 1]
        position[..., 2] = -np.cos(x / radius)[:, None] * points[:, 1]
    return ContactGrid(position, np.broadcast_to(step * tributary, (rows, len(points))), 1)
