"""Rails, wheels and blocks as waveguides: compliance by wavenumbers, contact grid and strip, from the disk cache."""

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
from wheelrail.meshes.bodies.solids import HALF_PATCH, Strip, body_key, rail_touches, section, wheel_touches
from wheelrail.meshes.bodies.triangulation import Grading, SectionMesh, triangulate
from wheelrail.support.arrays import Array
from wheelrail.support.cache import cached, digest

log = logging.getLogger(__name__)

# Largest wavenumber times the shortest of spacing and step: the spectrum of a cell has its second zero there, and what
# lies beyond is 1e-3 of a cell's own compliance and next to nothing between cells.
REACH = 4 * np.pi
# Of the interpolation between wavenumbers, see `ComplianceSpectrum`; what that really costs is a tenth to a hundredth
# of it, less than the meshes do.
TOLERANCE = 3e-3
# Quadratic triangles bend the rail's web right and grow fast; linear ones of twice the cost are 4 % off there. The
# largest costs a load over 8 mm 6e-4 of its own compliance at worst (laterally on the rail, two triangles across its
# web of 16.5 mm), whatever the surface size; 12 mm 1.8e-3, 16 mm 3.3e-3, 32 mm 8e-3. The growth costs 1e-3.
GRADING = Grading(first=1.0, growth=0.4, largest=8e-3)
# m along the rail, twice what meshed strips have: an endless rail bends and rolls and a whole wheel bends, so that
# undeformed surfaces overlap by 0.3 mm at 21 degrees (75 kN on the flange root) where patches end 9 mm away. 0.5 mm at
# 65 degrees reach 33 mm. What lies beyond a patch costs a solve next to nothing.
HALF_GRID = 0.040

if TYPE_CHECKING:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection

Ends = tuple[float, float]
Parts = tuple[WaveguideCompliance, ContactGrid, Strip]


def rail_waveguide(
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
    """Endless rail on its clamped foot: compliance, grid and strip between two arc lengths of its profile [m].

    size [m] between contact points along the profile; step [m] along the rail (None: the size); the grid reaches
    half_length [m] to either side.
    """
    strip = Strip.over(outline, ends or rail_touches(outline.profile), half_length=half_length, size=size)
    return _profiled("rail", outline, strip, None, steel, step or size, half_length, degree, grading, tolerance)


def wheel_waveguide(
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
    """The whole wheel, lengths along its rim counted on the rolling circle; see `rail_waveguide`."""
    strip = Strip.over(outline, ends or wheel_touches(outline.profile), half_length=half_length, size=size)
    radius = outline.offset[1]
    return _profiled("wheel", outline, strip, radius, steel, step or size, half_length, degree, grading, tolerance)


def rail_body(
    outline: Outline,
    steel: Material,
    *,
    size: float,
    ends: Ends | None = None,
    degree: int = 2,
    grading: Grading = GRADING,
) -> WaveguideSection:
    """The section behind `rail_waveguide`, same lines on its surface, for stresses inside."""
    return _body(outline, ends or rail_touches(outline.profile), None, steel, size, degree, grading)


def wheel_body(
    outline: Outline,
    steel: Material,
    *,
    size: float,
    ends: Ends | None = None,
    degree: int = 2,
    grading: Grading = GRADING,
) -> WaveguideSection:
    """The section behind `wheel_waveguide`, same lines on its surface, for stresses inside."""
    return _body(outline, ends or wheel_touches(outline.profile), outline.offset[1], steel, size, degree, grading)


def block_body(
    half_cells: int, steel: Material, *, size: float, half_width: float, degree: int = 2, grading: Grading = GRADING
) -> WaveguideSection:
    """The section behind `block_waveguide` with 2 half_cells cells across, for stresses inside; half_width in sizes."""
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx

    surface, rest, clamped = block_section(half_cells, 1.0, half_width, half_width)
    mesh = triangulate(surface, rest, clamped, size=1.0, grading=replace(grading, largest=half_width / 4))
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
    """Endless block below z = 0, clamped at its bottom, with a grid of 2 half_cells (along x, along y) cells.

    step and size [m] are their lengths along x and y (None: the size).
    half_width [sizes] is also its depth. One spectrum serves all sizes and moduli.
    """
    scaled = replace(grading, largest=half_width / 4)
    surface, rest, clamped = block_section(half_cells[1], 1.0, half_width, half_width)

    def mesh() -> SectionMesh:
        return triangulate(surface, rest, clamped, size=1.0, grading=scaled)

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


def _body(
    outline: Outline, ends: Ends, radius: float | None, steel: Material, size: float, degree: int, grading: Grading
) -> WaveguideSection:
    from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx

    strip = Strip.over(outline, ends, half_length=HALF_PATCH, size=size)
    return WaveguideSection(section(outline, strip, grading=grading), steel, degree=degree, radius=radius)


def _profiled(
    kind: str,
    outline: Outline,
    strip: Strip,
    radius: float | None,
    steel: Material,
    step: float,
    half_length: float,
    degree: int,
    grading: Grading,
    tolerance: float,
) -> Parts:
    rows = 2 * int(np.ceil(half_length / step)) + 1
    grid = invariant_grid(outline.surface(strip.arc), rows, step, radius=radius)

    def mesh() -> SectionMesh:
        return section(outline, strip, grading=grading)

    spectrum = _spectrum(
        mesh,
        body_key(f"{kind} section", outline, replace(strip, half_cells=0), 0.0, "tetrahedron", grading),
        nu=steel.nu,
        finest=_finest(strip.size, step),
        extent=float(np.ptp(outline.polygon(1e-2), axis=0).max()),
        radius=radius,
        degree=degree,
        tolerance=tolerance,
    )
    return WaveguideCompliance(spectrum, grid.shape, step, radius=radius, scale=1 / steel.E), grid, strip


def _finest(spacing: float, step: float) -> float:
    """The spacing halved until it is no longer than the step, m: steps of many lengths share a spectrum."""
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
    """Fetches the spectrum of a section of unit modulus from the cache, or samples it.

    finest [m] is the shortest step along x that it serves, extent [m] the size of the section.
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
    around = None if radius is None else 2 * np.pi * radius

    def arrays() -> dict[str, Array]:
        from wheelrail.contact.elasticity.waveguide.section import WaveguideSection  # imports dolfinx

        body = WaveguideSection(mesh(), Material(1.0, nu), degree=degree, radius=radius)
        shape = "body of revolution" if radius else "prismatic body"
        log.info("compliance of a %s by wavenumbers: %d unknowns in its section", shape, 3 * len(body.points))
        found = sample(
            body.flexibility,
            shift=shift,
            largest=REACH / finest,
            step=finest,
            tolerance=tolerance,
            around=around,
        )
        return {"k": found.k, "values": found.values, "error": np.array(found.error)}

    def fetch() -> ComplianceSpectrum:
        found = cached(f"spectrum/{name}", arrays, ("k", "values", "error"))
        return ComplianceSpectrum(found["k"], shift, found["values"], float(found["error"]), around)

    return fetch
