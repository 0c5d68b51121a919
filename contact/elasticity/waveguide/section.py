"""Stiffness of the cross-section of a waveguide as a function of the wavenumber."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem
from mpi4py import MPI
from scipy.spatial import cKDTree

from wheelrail.contact.elasticity.waveguide.nested_dissection import Dissection, dissect
from wheelrail.contact.geometry.surface_grid import surface_points
from wheelrail.contact.laws.material import Material
from wheelrail.forms import compat
from wheelrail.forms.compilation import compiled
from wheelrail.forms.elasticity import lame
from wheelrail.forms.waveguide import wavenumber_forms
from wheelrail.meshes.bodies.triangulation import SectionMesh
from wheelrail.support.arrays import Array, Nodes

# Integrals of an edge's quadratic shape functions (end, middle, end) over its first and its second half, unit length
HALVES = np.array([[5, 8, -1], [-1, 8, 5]]) / 24


class WaveguideSection:
    """Clamped body invariant along x or in angle: K(k) = A0 + k A1 + k^2 A2 of its triangulated section.

    Parameters:
        mesh: of the section.
        steel: material.
        degree: of the displacements, 1 or 2.
        radius: m; the body is one of revolution, its section in (y, r), and k = n / radius the wavenumber on the circle
            of that radius; None: prismatic, its section in (y, z).
    """

    def __init__(self, mesh: SectionMesh, steel: Material, *, degree: int = 1, radius: float | None = None) -> None:
        self.section, self.steel, self.degree, self.radius = mesh, steel, degree, radius
        self.mesh = compat.mesh_from_arrays(MPI.COMM_SELF, "triangle", mesh.cells, mesh.points)
        self.space = compat.space(self.mesh, degree)
        self.points: Array = self.space.tabulate_dof_coordinates()[:, :2]
        self._tree = cKDTree(self.points)

    @cached_property
    def surface(self) -> Nodes:
        """Displacement nodes of the contact surface in order, with midpoints of edges for degree 2."""
        return self.nodes(surface_points(self.section.points[self.section.surface], self.degree))

    def nodes(self, points: Array) -> Nodes:
        """Displacement nodes at points (m, 2) m. Raises RuntimeError for a point that is no node."""
        distance, nodes = self._tree.query(points)
        if distance.max() > 1e-9 * np.ptp(self.points, axis=0).max():
            raise RuntimeError("a point of the contact surface is not a node of the displacement space")
        return np.asarray(nodes, dtype=np.int64)

    @cached_property
    def fixed(self) -> Nodes:
        """Displacement nodes of the clamped boundary."""
        from dolfinx import mesh as dmesh

        corners = cKDTree(self.section.points)
        clamped = self.section.clamped
        facets = dmesh.locate_entities_boundary(self.mesh, 1, lambda x: clamped[corners.query(x[:2].T)[1]])
        return np.asarray(fem.locate_dofs_topological(self.space, 1, facets), dtype=np.int64)

    @cached_property
    def matrices(self) -> tuple[Nodes, Nodes, tuple[Array, Array, Array]]:
        """Row pointers and columns common to the three matrices, and the values of A0, A1, A2."""
        U, V = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        r = None if self.radius is None else ufl.SpatialCoordinate(self.mesh)[1]
        λ, μ = (fem.Constant(self.mesh, value) for value in lame(self.steel.E, self.steel.nu))
        forms = wavenumber_forms(U, V, λ, μ, radius=r, degree=self.degree)
        (pointer, columns, A0), (_, _, A1), (_, _, A2) = (compat.assemble_csr(compiled(form)) for form in forms)
        return pointer.astype(np.int64), columns.astype(np.int64), (A0, A1, A2)

    @cached_property
    def dissection(self) -> Dissection:
        """Order of elimination down to the contact surface, the same for every wavenumber."""
        pointer, columns, _ = self.matrices
        return dissect(pointer, columns, self.points, kept=self.surface, fixed=self.fixed)

    def stiffness(self, k: float) -> Array:
        """Values of K(k) in the common sparsity at a wavenumber [1/m], per unit length or per unit angle."""
        A0, A1, A2 = self.matrices[2]
        k = k * (self.radius or 1.0)
        return np.asarray(A0 + k * A1 + k * k * A2)

    def flexibility(self, k: float) -> Array:
        """H(k) (3 ns, 3 ns) [m2/N], displacement amplitudes at the surface's corners by harmonic line loads there.

        On linear triangles loads and displacements are nodal. On quadratic ones loads are uniform up to halfway to the
        neighbours and displacements averaged likewise, as forces on single nodes would act differently at corners and
        midpoints. On a body of revolution the load per unit length is measured on the circle of the radius.
        """
        H = self.dissection.flexibility(self.stiffness(k)) * (self.radius or 1.0)
        if self.degree == 1:
            return H
        return np.asarray(self.cells @ (self.cells @ H).T)

    def displacement(self, k: float, loads: Array) -> Array:
        """Displacement amplitudes (3 n, m) of all nodes by harmonic line loads.

        Parameters:
            k: wavenumber, 1/m.
            loads: (3 ns, m), at the surface's corners, distributed as for `flexibility`.
        """
        nodal = loads if self.degree == 1 else self.cells.T @ loads
        return self.dissection.solve(self.stiffness(k), nodal * (self.radius or 1.0), 3 * len(self.points))

    @cached_property
    def cells(self) -> sp.csr_array:
        """Operator of the mean of a quadratic displacement over the cell of every corner of the surface."""
        edge = np.hypot(*np.diff(self.section.points[self.section.surface], axis=0).T)
        number = np.arange(len(edge))[:, None, None]
        row, column = np.broadcast_arrays(number + np.arange(2)[:, None], 2 * number + np.arange(3))
        integral = edge[:, None, None] * HALVES
        total = sp.coo_array((integral.ravel(), (row.ravel(), column.ravel()))).tocsr()
        mean = sp.diags(1 / np.asarray(total.sum(axis=1)).ravel()) @ total
        return sp.csr_array(sp.kron(mean, sp.identity(3)))
