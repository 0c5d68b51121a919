"""The discrete problem of eq. (12) for one pose: contact forces by nodal displacements, and their tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from wheelrail.contact.elasticity.compliance import Compliance, condense
from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.geometry.contact_operators import ContactOperators, pair_operators
from wheelrail.contact.geometry.grid_points import GridPoints
from wheelrail.contact.models.full.primal_dual import primal_dual_tangent
from wheelrail.contact.models.full.surface_traction import SurfaceLaw
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.mpi import Ranks


def extended(operators: ContactOperators, body: ElasticBody) -> tuple[sp.csr_array, sp.csr_array | None]:
    """Operators of displacement and slip on all unknowns of one body, the columns of this rank."""
    nodes = body.nodes.ravel()[operators.nodes]
    columns = (3 * nodes[:, None] + np.asarray(operators.directions)).ravel()
    owned = np.repeat(nodes >= 0, len(operators.directions))

    def extend(operator: sp.csr_array) -> sp.csr_array:
        entries = owned[operator.indices]
        pointer = np.concatenate([[0], np.cumsum(entries)])[operator.indptr]
        shape = (operator.shape[0], 3 * body.owned)
        return sp.csr_array((operator.data[entries], columns[operator.indices[entries]], pointer), shape=shape)

    return extend(operators.displacement), None if operators.slip is None else extend(operators.slip)


def body_displacements(points: GridPoints, u: Array, bodies: tuple[ElasticBody, ElasticBody]) -> Array:
    """Displacements (2, 3, n) m of wheel and rail at contact points in their axes, from unknowns u."""
    split = 3 * bodies[0].owned
    return np.array(
        [
            bodies[0].ranks.all_reduce(extended(operators, body)[0] @ own).reshape(3, -1)
            for operators, body, own in zip(
                pair_operators(points, 0, tangential=True), bodies, (u[:split], u[split:]), strict=True
            )
        ]
    )


@dataclass(frozen=True)
class Linearisation:
    """Contact at displacements, n points with c components.

    Parameters:
        z: (n, c), penetration m and slip.
        forces: (n, c) N, T.
        tangent: D, (n, c, c).
    """

    z: Array
    forces: Array
    tangent: Array


@dataclass
class DiscreteProblem:
    """Contact forces and their tangent for one pose, for n contact points and c components.

    Parameters:
        ranks: processes of the solve; each has all rows (columns of B^T) of its own unknowns, wheel before rail.
        law: of contact.
        nodes: (n,), of the contact grid.
        displacement: B, rows of components (t1, t2, n) or (n).
        forces: B^T, columns of components (n, t1, t2) or (n).
        gradient: G, rows (d, s1, s2) or (d).
        constant: z0.
        operators: of wheel and rail on their surface grids.
        compliance: C = G K^-1 B^T (c n, c n) m/N and 1/N, see `condense`; None before.
    """

    ranks: Ranks
    law: SurfaceLaw
    nodes: Nodes
    displacement: sp.csr_array
    forces: sp.csr_array
    gradient: sp.csr_array
    constant: Array
    operators: tuple[ContactOperators, ContactOperators]
    compliance: Array | None = None

    @classmethod
    def of(
        cls,
        points: GridPoints,
        bodies: tuple[ElasticBody, ElasticBody],
        law: SurfaceLaw,
        order: int,
        rigid: Array | None,
    ) -> DiscreteProblem:
        """Problem at the contact points of one pose.

        Parameters:
            points: of contact.
            bodies: wheel and rail, on the same ranks.
            law: of contact.
            order: of the upstream difference formula for the slip, 1 or 2.
            rigid: (2 n,) rigid creepage at the points, None without friction.
        """
        wheel, rail = pair_operators(points, order if rigid is not None else 0)
        ranks = bodies[0].ranks
        (bw, sw), (br, sr) = extended(wheel, bodies[0]), extended(rail, bodies[1])
        displacement = sp.csr_array(sp.hstack([bw, -br], format="csr"))
        n = len(points.node)
        normal = displacement[-n:]
        if rigid is None or sw is None or sr is None:
            return cls(
                ranks, law, points.node, displacement, normal.T.tocsr(), normal, points.penetration, (wheel, rail)
            )
        gradient = sp.csr_array(sp.vstack([normal, sp.hstack([sw, -sr])], format="csr"))
        ordered = sp.csr_array(sp.vstack([normal, displacement[: 2 * n]], format="csr"))
        constant = np.concatenate([points.penetration, rigid])
        return cls(ranks, law, points.node, displacement, ordered.T.tocsr(), gradient, constant, (wheel, rail))

    def state(self, u: Array) -> tuple[Array, Array]:
        """z (n, c) and nodal forces T (n, c) N at displacements u m of this rank."""
        z = self._at(u)
        return z, self.ranks.broadcast(lambda: self.law.force(self.nodes, z))

    def contact_forces(self, u: Array) -> Array:
        """B^T T: contact forces N on the unknowns of this rank."""
        return np.asarray(self.forces @ self.state(u)[1].T.ravel())

    def linearised(self, u: Array, predicted: Array) -> Linearisation:
        """Contact and its tangent at displacements u m of this rank; predicted: as for `primal_dual_tangent`."""
        z, forces = self.state(u)
        derivative = self.ranks.broadcast(lambda: self.law.tangent(self.nodes, z))
        return Linearisation(z, forces, primal_dual_tangent(derivative, z, forces, predicted))

    def change(self, tangent: Array, u: Array) -> Array:
        """D G u: change (n, c) N of the nodal forces by one of the displacements m of this rank, from D (n, c, c)."""
        by_point = self.ranks.all_reduce(self.gradient @ u).reshape(self.law.components, -1)
        return np.asarray(np.einsum("nij,jn->ni", tangent, by_point))

    def condense(self, bodies: tuple[Compliance, Compliance]) -> None:
        """Set the compliance between the contact points from that of the surfaces of wheel and rail."""
        (d1, s1), (d2, s2) = (condense(own, body) for own, body in zip(self.operators, bodies, strict=True))
        n = len(self.nodes)
        rows = np.vstack([(d1 + d2)[-n:], s1 + s2])
        self.compliance = np.roll(rows, n, axis=1)  # columns of components (t1, t2, n) to (n, t1, t2)

    def reduced(self, tangent: Array) -> Array:
        """1 - D C (c n, c n), from D (n, c, c): the linearised contact condensed to the nodal forces."""
        assert self.compliance is not None
        n, c = tangent.shape[:2]
        product = np.einsum("nij,jnm->inm", tangent, self.compliance.reshape(c, n, c * n))
        return np.asarray(np.eye(c * n) - product.reshape(c * n, c * n))

    def predicted(self, z: Array, forces: Array) -> Array:
        """Nodal forces (n, c) N by the linear response to a change of pose: (1 - D C) T' = T + D (z0 - z).

        Parameters:
            z, forces: (n, c), of an earlier solution at the same nodes, where D is taken.
        """
        tangent = self.ranks.broadcast(lambda: self.law.tangent(self.nodes, z))
        change = self.constant.reshape(self.law.components, -1).T - z
        right = forces + np.einsum("nij,nj->ni", tangent, change)
        return np.asarray(np.linalg.solve(self.reduced(tangent), right.T.ravel()).reshape(right.shape[::-1]).T)

    def by_traction(self, area: Array) -> Array:
        """Compliance (c n, c n) of rows (s1, s2, d) or (d) by tractions Pa of components (t1, t2, n) or (n).

        Parameters:
            area: (n,) of the points, m2.
        """
        assert self.compliance is not None
        n = len(self.nodes)
        ordered = np.roll(np.roll(self.compliance, -n, axis=0), -n, axis=1)
        return np.asarray(ordered * np.tile(area, self.law.components))

    def _at(self, u: Array) -> Array:
        """z (n, c)."""
        return (self.constant + self.ranks.all_reduce(self.gradient @ u)).reshape(self.law.components, -1).T
