"""Contact interpolation operators B between surface nodes and contact points, with slip by upstream differences.

Differences of the wheel's displacement u as vectors contain u_r / r, for a compressed wheel rolls on a smaller radius.
Contact points are places in space: at the point s the material is that of s - u_t, whose radius differs from that in
the rigid slip at s by as much as u_t adds to u_r. The part of u_t is therefore taken out, kappa u_t with the geodesic
curvature kappa of the circles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from wheelrail.contact.geometry.grid_points import GridPoints, Interpolation
from wheelrail.support.arrays import Array, Nodes


@dataclass(frozen=True)
class ContactOperators:
    """Contact interpolation operators B of one body; columns are d Cartesian directions of its nodes.

    Parameters:
        nodes: (m,) of the body's grid.
        directions: the d directions; those without a component along any local axis are omitted.
        displacement: (c n, d m), displacement in the local axes of the points, component by component.
        slip: (2 n, d m), elastic slip over the rolling speed by upstream differences; None without friction.
    """

    nodes: Nodes
    directions: tuple[int, ...]
    displacement: sp.csr_array
    slip: sp.csr_array | None


# Upstream differences of first and second order for -du/dx: coefficients of u(x), u(x + h), u(x + 2 h) over h
UPSTREAM = {1: (1.0, -1.0), 2: (1.5, -2.0, 0.5)}


def contact_operators(
    points: GridPoints, interpolation: Interpolation, axes: Array, order: int, *, tangential: bool = False
) -> ContactOperators:
    """Contact interpolation operators of one body, eqs. (1) and (5).

    Parameters:
        points: n contact points.
        interpolation: from the body's nodes to the points, row by row of points.upstream.
        axes: (n, 3, 3), local axes in the body's own frame.
        order: of the upstream differences, 1 or 2; 0 omits the slip.
        tangential: whether to include the tangential components without slip, too.
    """
    n, k = len(points.node), interpolation.nodes.shape[1]
    used, column = np.unique(interpolation.nodes, return_inverse=True)
    column = column.reshape(-1, n, k)  # (steps, n, k)
    weight = interpolation.weights.reshape(-1, n, k)
    components = (0, 1, 2) if order > 0 or tangential else (2,)
    directions = np.flatnonzero(np.abs(axes[:, components]).max(axis=(0, 1)) > 0)
    d = len(directions)
    axes = axes[:, :, directions]

    def rows(component: int, node_columns: Nodes, weights: Array) -> tuple[Array, Nodes]:
        data = weights[..., None] * axes[:, component, None, :]
        return data.reshape(n, -1), (d * node_columns[..., None] + np.arange(d)).reshape(n, -1)

    def operator(parts: list[tuple[Array, Nodes]]) -> sp.csr_array:
        data, columns = (np.concatenate(part) for part in zip(*parts, strict=True))
        pointer = np.arange(len(data) + 1) * data.shape[1]
        return sp.csr_array((data.ravel(), columns.ravel(), pointer), shape=(len(data), d * len(used)))

    displacement = operator([rows(c, column[0], weight[0]) for c in components])
    if order == 0:
        return ContactOperators(used, tuple(directions.tolist()), displacement, None)
    factors = np.array(UPSTREAM[order])[:, None, None] / points.step[None, :, None]
    upstream_columns = np.moveaxis(column, 0, 1).reshape(n, -1)
    weighted = np.moveaxis(weight * factors, 0, 1).reshape(n, -1)
    return ContactOperators(
        used, tuple(directions.tolist()), displacement, operator([rows(c, upstream_columns, weighted) for c in (0, 1)])
    )


def pair_operators(
    points: GridPoints, order: int, *, tangential: bool = False
) -> tuple[ContactOperators, ContactOperators]:
    """Operators of wheel and rail at the same points: the relative displacement is B_w U_w - B_r U_r.

    Parameters as for `contact_operators`.
    """
    identity = Interpolation(points.upstream.reshape(-1, 1), np.ones((points.upstream.size, 1)))
    wheel = contact_operators(points, identity, points.axes @ points.wheel_rotation, order, tangential=tangential)
    if wheel.slip is not None and points.circle_curvature[0].any():
        n = len(points.node)
        lateral = sp.csr_array(wheel.displacement[n : 2 * n].multiply(points.circle_curvature[0, :, None]))
        wheel = replace(wheel, slip=wheel.slip - sp.vstack([lateral, sp.csr_array(lateral.shape)], format="csr"))
    return wheel, contact_operators(points, points.rail, points.axes, order, tangential=tangential)
