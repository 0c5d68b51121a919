"""Rails, wheels and blocks as waveguides: compliance by wavenumbers, contact grid and strip, from the disk cache."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from contact.grid import ContactGrid
from contact.laws import Steel
from contact.pose import Array
from contact.spectrum import Spectrum, sample
from contact.waveguide import WaveguideCompliance
from meshes.bodies import FINE, HALF_PATCH, Strip, body_key, rail_touches, section, wheel_touches
from meshes.cache import cached, digest
from meshes.sections import Outline
from meshes.solids import block_section
from meshes.triangulate import Grading, SectionMesh, triangulate

REACH = 8 * np.pi  # largest wavenumber, over the surface size: what lies beyond is 1e-3 of a cell's own compliance
TOLERANCE = 1e-3  # of the interpolation between wavenumbers, see `Spectrum`

Ends = tuple[float, float]
Progress = Callable[[int, int], None]
Parts = tuple[WaveguideCompliance, ContactGrid, Strip]


def rail_waveguide(
    outline: Outline,
    steel: Steel,
    *,
    size: float,
    step: float | None = None,
    half_length: float = HALF_PATCH,
    ends: Ends | None = None,
    degree: int = 1,
    grading: Grading = FINE,
    tolerance: float = TOLERANCE,
    progress: Progress | None = None,
) -> Parts:
    """Endless rail on its clamped foot: compliance, grid and strip between two arc lengths of its profile [m].

    size [m] of the cells along the profile; step [m] along the rail (None: the size); the grid reaches half_length [m]
    to either side.
    """
    strip = Strip.over(outline, ends or rail_touches(outline.profile), half_length=half_length, size=size)
    return _profiled(
        "rail", outline, strip, None, steel, step or size, half_length, degree, grading, tolerance, progress
    )


def wheel_waveguide(
    outline: Outline,
    steel: Steel,
    *,
    size: float,
    step: float | None = None,
    half_length: float = HALF_PATCH,
    ends: Ends | None = None,
    degree: int = 1,
    grading: Grading = FINE,
    tolerance: float = TOLERANCE,
    progress: Progress | None = None,
) -> Parts:
    """The whole wheel, lengths along its rim counted on the rolling circle; see `rail_waveguide`.

    Harmonics n = k radius are taken as continuous, which leaves out the way once round the wheel.
    """
    strip = Strip.over(outline, ends or wheel_touches(outline.profile), half_length=half_length, size=size)
    radius = outline.offset[1]
    return _profiled(
        "wheel", outline, strip, radius, steel, step or size, half_length, degree, grading, tolerance, progress
    )


def block_waveguide(
    half_cells: tuple[int, int],
    steel: Steel,
    *,
    size: float,
    step: float | None = None,
    half_width: float,
    degree: int = 1,
    grading: Grading = FINE,
    tolerance: float = TOLERANCE,
    progress: Progress | None = None,
) -> tuple[WaveguideCompliance, ContactGrid]:
    """Endless block below z = 0, clamped at its bottom, with a strip of 2 half_cells (along x, along y) cells.

    half_width [sizes] is also its depth. One spectrum serves all sizes and moduli.
    """
    scaled = replace(grading, largest=half_width / 4)
    surface, rest, clamped = block_section(half_cells[1], 1.0, half_width, half_width)

    def mesh() -> SectionMesh:
        return triangulate(surface, rest, clamped, size=1.0, grading=scaled)

    key = digest(kind="block section", cells=half_cells[1], width=half_width, grading=vars(scaled))
    along = (step or size) / size
    grid = invariant_grid(surface, 2 * half_cells[0] + 1, along, degree=degree)
    compliance = WaveguideCompliance(
        _spectrum(mesh, key, steel.nu, 1.0, half_width, None, degree, tolerance, progress),
        grid.shape,
        along,
        scale=1 / (steel.E * size),
    )
    return compliance, ContactGrid(grid.position * size, grid.weight * size**2, grid.stride)


def invariant_grid(
    corners: Array, rows: int, step: float, *, degree: int = 1, radius: float | None = None
) -> ContactGrid:
    """Contact grid of cells of the length step [m] along x (on the circle of the radius [m] about y, or straight) and
    of the nodes between the corners (m, 2) m of the surface, weighted by the integral of their shape functions.
    """
    x = (np.arange(rows) - rows // 2) * step
    length = np.hypot(*np.diff(corners, axis=0).T)
    stretch = np.ones(len(corners)) if radius is None else corners[:, 1] / radius
    # Lagrange shape functions times a linear stretch, from one end of an edge to the other
    if degree == 1:
        rule = np.array([[2, 1], [1, 2]]) / 6
        places = np.arange(len(length))[:, None] + [0, 1]
        points = corners
    else:
        rule = np.array([[1, 0], [2, 2], [0, 1]]) / 6
        places = 2 * np.arange(len(length))[:, None] + [0, 1, 2]
        points = np.empty((2 * len(corners) - 1, 2))
        points[::2], points[1::2] = corners, 0.5 * (corners[1:] + corners[:-1])
    ends = np.stack([stretch[:-1], stretch[1:]], axis=1)
    tributary = np.bincount(places.ravel(), (length[:, None] * (ends @ rule.T)).ravel(), len(points))
    position = np.empty((rows, len(points), 3))
    position[..., 1] = points[:, 0]
    if radius is None:
        position[..., 0], position[..., 2] = x[:, None], points[:, 1]
    else:
        position[..., 0] = np.sin(x / radius)[:, None] * points[:, 1]
        position[..., 2] = -np.cos(x / radius)[:, None] * points[:, 1]
    return ContactGrid(position, np.broadcast_to(step * tributary, (rows, len(points))), 1)


def _profiled(
    kind: str,
    outline: Outline,
    strip: Strip,
    radius: float | None,
    steel: Steel,
    step: float,
    half_length: float,
    degree: int,
    grading: Grading,
    tolerance: float,
    progress: Progress | None,
) -> Parts:
    rows = 2 * int(np.ceil(half_length / step)) + 1
    grid = invariant_grid(outline.surface(strip.arc), rows, step, degree=degree, radius=radius)
    key = body_key(f"{kind} section", outline, replace(strip, half_cells=0), 0.0, "tetrahedron", grading)
    extent = float(np.ptp(outline.polygon(1e-2), axis=0).max())

    def mesh() -> SectionMesh:
        return section(outline, strip, grading=grading)

    spectrum = _spectrum(mesh, key, steel.nu, strip.size, extent, radius, degree, tolerance, progress)
    return WaveguideCompliance(spectrum, grid.shape, step, radius=radius, scale=1 / steel.E), grid, strip


def _spectrum(
    mesh: Callable[[], SectionMesh],
    key: str,
    nu: float,
    size: float,
    extent: float,
    radius: float | None,
    degree: int,
    tolerance: float,
    progress: Progress | None,
) -> Callable[[], Spectrum]:
    """Fetches the spectrum of a section of unit modulus from the cache, or samples it; extent [m] of the section."""
    key = digest(section=key, nu=nu, degree=degree, tolerance=tolerance, reach=REACH, radius=radius)
    shift = 1 / extent

    def arrays() -> dict[str, Array]:
        from contact.section import Section  # imports dolfinx

        body = Section(mesh(), Steel(1.0, nu), degree=degree, radius=radius)
        found = sample(
            body.flexibility, shift=shift, largest=REACH / size, step=size, tolerance=tolerance, progress=progress
        )
        return {"k": found.k, "values": found.values, "error": np.array(found.error)}

    def fetch() -> Spectrum:
        found = cached(f"spectrum/{key}", arrays, ("k", "values", "error"))
        return Spectrum(found["k"], shift, found["values"], float(found["error"]))

    return fetch
