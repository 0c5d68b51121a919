"""The discrete problem of eq. (12) for one pose: contact forces on all displacements, and their tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from wheelrail.contact.elasticity.solid_body import ElasticBody
from wheelrail.contact.geometry.contact_operators import ContactOperators, pair_operators
from wheelrail.contact.geometry.grid_points import GridPoints
from wheelrail.contact.models.full.surface_traction import SurfaceLaw
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.mpi import Ranks


def spread(coupling: ContactOperators, body: ElasticBody) -> tuple[sp.csr_array, sp.csr_array | None]:
    """Operators of one body on its unknowns: the columns of this rank's."""
    nodes = body.nodes.ravel()[coupling.nodes]
    columns = (3 * nodes[:, None] + np.asarray(coupling.directions)).ravel()
    mine = np.repeat(nodes >= 0, len(coupling.directions))

    def widen(operator: sp.csr_array) -> sp.csr_array:
        kept = mine[operator.indices]
        pointer = np.concatenate([[0], np.cumsum(kept)])[operator.indptr]
        shape = (operator.shape[0], 3 * body.owned)
        return sp.csr_array((operator.data[kept], columns[operator.indices[kept]], pointer), shape=shape)

    return widen(coupling.displacement), None if coupling.slip is None else widen(coupling.slip)


@dataclass
class DiscreteProblem:
    """Contact forces and their tangent for one pose.

    Every rank has all rows (columns of B^T) for its own unknowns, the wheel's before the rail's.
    """

    ranks: Ranks
    law: SurfaceLaw
    nodes: Nodes
    displacement: sp.csr_array  # B, components (t1, t2, n) or (n)
    forces: sp.csr_array  # B^T, components (n, t1, t2)
    gradient: sp.csr_array  # G, rows (d, s1, s2)
    constant: Array  # z0

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

        bodies: wheel and rail, on the same ranks; order of the slip's difference formula; rigid (2 n,) rigid creepage
        at the points, None without friction.
        """
        wheel, rail = pair_operators(points, order if rigid is not None else 0)
        ranks = bodies[0].ranks
        (bw, sw), (br, sr) = spread(wheel, bodies[0]), spread(rail, bodies[1])
        displacement = sp.csr_array(sp.hstack([bw, -br], format="csr"))
        n = len(points.node)
        normal = displacement[-n:]
        if rigid is None or sw is None or sr is None:
            return cls(ranks, law, points.node, displacement, normal.T.tocsr(), normal, points.overlap)
        gradient = sp.csr_array(sp.vstack([normal, sp.hstack([sw, -sr])], format="csr"))
        ordered = sp.csr_array(sp.vstack([normal, displacement[: 2 * n]], format="csr"))
        constant = np.concatenate([points.overlap, rigid])
        return cls(ranks, law, points.node, displacement, ordered.T.tocsr(), gradient, constant)

    def state(self, u: Array) -> tuple[Array, Array]:
        """z (n, c) and nodal forces T (n, c) at displacements u, this rank's."""
        z = self._at(u)
        return z, self.ranks.shared(lambda: self.law.force(self.nodes, z))

    def contact_forces(self, u: Array) -> Array:
        """B^T T, forces of the contact on this rank's unknowns [N]."""
        return np.asarray(self.forces @ self.state(u)[1].T.ravel())

    def tangent(self, u: Array) -> sp.csr_array:
        """D G: change of the nodal contact forces with the displacements."""
        z = self._at(u)
        blocks = self.ranks.shared(lambda: self.law.tangent(self.nodes, z))
        c = self.law.components
        rows = [sp.hstack([sp.diags(blocks[:, i, j]) for j in range(c)]) for i in range(c)]
        return sp.csr_array(sp.vstack(rows, format="csr") @ self.gradient)

    def _at(self, u: Array) -> Array:
        """z (n, c)."""
        return (self.constant + self.ranks.total(self.gradient @ u)).reshape(self.law.components, -1).T
