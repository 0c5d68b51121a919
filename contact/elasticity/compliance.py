"""Interface of the surface compliance of a body to the contact models."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

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
