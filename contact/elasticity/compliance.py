"""Interface of the surface compliance of a body to the contact models, and its condensation to contact points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
import scipy.sparse as sp

from wheelrail.contact.geometry.contact_operators import ContactOperators
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.support.arrays import Nodes

TOGETHER = 64  # forces, whose displacements of a body stay in the processor's cache


class Compliance(Protocol):
    """Compliance of a body at an (nx, ns) grid of its surface."""

    @property
    def shape(self) -> tuple[int, int]:
        """Nodes (nx, ns) along x and across."""

    def turned(self, nodes: Nodes, directions: Sequence[int] = ...) -> tuple[sp.csr_array, Array]:
        """Compliance between grid nodes, node by node, as R L R^T: R (d n, m), at most two numbers a row, and the
        symmetric L (m, m) m/N.

        Parameters:
            nodes: (n,) of the flattened grid.
            directions: the d axes.
        """


def block_diagonal(blocks: Array) -> sp.csr_array:
    """Sparse matrix (r n, c n) with n blocks (n, r, c) on its diagonal."""
    n = len(blocks)
    out = sp.csr_array(sp.bsr_array((blocks, np.arange(n), np.arange(n + 1)), blocksize=blocks.shape[1:]))
    out.eliminate_zeros()
    return out


def condense(coupling: ContactOperators, compliance: Compliance) -> tuple[Array, Array]:
    """B C B^T of one body: displacements m/N and slips 1/N (rows) at the points by forces on them (columns), component
    by component.
    """
    turn, matrix = compliance.turned(coupling.nodes, coupling.directions)
    columns = coupling.displacement @ turn
    rows = columns if coupling.slip is None else sp.vstack([columns, coupling.slip @ turn], format="csr")
    out = np.empty((rows.shape[0], columns.shape[0]))
    for first in range(0, columns.shape[0], TOGETHER):
        few = slice(first, first + TOGETHER)
        out[:, few] = rows @ (columns[few] @ matrix).T  # L is symmetric
    return out[: columns.shape[0]], out[columns.shape[0] :]
