"""Compliance of a body at its contact grid, from the factorised 3D stiffness, eq. (15).

C maps forces on grid nodes to displacements of grid nodes, in the body's own axes. It is found band by band (a band
is one line of nodes along x) and direction by direction, only where a scene loads the body, and kept on disk.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from contact.pose import Array, Mask
from meshes.cache import load, store

if TYPE_CHECKING:
    from contact.body import ElasticBody
    from meshes.triangulate import Index

ALL: tuple[int, int, int] = (0, 1, 2)


@dataclass
class SurfaceCompliance:
    """Compliance matrix of an (nx, ns) grid, filled on demand.

    key identifies body, material and mesh in the cache; body builds the elastic body when columns are missing; scale
    turns what the body gives into m/N (a block of unit size and modulus serves all sizes: 1 / (E h)).
    """

    key: str
    shape: tuple[int, int]
    body: Callable[[], ElasticBody]
    scale: float = 1.0
    _matrix: Array = field(init=False, repr=False)
    _filled: Mask = field(init=False, repr=False)
    _body: ElasticBody | None = field(init=False, default=None, repr=False)
    columns_solved: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        n = self.shape[0] * self.shape[1]
        # Symmetric, stored by loaded node: memory that is never touched is never taken.
        self._matrix = np.empty((3 * n, 3 * n))
        self._filled = np.zeros((self.shape[1], 3), dtype=bool)

    def block(self, nodes: Index, directions: Sequence[int] = ALL) -> Array:
        """Symmetric compliance (d n, d n) [m/N] between grid nodes (n,) along the given axes, node by node."""
        self._fill(np.unique(nodes % self.shape[1]), directions)
        place = (3 * nodes[:, None] + np.asarray(directions)).ravel()
        return np.asarray(self._matrix[place[:, None], place])

    def _fill(self, bands: Index, directions: Sequence[int]) -> None:
        for direction in directions:
            missing = [int(b) for b in bands if not self._filled[b, direction]]
            unknown = [band for band in missing if not self._recall(band, direction)]
            if unknown:
                if self._body is None:
                    self._body = self.body()
                columns = self._body.respond(np.concatenate([self._nodes(b) for b in unknown]), direction)
                self.columns_solved += len(columns)
                for band, part in zip(unknown, columns.reshape(len(unknown), self.shape[0], -1), strict=True):
                    store(self._name(band, direction), {"columns": part})
                    self._keep(band, direction, part)

    def _nodes(self, band: int) -> Index:
        return np.arange(self.shape[0]) * self.shape[1] + band

    def _name(self, band: int, direction: int) -> str:
        return f"compliance/{self.key}/{band:04d}{'xyz'[direction]}"

    def _recall(self, band: int, direction: int) -> bool:
        found = load(self._name(band, direction))
        columns = None if found is None else found.get("columns")
        if columns is None or columns.shape != (self.shape[0], len(self._matrix)):
            return False
        self._keep(band, direction, columns)
        return True

    def _keep(self, band: int, direction: int, columns: Array) -> None:
        self._matrix[3 * self._nodes(band) + direction] = columns * self.scale
        self._filled[band, direction] = True
