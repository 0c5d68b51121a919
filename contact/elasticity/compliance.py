"""Surface compliance of a body, as the contact models call it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.support.arrays import Nodes


class Compliance(Protocol):
    """Compliance of a body at an (nx, ns) grid of its surface."""

    @property
    def shape(self) -> tuple[int, int]: ...

    def block(self, nodes: Nodes, directions: Sequence[int] = ...) -> Array:
        """Symmetric compliance (d n, d n) [m/N] between grid nodes (n,) along the given axes, node by node."""
