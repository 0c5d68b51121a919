"""Meshes of the bodies of a scene, from the disk cache or made with gmsh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meshes.cache import cached, digest
from meshes.solids import Cell, Solid, block_section, bulged, extruded, layers
from meshes.triangulate import Array, Grading, triangulate

FINE = Grading(first=0.5, growth=0.2)


def stored(key: str, build: Callable[[], Solid]) -> Solid:
    """A solid under its key in the mesh cache."""
    arrays = cached(f"mesh/{key}", lambda: (lambda s: {name: getattr(s, name) for name in ("points", "cells", "grid", "faces", "clamped")})(build()))
    return Solid(**{name: arrays[name] for name in ("points", "cells", "grid", "faces", "clamped")})


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

    half_width [m] is also its depth and half length. Finite radii [m] in x and y bulge its top: sphere, ellipsoid, cylinder.
    Raises ValueError when the strip does not fit.
    """
    if max(half_cells) * size >= half_width:
        raise ValueError(f"a strip of {half_cells} cells of {size} m does not fit on a block of half width {half_width} m")
    scaled = Grading(grading.first, grading.growth, half_width / 4)
    hexahedra = cell == "hexahedron"
    across = half_cells[1] + half_cells[1] % 2 if hexahedra else half_cells[1]
    key = digest(kind="block", cells=(half_cells[0], across), size=size, width=half_width, radii=[str(r) for r in radii], cell=cell, grading=vars(scaled))

    def build() -> Solid:
        surface, rest, clamped = block_section(across, size, half_width, half_width)
        section = triangulate(surface, rest, clamped, size=size, grading=scaled, quadrilaterals=hexahedra)
        x = layers(half_cells[0], size, half_width, largest=half_width / 4)
        return extruded(section, x, half_cells[0]).mapped(bulged(radii, half_width))

    return stored(key, build), key


__all__ = ["Array", "block"]
