"""Displacement of each body at the contact points of a grid, for the material that touches."""

from __future__ import annotations

from wheelrail.bindings._contact import BodyDisplacements
from wheelrail.contact.elasticity.compliance import Compliance
from wheelrail.contact.geometry.contact_operators import pair_operators
from wheelrail.contact.geometry.grid_points import GridPoints
from wheelrail.support.arrays import Array


def body_displacements(points: GridPoints, loads: Array, bodies: tuple[Compliance, Compliance]) -> BodyDisplacements:
    """Displacements B C B^T f of wheel and rail at n contact points.

    Parameters:
        points: of contact.
        loads: (n, 3) N on the wheel, in the points' axes.
        bodies: compliance of wheel and rail on their grids.
    """
    displacements = []
    for operators, body, sign in zip(pair_operators(points, 0, tangential=True), bodies, (1.0, -1.0), strict=True):
        forces = operators.displacement.T @ (sign * loads.T.ravel())
        response = body.block(operators.nodes, operators.directions) @ forces
        displacements.append((operators.displacement @ response).reshape(3, -1))
    wheel, rail = displacements
    return BodyDisplacements(wheel[1], rail[1], wheel[2])
