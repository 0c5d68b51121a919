"""Meshes of the bodies of a scene, from the disk cache or made with gmsh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from wheelrail.meshes.bodies.extrusion import Cell, Solid, block_section, bulged, extruded, layers, revolved
from wheelrail.meshes.bodies.outlines import Outline
from wheelrail.meshes.bodies.triangulation import Grading, SectionMesh, triangulate
from wheelrail.meshes.profiles.profile import Profile
from wheelrail.support.arrays import Array
from wheelrail.support.cache import Arrays, cached, digest

FINE = Grading(first=0.5, growth=0.2)


def stored(key: str, build: Callable[[], Solid]) -> Solid:
    """A solid under its key in the mesh cache."""
    names = [field.name for field in fields(Solid)]

    def arrays() -> Arrays:
        solid = build()
        return {name: getattr(solid, name) for name in names}

    found = cached(f"mesh/{key}", arrays, names)
    return Solid(**{name: found[name] for name in names})


def block(
    half_cells: tuple[int, int],
    *,
    size: float = 1.0,
    half_width: float,
    radii: tuple[float, float] = (np.inf, np.inf),
    cell: Cell = "tetrahedron",
    grading: Grading = FINE,
) -> tuple[Solid, str]:
    """Block below z = 0 with a strip of 2 half_cells (along x, along y) cells, clamped at its bottom; and its key.

    half_width [m] is also its depth and half length. Finite radii [m] in x and y bulge its top: sphere, ellipsoid,
    cylinder. Raises ValueError when the strip does not fit.
    """
    if max(half_cells) * size >= half_width:
        raise ValueError(
            f"a strip of {half_cells} cells of {size} m does not fit on a block of half width {half_width} m"
        )
    scaled = Grading(grading.first, grading.growth, half_width / 4)
    hexahedra = cell == "hexahedron"
    across = half_cells[1] + half_cells[1] % 2 if hexahedra else half_cells[1]
    key = digest(
        kind="block",
        cells=(half_cells[0], across),
        size=size,
        width=half_width,
        radii=[str(r) for r in radii],
        cell=cell,
        grading=vars(scaled),
    )

    def build() -> Solid:
        surface, rest, clamped = block_section(across, size, half_width, half_width)
        section = triangulate(surface, rest, clamped, size=size, grading=scaled, quadrilaterals=hexahedra)
        x = layers(half_cells[0], size, half_width, largest=half_width / 4)
        return extruded(section, x, half_cells[0]).mapped(bulged(radii, half_width))

    return stored(key, build), key


@dataclass(frozen=True)
class Strip:
    """Where a body's contact surface is meshed uniformly: arc length start + j size (j = 0 .. cells) of the profile,
    m, and half_cells cells of that size to either side along the rolling direction.
    """

    start: float
    cells: int
    half_cells: int
    size: float

    @property
    def arc(self) -> Array:
        """Arc length of the nodes (cells + 1,), m."""
        return np.asarray(self.start + np.arange(self.cells + 1) * self.size)

    @classmethod
    def over(cls, outline: Outline, ends: tuple[float, float], *, half_length: float, size: float) -> Strip:
        """Strip over the part of a running surface between two arc lengths of the profile, m.

        Its even number of cells suits tetrahedra and hexahedra alike.
        """
        low, high = outline.surface_range
        start, stop = max(ends[0], low + size), min(ends[1], high - size)
        return cls(start, 2 * int((stop - start) / size / 2), int(np.ceil(half_length / size)), size)


def rail_touches(profile: Profile) -> tuple[float, float]:
    """Arc lengths of a rail between which a wheel may touch: 18 mm down the gauge face to 5 mm down the field side."""
    s = profile.samples(1e-4)
    z = profile.point(s)[:, 1]
    gauge, field = s[(s < 0) & (z > -18e-3)], s[(s > 0) & (z > -5e-3)]
    return float(gauge.min()), float(field.max())


def wheel_touches(profile: Profile) -> tuple[float, float]:
    """Arc lengths of a wheel between which a rail may touch: high on the flange to the field side of the tread."""
    s = profile.samples(1e-4)
    y, z = profile.point(s).T
    tip = y[np.argmax(z)]
    part = s[(y > tip + 7e-3) & (y < 36e-3)]
    return float(part.min()), float(part.max())


# m along the rail: overlaps d deep at a contact angle g reach sqrt(2 R d / cos g), 11 mm on the tread at 150 kN and
# 18 mm on a flange of 65 degrees at 0.15 mm
HALF_PATCH = 0.020


def rail(
    outline: Outline, *, size: float, half_length: float = 0.5, cell: Cell = "tetrahedron", grading: Grading = FINE
) -> tuple[Solid, Strip, str]:
    """Rail section extruded along x, clamped under its foot; its strip and its key."""
    strip = Strip.over(outline, rail_touches(outline.profile), half_length=HALF_PATCH, size=size)
    key = body_key("rail", outline, strip, half_length, cell, grading)
    return stored(key, lambda: _extruded(outline, strip, half_length, cell, grading)), strip, key


def wheel(
    outline: Outline, *, size: float, half_length: float = 0.15, cell: Cell = "tetrahedron", grading: Grading = FINE
) -> tuple[Solid, Strip, str]:
    """Wheel rim revolved over a sector of +-half_length m on the tread, clamped inside the rim; its strip and its key.

    In the wheel's frame: the axle along y through the origin, the sector's middle straight below.
    """
    strip = Strip.over(outline, wheel_touches(outline.profile), half_length=HALF_PATCH, size=size)
    key = body_key("wheel", outline, strip, half_length, cell, grading)
    radius = outline.offset[1]
    return (
        stored(key, lambda: _extruded(outline, strip, half_length, cell, grading).mapped(revolved(radius))),
        strip,
        key,
    )


def body_key(kind: str, outline: Outline, strip: Strip, half_length: float, cell: Cell, grading: Grading) -> str:
    """Hash of everything that shapes the mesh of a wheel or rail."""
    return digest(
        kind=kind,
        profile=outline.profile.digest(),
        rest=outline.rest,
        range=outline.surface_range,
        clamped=outline.clamped,
        offset=outline.offset,
        strip=vars(strip),
        length=half_length,
        cell=cell,
        grading=vars(grading),
    )


def section(outline: Outline, strip: Strip, *, grading: Grading = FINE, quadrilaterals: bool = False) -> SectionMesh:
    """Cross-section with the strip's nodes on the profile; the rest of the surface gets coarser away from it."""
    low, high = outline.surface_range
    beyond = _coarser(strip.arc[-1], high, strip.size)
    before = _coarser(strip.arc[0], low, strip.size)
    rest = np.concatenate([outline.surface(beyond), outline.rest[1:-1], outline.surface(before[::-1])])
    edges = np.zeros(len(rest) + 1, dtype=bool)
    first, last = (len(beyond) - 1 + index for index in outline.clamped)
    edges[first + 1 : last + 1] = True  # edge e ends at point e of the rest
    return triangulate(
        outline.surface(strip.arc), rest, edges, size=strip.size, grading=grading, quadrilaterals=quadrilaterals
    )


def _coarser(start: float, end: float, size: float) -> Array:
    """Positions from beyond start to end, steps growing by 1.3."""
    steps, total, length = [], 0.0, abs(end - start)
    step = size
    while total < length - 1e-9:
        steps.append(step)
        total += step
        step *= 1.3
    if not steps:
        return np.array([end])
    return np.asarray(start + np.sign(end - start) * np.cumsum(steps) * (length / total))


def _extruded(outline: Outline, strip: Strip, half_length: float, cell: Cell, grading: Grading) -> Solid:
    mesh = section(outline, strip, grading=grading, quadrilaterals=cell == "hexahedron")
    x = layers(strip.half_cells, strip.size, half_length, largest=2 * grading.largest)
    return extruded(mesh, x, strip.half_cells)
