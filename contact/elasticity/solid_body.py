"""Stiffness of a clamped elastic body by 3D finite elements (dolfinx), factorised on request."""

from __future__ import annotations

import logging
from functools import cached_property
from typing import Any

import numpy as np
from dolfinx import fem
from petsc4py import PETSc
from scipy.spatial import cKDTree

from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.laws.material import Material
from wheelrail.forms import compat
from wheelrail.forms.compilation import compiled
from wheelrail.forms.elasticity import lame, stiffness
from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.support.arrays import Array, Mask, Nodes
from wheelrail.support.memory import check_memory, factor_memory, factor_seconds
from wheelrail.support.mpi import SELF, Ranks

log = logging.getLogger(__name__)

COLUMNS = 192  # right-hand sides per batch: enough for level-3 BLAS, small in memory


class ElasticBody:
    """Stiffness of a clamped body, eq. (3), and the displacement nodes of its contact grid.

    Parameters:
        solid: mesh, known to all ranks.
        steel: material.
        degree: of the displacements, 1 or 2.
        ranks: communicator over which mesh, displacements and stiffness are distributed.
        key: of its surface compliance in the cache; None: not cached.

    Raises ValueError for more ranks than the mesh can be divided into.
    """

    def __init__(
        self, solid: Solid, steel: Material, *, degree: int = 1, ranks: Ranks = SELF, key: str | None = None
    ) -> None:
        self.solid, self.steel, self.degree, self.ranks, self.key = solid, steel, degree, ranks, key
        rows = slice(None) if ranks.first else slice(0)  # dolfinx distributes the mesh of the first rank
        self.mesh = compat.mesh_from_arrays(ranks.comm, solid.cell, solid.cells[rows], solid.points[rows])
        self.space = compat.space(self.mesh, degree)
        self.grid = ContactGrid.on(solid, degree)
        empty_ranks = ranks.all_reduce(np.array(float(self.owned == 0)))
        if empty_ranks > 0:
            raise ValueError(
                f"a mesh of {len(solid.points)} points leaves {empty_ranks:.0f} of {ranks.size} processes without nodes"
            )

    @property
    def owned(self) -> int:
        """Number of displacement nodes owned by this rank, the first of its local numbering."""
        return int(self.space.dofmap.index_map.size_local)

    @property
    def coordinates(self) -> Array:
        """Coordinates (owned, 3) m of this rank's displacement nodes."""
        return np.asarray(self.space.tabulate_dof_coordinates()[: self.owned])

    @cached_property
    def nodes(self) -> Nodes:
        """Displacement nodes (nx, ns) of the contact grid; -1 where another rank owns them."""
        distance, nodes = cKDTree(self.coordinates).query(self.grid.position.reshape(-1, 3))
        local = distance <= 1e-6 * np.linalg.norm(self.grid.position[1, 0] - self.grid.position[0, 0])
        if not (self.ranks.all_reduce(local.astype(float)) == 1).all():
            raise RuntimeError("the contact grid does not lie on nodes of the displacement space")
        return np.where(local, nodes, -1).astype(np.int64).reshape(self.grid.shape)

    @cached_property
    def fixed(self) -> Nodes:
        """Displacement nodes of the clamped surface."""
        _, vertex = cKDTree(self.solid.points).query(self.mesh.geometry.x)
        clamped = self.solid.clamped[vertex]
        corners = cKDTree(self.mesh.geometry.x)

        def on_clamped(x: Array) -> Mask:
            return np.asarray(clamped[corners.query(x.T)[1]])

        from dolfinx import mesh as dmesh

        facets = dmesh.locate_entities_boundary(self.mesh, 2, on_clamped)
        return np.asarray(fem.locate_dofs_topological(self.space, 2, facets), dtype=np.int64)

    @cached_property
    def stiffness(self) -> PETSc.Mat:
        """Stiffness matrix [N/m]; rows and columns of clamped nodes are a scaled identity."""
        import ufl

        u, v = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        form = compiled(stiffness(u, v, *lame(self.steel.E, self.steel.nu)))
        zero = np.zeros(3, dtype=PETSc.ScalarType)
        bc = fem.dirichletbc(zero, self.fixed.astype(np.int32), self.space)
        # A diagonal of one, relative to 1e9 elsewhere, would distort norms of residuals.
        typical = self.steel.E * float(np.cbrt(self.solid.volume() / len(self.solid.points)))
        matrix = compat.assemble_matrix(form, bc, typical)
        matrix.setOption(PETSc.Mat.Option.SPD, True)
        compat.freed_with(self, matrix)
        return matrix

    @cached_property
    def factor(self) -> Any:
        """Sparse Cholesky factorisation of the stiffness, see `compat.set_cholesky`; RuntimeError if it fails."""
        unknowns = self.stiffness.getSize()[0]
        memory, seconds = factor_memory(unknowns), factor_seconds(unknowns)
        log.info("stiffness of a solid: %d unknowns, about %.1f GB of memory, %.1f s", unknowns, memory, seconds)
        check_memory(f"stiffness of a solid: {unknowns} unknowns", memory / self.ranks.size)
        pc = PETSc.PC().create(self.ranks.comm)
        pc.setOperators(self.stiffness)
        compat.set_cholesky(pc)
        pc.setUp()
        factor = pc.getFactorMatrix()
        if self.ranks.size > 1 and (error := factor.getMumpsInfog(1)) < 0:  # PETSc reports it at the first solve only
            raise RuntimeError(f"stiffness of a solid: error {error} of MUMPS in its factorisation")
        self._pc = pc  # owns the factor
        compat.freed_with(self, pc, factor)
        return factor

    def solve(self, force: Array) -> Array:
        """Displacements m by forces N, both on the unknowns of this rank."""
        right = PETSc.Vec().createWithArray(force, comm=self.ranks.comm)
        left = right.duplicate()
        self.factor.solve(right, left)
        displacement = np.array(left.getArray())
        right.destroy()
        left.destroy()
        return displacement

    def respond(self, loaded: Nodes, direction: int) -> Array:
        """Displacements (m, n, 3) [m] of all n grid nodes by unit forces.

        Parameters:
            loaded: (m,) grid nodes, each loaded alone.
            direction: axis of the forces.

        One sparse solve per load: about 3 ms at 36 000 unknowns, 10 ms at 100 000.
        """
        nodes = self.nodes.ravel()
        owned = nodes >= 0
        rows = (3 * nodes[owned, None] + np.arange(3)).ravel()
        out = np.zeros((len(loaded), len(nodes), 3))
        for start in range(0, len(loaded), COLUMNS):
            batch = nodes[loaded[start : start + COLUMNS]]
            right = PETSc.Mat().createDense([self.stiffness.getSizes()[0], [None, len(batch)]], comm=self.ranks.comm)
            right.setUp()
            dense = right.getDenseArray()
            dense[:] = 0.0
            column = np.flatnonzero(batch >= 0)
            dense[3 * batch[column] + direction, column] = 1.0
            right.assemble()
            left = right.duplicate()
            self.factor.matSolve(right, left)
            out[start : start + COLUMNS, owned] = left.getDenseArray()[rows].T.reshape(len(batch), -1, 3)
            right.destroy()
            left.destroy()
        return self.ranks.all_reduce(out)
