"""Interpolation operators B between the nodes of both surfaces and the contact points, with slip by differences
upstream.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from wheelrail.contact.geometry.grid_points import GridPoints, Interpolation
from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True)
class ContactOperators:
    """Operators B of one body on the d Cartesian directions of its nodes (m,): displacement (c n, d m) in the local
    axes of the points, component by component, and slip (2 n, d m), the elastic slip over the rolling speed by
    upstream differences (None without friction). Directions that no local axis has a part in are left out.
    """

    nodes: Nodes
    directions: tuple[int, ...]
    displacement: sp.csr_array
    slip: sp.csr_array | None


# Upstream differences of first and second order for du(x) = -d u / d x: multiples of u(x), u(x + h), u(x + 2 h) over h
UPSTREAM = {1: (1.0, -1.0), 2: (1.5, -2.0, 0.5)}


def contact_operators(points: GridPoints, interpolation: Interpolation, axes: Array, order: int) -> ContactOperators:
    """Operators from the nodal values that an interpolation (row by row of points.upstream) takes, eqs. (1) and (5).

    axes (n, 3, 3) are the local axes in the body's own frame; order 0 leaves out everything tangential.
    """
    n, k = len(points.node), interpolation.nodes.shape[1]
    used, place = np.unique(interpolation.nodes, return_inverse=True)
    place = place.reshape(-1, n, k)  # (steps, n, k)
    weight = interpolation.weights.reshape(-1, n, k)
    components = (2,) if order == 0 else (0, 1, 2)
    directions = np.flatnonzero(np.abs(axes[:, components]).max(axis=(0, 1)) > 0)
    d = len(directions)
    axes = axes[:, :, directions]

    def rows(component: int, places: Nodes, weights: Array) -> tuple[Array, Nodes]:
        data = weights[..., None] * axes[:, component, None, :]
        return data.reshape(n, -1), (d * places[..., None] + np.arange(d)).reshape(n, -1)

    def operator(parts: list[tuple[Array, Nodes]]) -> sp.csr_array:
        data, columns = (np.concatenate(part) for part in zip(*parts, strict=True))
        pointer = np.arange(len(data) + 1) * data.shape[1]
        return sp.csr_array((data.ravel(), columns.ravel(), pointer), shape=(len(data), d * len(used)))

    displacement = operator([rows(c, place[0], weight[0]) for c in components])
    if order == 0:
        return ContactOperators(used, tuple(directions.tolist()), displacement, None)
    factors = np.array(UPSTREAM[order])[:, None, None] / points.step[None, :, None]
    many = np.moveaxis(place, 0, 1).reshape(n, -1)
    weighted = np.moveaxis(weight * factors, 0, 1).reshape(n, -1)
    return ContactOperators(
        used, tuple(directions.tolist()), displacement, operator([rows(c, many, weighted) for c in (0, 1)])
    )


def pair_operators(points: GridPoints, order: int) -> tuple[ContactOperators, ContactOperators]:
    """Operators of wheel and rail for the same points: relative displacement is B_w U_w - B_r U_r."""
    own = Interpolation(points.upstream.reshape(-1, 1), np.ones((points.upstream.size, 1)))
    wheel = contact_operators(points, own, points.axes @ points.wheel_rotation, order)
    return wheel, contact_operators(points, points.rail, points.axes, order)
