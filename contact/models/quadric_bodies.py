"""Discretisations of two quadratic surfaces on large blocks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.contact.elasticity.compliance import Compliance
from wheelrail.contact.elasticity.solid_compliance import SurfaceCompliance, distributed_body, solid_compliance
from wheelrail.contact.elasticity.waveguide.bodies import block_waveguide
from wheelrail.contact.elasticity.waveguide.compliance import WaveguideCompliance
from wheelrail.contact.elasticity.waveguide.influence import ElementInfluence, HalfSpaceInfluence
from wheelrail.contact.geometry.quadric_pair import QuadricPair, curvature
from wheelrail.contact.geometry.strip_surfaces import QuadricStrips
from wheelrail.contact.geometry.surface_grid import ContactGrid
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.influence.strip_operators import StripOperators
from wheelrail.contact.models.surface_memory import check_surface
from wheelrail.meshes.bodies.extrusion import Solid
from wheelrail.meshes.bodies.solids import FINE, RATIO, block
from wheelrail.meshes.bodies.triangulation import Grading

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.solid_body import ElasticBody

ROOM = 1.25  # times the expected approach: largest approach on the meshed surface
WIDTH = 40.0  # least half width of a block over the longer semi-axis of the patch, and over a cell


@dataclass(frozen=True)
class Blocks:
    """Size of two equal blocks, and their meshes.

    Parameters:
        half_width: also their depth, m; None: 40 to 80 times the longer semi-axis, such that one mesh serves many
            scenes.
        half_strip: half length and half width of the uniformly meshed surface, m; None: for the expected approach.
        growth: of the element size of solids per distance from the surface. A mesh converges only if it decreases in
            proportion to the surface size.
    """

    half_width: float | None = None
    half_strip: float | None = None
    growth: float = FINE.growth

    @property
    def grading(self) -> Grading:
        """Of the element sizes in the cross-section."""
        return Grading(FINE.first, self.growth)

    @property
    def ratio(self) -> float:
        """Of successive layers along x outside the strip."""
        return 1.0 + (RATIO - 1.0) * self.growth / FINE.growth


@dataclass(frozen=True)
class QuadricBodies:
    """Upper and lower body on equal blocks.

    Parameters:
        radii: principal radii in x and y of the upper and of the lower body, m.
        materials: of the upper and of the lower body.
        laws: of the interface.
        load: N, or approach: m, for which the meshed surface is large enough.
        blocks: size and grading of the meshes.
    """

    radii: tuple[tuple[float, float], tuple[float, float]]
    materials: tuple[Material, Material]
    laws: ContactLaws
    load: float | None = None
    approach: float | None = None
    blocks: Blocks = Blocks()

    @cached_property
    def _curvatures(self) -> tuple[float, float]:
        """Coefficients A and B of the gap, 1/m."""
        A, B = curvature(self.radii[0]) + curvature(self.radii[1])
        return float(A), float(B)

    @cached_property
    def _expected(self) -> tuple[float, tuple[float, float]]:
        """Largest approach m on the meshed surface, and the semi-axes m, by Hertz."""
        upper, lower = self.materials
        E_star = modulus((upper.E, upper.nu), (lower.E, lower.nu))
        exact = hertz(*self._curvatures, E_star, force=self.load, approach=self.approach)
        return ROOM * (exact.approach + self.laws.penetration_at(exact.peak)), exact.semi_axes

    def _half_cells(self, how: Discretisation) -> tuple[int, int]:
        """Cells of the surface on either side of the middle, along and across."""
        if self.blocks.half_strip is not None:
            cells = int(np.ceil(self.blocks.half_strip / how.surface_size)) + 1
            half = [cells, cells]
        else:
            depth, _ = self._expected
            half = [int(np.ceil(np.sqrt(depth / c) / how.surface_size)) + 1 for c in self._curvatures]
            half[0] += how.slip_order if self.laws.frictional else 0
        check_surface("each body", 2 * half[0] + 1, 2 * half[1] + 1, how)
        return half[0], half[1]

    @cached_property
    def _surfaces(self) -> QuadricStrips:
        """Surfaces in contact, as wide as the penetration at the largest approach."""
        depth, semi_axes = self._expected
        half_width = self.blocks.half_strip
        if half_width is None:
            half_width = float(np.sqrt(depth / self._curvatures[1]))
        return QuadricStrips(*self.radii, half_width, semi_axes)

    def _half_width(self, how: Discretisation) -> float:
        """In cells; by default in coarse steps, so that one mesh and one compliance serve many scenes."""
        if self.blocks.half_width is not None:
            return self.blocks.half_width / how.surface_size
        return float(2.0 ** np.ceil(np.log2(WIDTH * max(*self._expected[1], how.surface_size) / how.surface_size)))

    def _equal_or_not(self, make: Callable[[Material], Any]) -> tuple[Any, Any]:
        """Values made from the material of each body, once for equal materials."""
        upper, lower = self.materials
        above = make(upper)
        return above, above if lower == upper else make(lower)

    def half_space_strips(self, how: Discretisation) -> StripOperators:
        across = self._half_cells(how)[1]
        lines = np.arange(-across, across + 1, dtype=np.float64) * how.surface_size
        flat = np.column_stack([lines, np.zeros_like(lines)])
        halves = self._equal_or_not(lambda material: HalfSpaceInfluence.under(flat, lines, material))
        return StripOperators(self._surfaces, *halves)

    def waveguide_strips(self, how: Discretisation) -> StripOperators:
        def influence(material: Material) -> ElementInfluence:
            body, grid = self._waveguide(how, material)
            lines = grid.position[0, :, 1:]
            return ElementInfluence.of_waveguide(
                body, lines, lines[:, 0].copy(), material, how.degree, unit=how.surface_size
            )

        return StripOperators(self._surfaces, *self._equal_or_not(influence))

    def waveguide_grids(self, how: Discretisation) -> tuple[QuadricPair, Compliance, Compliance]:
        (above, grid), (below, _) = self._equal_or_not(lambda material: self._waveguide(how, material))
        return QuadricPair(grid, *self.radii), above, below

    def _waveguide(self, how: Discretisation, material: Material) -> tuple[WaveguideCompliance, ContactGrid]:
        half_cells, half_width = self._half_cells(how), self._half_width(how)
        return block_waveguide(half_cells, material, size=how.surface_size, half_width=half_width, degree=how.degree)

    def solid_grids(self, how: Discretisation) -> tuple[QuadricPair, Compliance, Compliance]:
        surfaces, solid, key = self._solid(how, lambda build: build())

        def compliance(material: Material) -> SurfaceCompliance:
            scale = 1 / (material.E * how.surface_size)
            return solid_compliance(solid, key, Material(1.0, material.nu), how.degree, scale=scale)

        return surfaces, *self._equal_or_not(compliance)

    def solid_bodies(self, how: Discretisation) -> tuple[QuadricPair, ElasticBody, ElasticBody]:
        from wheelrail.support.mpi import world

        surfaces, solid, _ = self._solid(how, world().broadcast)
        scaled = partial(np.multiply, how.surface_size)
        above, below = (distributed_body(solid.mapped(scaled), material, how.degree) for material in self.materials)
        return surfaces, above, below

    def _solid(self, how: Discretisation, run: Callable[[Callable[[], Any]], Any]) -> tuple[QuadricPair, Solid, str]:
        """Surfaces, and the block of unit cells with its key in the cache; run calls the mesh generation."""
        half_cells, half_width = self._half_cells(how), self._half_width(how)
        grading, ratio = self.blocks.grading, self.blocks.ratio
        solid, key = run(partial(block, half_cells, half_width=half_width, cell=how.cell, grading=grading, ratio=ratio))
        grid = ContactGrid.on(solid, how.degree)
        size = how.surface_size
        scaled = ContactGrid(grid.position * size, grid.weight * size**2, grid.stride)
        return QuadricPair(scaled, *self.radii), solid, key
