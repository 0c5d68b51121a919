"""Compliance of a body at its contact grid, from the factorised 3D stiffness, eq. (15).

C maps forces on grid nodes to displacements of grid nodes, in the body's own axes. It is computed by tiles (a few
neighbours along x on one line of the profile) and by direction, only where the body is loaded, and cached on disk.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.elasticity.compliance import block_diagonal
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.laws.material import Material
from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.cache import digest, load, store
from wheelrail.support.terminal import ProgressTimer

if TYPE_CHECKING:
    import scipy.sparse as sp

    from wheelrail.contact.elasticity.solid_body import ElasticBody
    from wheelrail.support.arrays import Nodes

log = logging.getLogger(__name__)


ALL: tuple[int, int, int] = (0, 1, 2)
FILLING = Lock()  # PETSc solves in one thread at a time
TILE = 8  # nodes along x: patches on the tread are half as long as the strip, which must hold those on the flange


@dataclass
class SurfaceCompliance:
    """Compliance matrix of an (nx, ns) grid, computed on demand.

    Parameters:
        key: identifies body, material and mesh in the cache; None: not cached.
        shape: (nx, ns).
        body: returns the elastic body, called when columns are missing.
        scale: factor from the body's displacements to m/N; a block of unit size and modulus serves all sizes: 1 / (E
            h).
    """

    key: str | None
    shape: tuple[int, int]
    body: Callable[[], ElasticBody]
    scale: float = 1.0
    _matrix: Array = field(init=False, repr=False)
    _filled: Mask = field(init=False, repr=False)
    _body: ElasticBody | None = field(init=False, default=None, repr=False)
    columns_solved: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        n = self.shape[0] * self.shape[1]
        # Symmetric, stored by loaded node: untouched pages occupy no memory.
        self._matrix = np.empty((3 * n, 3 * n))
        self._filled = np.zeros((n, 3), dtype=bool)

    def block(self, nodes: Nodes, directions: Sequence[int] = ALL) -> Array:
        """Symmetric compliance (d n, d n) [m/N], see `Compliance.turned`."""
        with FILLING:
            for direction in directions:
                self._fill(self._missing(nodes, direction), direction)
        unknowns = (3 * nodes[:, None] + np.asarray(directions)).ravel()
        return np.asarray(self._matrix[unknowns[:, None], unknowns])

    def turned(self, nodes: Nodes, directions: Sequence[int] = ALL) -> tuple[sp.csr_array, Array]:
        """The block without a rotation, see `Compliance.turned`."""
        block = self.block(nodes, directions)
        return block_diagonal(np.ones((len(block), 1, 1))), block

    def columns_missing(self, nodes: Nodes, directions: Sequence[int] = ALL) -> int:
        """Number of columns that a block takes and that are not in memory."""
        return TILE * sum(len(self._missing(nodes, direction)) for direction in directions)

    def _missing(self, nodes: Nodes, direction: int) -> list[tuple[int, int]]:
        """Groups of nodes with columns that are not in memory."""
        row, line = np.divmod(nodes[~self._filled[nodes, direction]], self.shape[1])
        return sorted(set(zip((row // TILE).tolist(), line.tolist(), strict=True)))

    def _fill(self, missing: Sequence[tuple[int, int]], direction: int) -> None:
        timer = ProgressTimer(log, f"compliance of a solid's surface in {'xyz'[direction]}, groups of nodes")
        for done, tile in enumerate(missing, 1):
            if self._load_cached(tile, direction):
                continue
            if self._body is None:
                self._body = self.body()
            # by tile, although larger batches are faster: the last bits depend on the batch
            columns = self._body.respond(self._nodes(tile), direction).reshape(-1, len(self._matrix))
            self.columns_solved += len(columns)
            if self.key is not None:
                store(self._name(tile, direction), {"columns": columns})
            self._insert(tile, direction, columns)
            timer(done, len(missing))

    def _nodes(self, tile: tuple[int, int]) -> Nodes:
        first = tile[0] * TILE
        return np.arange(first, min(first + TILE, self.shape[0])) * self.shape[1] + tile[1]

    def _name(self, tile: tuple[int, int], direction: int) -> str:
        return f"compliance/{self.key}/{tile[0]:03d}-{tile[1]:04d}{'xyz'[direction]}"

    def _load_cached(self, tile: tuple[int, int], direction: int) -> bool:
        stored = None if self.key is None else load(self._name(tile, direction))
        columns = None if stored is None else stored.get("columns")
        if columns is None or columns.shape != (len(self._nodes(tile)), len(self._matrix)):
            return False
        self._insert(tile, direction, columns)
        return True

    def _insert(self, tile: tuple[int, int], direction: int, columns: Array) -> None:
        nodes = self._nodes(tile)
        self._matrix[3 * nodes + direction] = columns * self.scale
        self._filled[nodes, direction] = True


def solid_compliance(
    solid: Solid, key: str, material: Material, degree: int, *, scale: float = 1.0
) -> SurfaceCompliance:
    """Surface compliance of a meshed body, cached on disk under the mesh's key, the material and the degree.

    Parameters:
        solid: mesh.
        key: of the mesh.
        material: of the body.
        degree: of the displacements, 1 or 2.
        scale: see `SurfaceCompliance`.
    """
    grid = ContactGrid.on(solid, degree)
    name = compliance_key(key, material, degree)
    return SurfaceCompliance(name, grid.shape, partial(elastic_body, solid, material, degree), scale=scale)


def compliance_key(key: str, material: Material, degree: int) -> str:
    """Key of a surface compliance in the cache; parameters as for `solid_compliance`."""
    return digest(mesh=key, E=material.E, nu=material.nu, degree=degree)


def compliance_of(body: ElasticBody) -> SurfaceCompliance:
    """Surface compliance of a body, cached on disk if the body has a key."""
    return SurfaceCompliance(body.key, body.grid.shape, lambda: body)


def elastic_body(solid: Solid, material: Material, degree: int) -> ElasticBody:
    """Stiffness of a meshed body; dolfinx is imported at the call.

    Parameters as for `solid_compliance`.
    """
    from wheelrail.contact.elasticity.solid_body import ElasticBody

    return ElasticBody(solid, material, degree=degree)


def distributed_body(solid: Solid, material: Material, degree: int, *, key: str | None = None) -> ElasticBody:
    """Stiffness of a meshed body, distributed over all processes of `mpirun`.

    Parameters as for `solid_compliance`; without a key, and on several processes, its compliance is not cached.
    """
    from wheelrail.contact.elasticity.solid_body import ElasticBody
    from wheelrail.support.mpi import world

    ranks = world()
    name = compliance_key(key, material, degree) if key is not None and ranks.size == 1 else None
    return ElasticBody(solid, material, degree=degree, ranks=ranks, key=name)
