"""Rails, wheels and blocks as waveguides: compliance by wavenumbers (cached on disk), contact grid and strip."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from wheelrail.contact.elasticity.waveguide.compliance import WaveguideCompliance
from wheelrail.contact.elasticity.waveguide.spectrum import ComplianceSpectrum, sample
from wheelrail.contact.geometry.surface_grid import ContactGrid, invariant_grid
from wheelrail.contact.laws.material import Material
from wheelrail.meshes.bodies.extrusion import block_section
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.solids import HALF_PATCH, Strip, body_key, section
from wheelrail.meshes.bodies.triangulation import Grading, SectionMesh, triangulate
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached, digest

log = logging.getLogger(__name__)

# Largest wavenumber times the shorter of spacing and step: the second zero of a cell's spectrum. Larger wavenumbers
# contribute 1e-3 of a cell's diagonal compliance, and a negligible part between cells.
REACH = 4 * np.pi
# Of the interpolation between wavenumbers, see `ComplianceSpectrum`; the actual error is a tenth to a hundredth of it,
# smaller than that of the meshes.
TOLERANCE = 3e-3
# Quadratic triangles represent bending of the rail's web and may grow fast; linear ones at twice the cost have an error
# of 4 % there. The largest size causes an error of the compliance of a load over 8 mm of at most 6e-4 (laterally on the
# rail, two triangles across its web of 16.5 mm) at any surface size; 12 mm 1.8e-3, 16 mm 3.3e-3, 32 mm 8e-3. The growth
# causes 1e-3.
GRADING = Grading(first=1.0, growth=0.4, largest=8e-3)
# m along the rail, twice that of meshed strips: an endless rail bends and rolls and a whole wheel bends, so that the
# undeformed penetration is 0.3 mm at 21 degrees (75 kN on the flange root), with patches that end 9 mm away. 0.5 mm at
# 65 degrees reach 33 mm. Points outside the patch add little to the cost of a solve.
HALF_GRID = 0.040

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection

Ends = tuple[float, float]
Parts = tuple[WaveguideCompliance, ContactGrid, Strip]


def profile_waveguide(
    outline: Outline,
    steel: Material,
    *,
    size: float,
    step: float | None = None,
    half_length: float = HALF_GRID,
    ends: Ends | None = None,
    degree: int = 2,
    grading: Grading = GRADING,
    tolerance: float = TOLERANCE,
) -> Parts:
    """Endless rail clamped at its foot, or whole wheel clamped at its bore: compliance, contact grid and strip.

    Parameters:
        outline: of the section.
        steel: material.
        size: m, between contact points along the profile.
        step: m, between contact points along the rail, or along the rim on the rolling circle; None: the size.
        half_length: m, of the grid to either side.
        ends: m, arc lengths on the profile between which the grid lies; None: the part that contacts.
        degree: of the displacements, 1 or 2.
        grading: of the mesh.
        tolerance: of the interpolation between wavenumbers.
    """
    strip, radius, step = Strip.on(outline, ends=ends, half_length=half_length, size=size), outline.radius, step or size
    rows = 2 * int(np.ceil(half_length / step)) + 1
    grid = invariant_grid(outline.surface(strip.arc), rows, step, radius=radius)

    def mesh() -> SectionMesh:
        return section(outline, strip, grading=grading)

    kind = f"{outline.profile.kind} section"
    spectrum = _spectrum(
        mesh,
        body_key(kind, outline, replace(strip, half_cells=0), 0.0, "tetrahedron", grading),
        nu=steel.nu,
        finest=_finest(strip.size, step),
        extent=float(np.ptp(outline.polygon(1e-2), axis=0).max()),
        radius=radius,
        degree=degree,
        tolerance=tolerance,
    )
    return WaveguideCompliance(spectrum, grid.shape, step, radius=radius, scale=1 / steel.E), grid, strip


def profile_body(
    outline: Outline,
    steel: Material,
    *,
    size: float,
    ends: Ends | None = None,
    degree: int = 2,
    grading: Grading = GRADING,
) -> WaveguideSection:
    """Section of `profile_waveguide`, same lines on its surface, for internal stresses; parameters as there."""
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx

    strip = Strip.on(outline, ends=ends, half_length=HALF_PATCH, size=size)
    return WaveguideSection(section(outline, strip, grading=grading), steel, degree=degree, radius=outline.radius)


def block_body(
    half_cells: int, steel: Material, *, size: float, half_width: float, degree: int = 2, grading: Grading = GRADING
) -> WaveguideSection:
    """Section of `block_waveguide`, for internal stresses.

    Parameters:
        half_cells: half the number of cells across.
        steel: material.
        size: m, of the cells.
        half_width: of the block, in sizes.
        degree: of the displacements, 1 or 2.
        grading: of the mesh.
    """
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx

    surface, boundary, clamped = block_section(half_cells, 1.0, half_width, half_width)
    mesh = triangulate(surface, boundary, clamped, size=1.0, grading=replace(grading, largest=half_width / 4))
    return WaveguideSection(replace(mesh, points=mesh.points * size), steel, degree=degree)


def block_waveguide(
    half_cells: tuple[int, int],
    steel: Material,
    *,
    size: float,
    step: float | None = None,
    half_width: float,
    degree: int = 2,
    grading: Grading = GRADING,
    tolerance: float = TOLERANCE,
) -> tuple[WaveguideCompliance, ContactGrid]:
    """Endless block below z = 0, clamped at its bottom: compliance and contact grid.

    Parameters:
        half_cells: half the number of cells along x and along y.
        steel: material.
        size: m, length of the cells along y.
        step: m, length of the cells along x; None: the size.
        half_width: of the block, also its depth, in sizes.
        degree: of the displacements, 1 or 2.
        grading: of the mesh.
        tolerance: of the interpolation between wavenumbers.

    One spectrum serves all sizes and moduli.
    """
    scaled = replace(grading, largest=half_width / 4)
    surface, boundary, clamped = block_section(half_cells[1], 1.0, half_width, half_width)

    def mesh() -> SectionMesh:
        return triangulate(surface, boundary, clamped, size=1.0, grading=scaled)

    key = digest(kind="block section", cells=half_cells[1], width=half_width, grading=vars(scaled))
    along = (step or size) / size
    grid = invariant_grid(surface, 2 * half_cells[0] + 1, along)
    compliance = WaveguideCompliance(
        _spectrum(
            mesh,
            key,
            nu=steel.nu,
            finest=_finest(1.0, along),
            extent=half_width,
            radius=None,
            degree=degree,
            tolerance=tolerance,
        ),
        grid.shape,
        along,
        scale=1 / (steel.E * size),
    )
    return compliance, ContactGrid(grid.position * size, grid.weight * size**2, grid.stride)


def _finest(spacing: float, step: float) -> float:
    """Spacing m, halved until at most the step m, so that steps of many lengths share a spectrum."""
    return float(spacing * 2.0 ** min(0.0, np.floor(np.log2(step / spacing) + 1e-9)))


def _spectrum(
    mesh: Callable[[], SectionMesh],
    key: str,
    *,
    nu: float,
    finest: float,
    extent: float,
    radius: float | None,
    degree: int,
    tolerance: float,
) -> Callable[[], ComplianceSpectrum]:
    """Function that returns the spectrum of a section of unit modulus, from the cache or by sampling.

    finest [m] is the shortest step along x, extent [m] the size of the section.
    """
    name = digest(
        section=key,
        rule="whole harmonics",
        nu=nu,
        finest=finest,
        radius=radius,
        degree=degree,
        tolerance=tolerance,
        reach=REACH,
    )
    shift = 1 / extent
    circumference = None if radius is None else 2 * np.pi * radius

    def arrays() -> dict[str, Array]:
        from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx

        body = WaveguideSection(mesh(), Material(1.0, nu), degree=degree, radius=radius)
        shape = "body of revolution" if radius else "prismatic body"
        log.info("compliance of a %s by wavenumbers: %d unknowns in its section", shape, 3 * len(body.points))
        spectrum = sample(
            body.flexibility,
            shift=shift,
            largest=REACH / finest,
            step=finest,
            tolerance=tolerance,
            around=circumference,
        )
        return {"k": spectrum.k, "values": spectrum.values, "error": np.array(spectrum.error)}

    def fetch() -> ComplianceSpectrum:
        stored = cached(f"spectrum/{name}", arrays, ("k", "values", "error"))
        return ComplianceSpectrum(stored["k"], shift, stored["values"], float(stored["error"]), circumference)

    return fetch
