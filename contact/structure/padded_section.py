"""Rail section on a continuous elastic support: the pads as a Robin condition on the underside of the foot."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp
import ufl
from dolfinx import fem
from dolfinx import mesh as dmesh
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from wheelrail.contact.elasticity.waveguide.section import WaveguideSection
from wheelrail.contact.laws.material import Material
from wheelrail.contact.structure.rigid_section import section_modes
from wheelrail.forms import compat
from wheelrail.forms.compilation import compiled
from wheelrail.forms.elasticity import lame
from wheelrail.forms.waveguide import wavenumber_forms
from wheelrail.meshes.bodies.triangulation import SectionMesh
from wheelrail.support.arrays import Array, Nodes


class PaddedSection(WaveguideSection):
    """Prismatic section whose clamped boundary, a straight line, is elastically supported instead.

    Parameters:
        mesh: of the section.
        steel: material.
        stiffness: of the support along x, along the line and normal to it, N/m2 per length of the body.
        degree: of the displacements.

    The support is spread evenly over the line; its roll stiffness is that of the normal one.
    """

    def __init__(
        self, mesh: SectionMesh, steel: Material, stiffness: tuple[float, float, float], *, degree: int = 2
    ) -> None:
        super().__init__(mesh, steel, degree=degree)
        self.stiffness_per_length = stiffness

    @cached_property
    def fixed(self) -> Nodes:
        return np.zeros(0, dtype=np.int64)

    @property
    def foot(self) -> Array:
        """Ends (2, 2) m of the supported line, from the gauge side to the field side."""
        line = self.section.points[self.section.clamped]
        return line[[np.argmin(line[:, 0]), np.argmax(line[:, 0])]]

    @cached_property
    def matrices(self) -> tuple[Nodes, Nodes, tuple[Array, Array, Array]]:
        U, V = ufl.TrialFunction(self.space), ufl.TestFunction(self.space)
        A0, A1, A2 = wavenumber_forms(U, V, *lame(self.steel.E, self.steel.nu), degree=self.degree)
        A0 += self._support_form(U, V)
        (pointer, columns, values), (_, _, slope), (_, _, curvature) = (
            compat.assemble_csr(compiled(form)) for form in (A0, A1, A2)
        )
        return pointer.astype(np.int64), columns.astype(np.int64), (values, slope, curvature)

    @property
    def support(self) -> sp.csr_array:
        """Stiffness (3 n, 3 n) N/m2 of the support alone."""
        form = self._support_form(ufl.TrialFunction(self.space), ufl.TestFunction(self.space))
        pointer, columns, values = compat.assemble_csr(compiled(form))
        return sp.csr_array((values, columns, pointer), shape=(3 * len(self.points),) * 2)

    @cached_property
    def mass(self) -> sp.csr_array:
        """Integrals (3 n, 3 n) m2 of products of shape functions over the section."""
        form = ufl.inner(ufl.TrialFunction(self.space), ufl.TestFunction(self.space)) * ufl.dx
        pointer, columns, values = compat.assemble_csr(compiled(form))
        return sp.csr_array((values, columns, pointer), shape=(3 * len(self.points),) * 2)

    def foot_modes(self, degree: int) -> tuple[Array, Array]:
        """Motions (3 n, m) of the foot, polynomials over its width along x, across and normal; parity (m,) in the
        wavenumber.
        """
        first, last = self.foot
        width = float(np.hypot(*(last - first)))
        t = (last - first) / width
        axes = np.array([[1.0, 0.0, 0.0], [0.0, *t], [0.0, -t[1], t[0]]])
        place = 2.0 * (self.points - first) @ t / width - 1.0
        powers = place[:, None] ** np.arange(degree + 1)
        modes = np.einsum("np,ai->niap", powers, axes).reshape(3 * len(place), -1)
        return modes, np.repeat([-1.0, 1.0, 1.0], degree + 1)

    def section_fit(self) -> Array:
        """Rigid motion (3, 2 m), y, z and roll about the middle of the foot, by y and z of m lines of the surface."""
        surface = self.section.points[self.section.surface]
        return np.linalg.pinv(section_modes(surface - self.foot.mean(axis=0)).reshape(-1, 3))

    def section_loads(self) -> Array:
        """Nodal loads (3 n, 3) on the running surface with unit resultants conjugate to `section_fit`."""
        lines = self.cells[np.arange(self.cells.shape[0]).reshape(-1, 3)[:, 1:].ravel()]
        loads = np.zeros((3 * len(self.points), 3))
        loads[(3 * self.surface[:, None] + np.arange(3)).ravel()] = lines.T @ self.section_fit().T
        return loads

    def solve(self, k: float, loads: Array) -> Array:
        """Displacement amplitudes (3 n, m) by nodal loads (3 n, m) at a wavenumber 1/m."""
        pointer, columns, _ = self.matrices
        stiffness = sp.csr_array((self.stiffness(k), columns, pointer), shape=(len(loads), len(loads)))
        factors = splu(sp.csc_matrix(stiffness), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        return np.asarray(factors.solve(loads))

    def _support_form(self, U: ufl.Argument, V: ufl.Argument) -> ufl.Form:
        first, last = self.foot
        width = float(np.hypot(*(last - first)))
        t = np.array([0.0, *(last - first) / width])
        axes = np.array([[1.0, 0.0, 0.0], t, [0.0, -t[2], t[1]]])
        per_area = axes.T @ np.diag(self.stiffness_per_length) @ axes / width
        return ufl.inner(fem.Constant(self.mesh, per_area) * U, V) * self._supported(1)

    @property
    def _supported(self) -> ufl.Measure:
        """Measure of the supported edges, which have the index 1."""
        corners, clamped = cKDTree(self.section.points), self.section.clamped
        facets = dmesh.locate_entities_boundary(self.mesh, 1, lambda x: clamped[corners.query(x[:2].T)[1]])
        tags = dmesh.meshtags(self.mesh, 1, np.sort(facets), np.ones(len(facets), dtype=np.int32))
        return ufl.Measure("ds", domain=self.mesh, subdomain_data=tags)
