"""Interface of the surface compliance of a body to the contact models, and its condensation to contact points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from wheelrail.contact.geometry.contact_operators import ContactOperators
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.support.arrays import Nodes


class Compliance(Protocol):
    """Compliance of a body at an (nx, ns) grid of its surface."""

    @property
    def shape(self) -> tuple[int, int]:
        """Nodes (nx, ns) along x and across."""

    def block(self, nodes: Nodes, directions: Sequence[int] = ...) -> Array:
        """Symmetric compliance (d n, d n) [m/N] between grid nodes, node by node.

        Parameters:
            nodes: (n,) of the flattened grid.
            directions: the d axes.
        """


def condense(coupling: ContactOperators, compliance: Compliance) -> tuple[Array, Array]:
    """B C B^T of one body: displacements m/N and slips 1/N (rows) at the points by forces on them (columns), component
    by component.
    """
    matrix = compliance.block(coupling.nodes, coupling.directions)
    half = (coupling.displacement @ matrix).T  # C B^T, C symmetric
    displacement = coupling.displacement @ half
    if coupling.slip is None:
        return displacement, np.empty((0, displacement.shape[1]))
    return displacement, coupling.slip @ half
