"""The contact law of `wheelrail.forms.traction` on the contact surface, assembled by dolfinx point by point.

Penetration and slip are coefficients of the traction on a mesh of the wheel's surface, whose test functions are the
traces of the wheel's. The virtual work of the rail needs the traces of its test functions at the mapped points, on
another mesh and at other places for every pose: forms of dolfinx 0.5 to 0.11 integrate over one mesh and its submeshes.
The operators of `wheelrail.contact.geometry.contact_operators` stand in for both traces.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix, assemble_vector, create_matrix
from mpi4py import MPI
from petsc4py import PETSc
from scipy.spatial import cKDTree

from wheelrail.contact.geometry.surface_grid import RULES, ContactGrid
from wheelrail.contact.laws.friction import parameters
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.forms import compat
from wheelrail.forms.compilation import compiled
from wheelrail.forms.pointwise import with_parameters
from wheelrail.forms.traction import frictionless_traction, traction, virtual_work
from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.support.arrays import Array, Nodes

Law = TypeVar("Law")

# Corners of the reference faces, and their areas
REFERENCE: dict[int, tuple[list[list[float]], float]] = {
    3: ([[0, 0], [1, 0], [0, 1]], 0.5),
    4: ([[0, 0], [1, 0], [0, 1], [1, 1]], 1.0),
}


class SurfaceLaw:
    """Nodal forces T_i = a_i t(z_i) N and tangent D = dT/dz on the contact grid; z = (d, s1, s2), or (d) without
    friction.

    Parameters:
        solid: mesh of the body.
        grid: contact grid on it.
        degree: of the displacements, 1 or 2.
        laws: of the interface.
        gained: slip added by multipliers at sliding points.

    Parameters of the laws are constants of the forms, which are compiled once for all their values. Between calls,
    `regularisation` sets the regularising creepage, `at_speed` the rolling speed.
    """

    def __init__(self, solid: Solid, grid: ContactGrid, degree: int, laws: ContactLaws, *, gained: float = 0.0) -> None:
        cell = "triangle" if solid.cell == "tetrahedron" else "quadrilateral"
        used, faces = np.unique(solid.faces, return_inverse=True)
        mesh = compat.mesh_from_arrays(MPI.COMM_SELF, cell, faces.reshape(solid.faces.shape), solid.points[used])
        self.laws = laws
        self.components = 3 if laws.frictional else 1
        space = compat.space(mesh, degree, self.components)
        self.z = fem.Function(space)

        def constant(value: float) -> Any:
            return fem.Constant(mesh, PETSc.ScalarType(value))

        def in_form(law: Law) -> Law:
            return with_parameters(law, {name: constant(value) for name, value in parameters(law).items()})

        self._eps, self._speed = constant(laws.regularisation), constant(0.0)
        # quadrature points are the nodes with weights: exact for the shape functions, and the law is nodal
        corners, area = REFERENCE[solid.faces.shape[1]]
        rule = RULES[solid.faces.shape[1], degree]
        measure = ufl.Measure(
            "dx",
            domain=mesh,
            metadata={
                "quadrature_rule": "custom",
                "quadrature_degree": degree,
                "quadrature_points": rule.corners @ np.array(corners, dtype=float),
                "quadrature_weights": area * rule.weights,
            },
        )
        if self.components == 3:
            normal, friction = in_form(laws.normal), in_form(laws.friction)
            t = traction(self.z, normal, friction, speed=self._speed, ε=self._eps, gained=gained)
        else:
            t = frictionless_traction(self.z, in_form(laws.normal))
        work = virtual_work(t, ufl.TestFunction(space), measure)
        with compat.quiet():
            self._force, self._tangent = compiled(work), compiled(ufl.derivative(work, self.z))
        self._vector, self._matrix = compat.create_vector(self._force), create_matrix(self._tangent)
        compat.freed_with(self, self._vector, self._matrix)
        distance, node = cKDTree(space.tabulate_dof_coordinates()).query(grid.position.reshape(-1, 3))
        if distance.max() > 1e-6 * np.linalg.norm(grid.position[1, 0] - grid.position[0, 0]):
            raise RuntimeError("points of the contact grid must be nodes of the surface mesh")
        self._node = node

    @property
    def regularisation(self) -> float:
        return float(self._eps.value)

    @regularisation.setter
    def regularisation(self, value: float) -> None:
        self._eps.value = value

    def at_speed(self, speed: float) -> None:
        """Set the rolling speed m/s."""
        self._speed.value = speed

    def _set(self, nodes: Nodes, z: Array) -> None:
        values = self.z.x.array.reshape(-1, self.components)
        values[:] = 0.0
        values[:, 0] = -1.0  # far apart
        values[self._node[nodes]] = z

    def force(self, nodes: Nodes, z: Array) -> Array:
        """T (n, c) N at grid nodes (n,) from z (n, c)."""
        self._set(nodes, z)
        with self._vector.localForm() as local:
            local.set(0.0)
        assemble_vector(self._vector, self._force)
        return np.asarray(self._vector.array.reshape(-1, self.components)[self._node[nodes]])

    def tangent(self, nodes: Nodes, z: Array) -> Array:
        """dT/dz (n, c, c) at grid nodes (n,) from z (n, c): diagonal blocks only, as the law is pointwise."""
        self._set(nodes, z)
        self._matrix.zeroEntries()
        assemble_matrix(self._matrix, self._tangent)
        self._matrix.assemble()
        c = self.components
        rows = self._node[nodes]
        return _diagonal_blocks(self._matrix, rows, c)


def _diagonal_blocks(matrix: Any, nodes: Nodes, c: int) -> Array:
    """Blocks (n, c, c) on the diagonal of a sparse PETSc matrix."""
    import scipy.sparse as sp

    pointer, columns, data = matrix.getValuesCSR()
    csr = sp.csr_matrix((data, columns, pointer), shape=matrix.getSize())
    offset = np.arange(c)
    row = np.repeat(c * nodes[:, None] + offset, c, axis=1)
    column = np.tile(c * nodes[:, None] + offset, (1, c))
    return np.asarray(csr[row.ravel(), column.ravel()]).reshape(len(nodes), c, c)
