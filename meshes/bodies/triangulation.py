"""Graded 2D meshes of a body's cross-section with gmsh."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from wheelrail.support.arrays import Array, Mask, Nodes


@dataclass(frozen=True)
class Grading:
    """Element size m at a distance d m from the contact surface: min(largest, first * size + growth * d)."""

    first: float = 0.7
    growth: float = 0.25
    largest: float = 30e-3


@dataclass(frozen=True)
class SectionMesh:
    """Mesh of a cross-section.

    Parameters:
        points: (n, 2) m.
        cells: (m, 3) or (m, 4).
        surface: (k,), nodes of the contact surface in order.
        clamped: (n,), mask of the fixed nodes.
    """

    points: Array
    cells: Nodes
    surface: Nodes
    clamped: Mask


def triangulate(
    surface: Array,
    boundary: Array,
    clamped: Mask,
    *,
    size: float,
    grading: Grading,
    quadrilaterals: bool = False,
) -> SectionMesh:
    """Mesh of a polygon with all points of its contact surface as nodes.

    Parameters:
        surface: (k, 2) m, points of the contact surface.
        boundary: (m, 2) m, remaining corners.
        clamped: (m + 1,), fixed edges of the polygon, from the last surface point along boundary back to the first.
        size: element size on the surface, m.
        grading: of the element sizes.
        quadrilaterals: instead of triangles, by refinement of a mesh of twice the size: k must be odd.
    """
    if quadrilaterals and len(surface) % 2 == 0:
        raise ValueError(f"quadrilaterals need an odd number of surface points, got {len(surface)}")
    stride = 2 if quadrilaterals else 1
    scale = 1.0 / (size * stride)  # gmsh's tolerances are absolute
    with _gmsh_model() as gmsh:
        points, lines = _polygon(gmsh, np.vstack([surface[::stride], boundary]) * scale)
        last = (len(surface) - 1) // stride
        contact = lines[:last]
        fixed = [line for line, is_fixed in zip(lines[last:], clamped, strict=True) if is_fixed]
        for line in contact:
            gmsh.model.mesh.setTransfiniteCurve(line, 2)
        _set_sizes(gmsh, contact, grading, scale)
        _generate(gmsh, quadrilaterals)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        xy = coordinates.reshape(-1, 3)[:, :2] / scale
        index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        index[tags.astype(np.int64)] = np.arange(len(tags))
        kind, corner_count = (3, 4) if quadrilaterals else (2, 3)
        cells = index[gmsh.model.mesh.getElementsByType(kind)[1].astype(np.int64)].reshape(-1, corner_count)
        is_clamped = np.zeros(len(xy), dtype=bool)
        for line in fixed:
            nodes = gmsh.model.mesh.getNodes(1, line, includeBoundary=True)[0]
            is_clamped[index[nodes.astype(np.int64)]] = True
        surface_nodes = index[_along_surface(gmsh, points[: last + 1], contact, quadrilaterals)]
    return _compact(xy, cells, surface_nodes, is_clamped, surface)


def triangulate_parts(
    parts: tuple[Array, ...], surface: int, *, size: float, grading: Grading
) -> tuple[SectionMesh, Nodes]:
    """Mesh of polygons that are joined along common edges, and the part (m,) of every cell.

    Parameters:
        parts: corners (k, 2) m of each; an edge is common if both its corners are corners of both polygons.
        surface: number of first corners of the first part that form the contact surface, with no nodes between them.
        size: element size on the surface, m.
        grading: of the element sizes.
    """
    scale = 1.0 / size  # gmsh's tolerances are absolute
    with _gmsh_model() as gmsh:
        faces, points, lines = _joined_polygons(gmsh, [part * scale for part in parts])
        for line in lines[: surface - 1]:
            gmsh.model.mesh.setTransfiniteCurve(line, 2)
        _set_sizes(gmsh, lines[: surface - 1], grading, scale)
        _generate(gmsh, quadrilaterals=False)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
        index[tags.astype(np.int64)] = np.arange(len(tags))
        cells = [index[gmsh.model.mesh.getElementsByType(2, face)[1].astype(np.int64)].reshape(-1, 3) for face in faces]
        surface_nodes = index[_along_surface(gmsh, points[:surface], lines[: surface - 1], quadrilaterals=False)]
    xy = coordinates.reshape(-1, 3)[:, :2] / scale
    part = np.repeat(np.arange(len(cells)), [len(own) for own in cells])
    free = np.zeros(len(xy), dtype=bool)
    return _compact(xy, np.concatenate(cells), surface_nodes, free, parts[0][:surface]), part


def part_of(mesh: SectionMesh, cells: Mask) -> SectionMesh:
    """Mesh of some cells (m,) of a mesh, including all cells at its contact surface."""
    used = np.unique(mesh.cells[cells])
    new = np.full(len(mesh.points), -1, dtype=np.int64)
    new[used] = np.arange(len(used))
    return SectionMesh(mesh.points[used], new[mesh.cells[cells]], new[mesh.surface], mesh.clamped[used])


@contextmanager
def _gmsh_model() -> Iterator[Any]:
    """gmsh with a model of its own, silent and on one thread."""
    import gmsh  # heavy, and not needed when the mesh is cached

    started = not gmsh.isInitialized()
    if started:
        gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add("section")
        yield gmsh
        gmsh.model.remove()
    finally:
        if started:
            gmsh.finalize()


def _polygon(gmsh: Any, corners: Array) -> tuple[list[int], list[int]]:
    """Polygonal face with corners (n, 2): its points, and its lines from each of them to the next."""
    geo, n = gmsh.model.geo, len(corners)
    points = [geo.addPoint(x, y, 0.0) for x, y in corners]
    lines = [geo.addLine(points[i], points[(i + 1) % n]) for i in range(n)]
    geo.addPlaneSurface([geo.addCurveLoop(lines)])
    geo.synchronize()
    return points, lines


def _joined_polygons(gmsh: Any, polygons: list[Array]) -> tuple[list[int], list[int], list[int]]:
    """Faces with given corners; points and lines of the first, in its order. Common corners and edges exist once."""
    geo = gmsh.model.geo
    points: dict[tuple[float, float], int] = {}
    lines: dict[tuple[int, int], int] = {}
    faces, outlines = [], []
    for polygon in polygons:
        corners = []
        for x, y in polygon:
            key = (round(float(x), 7), round(float(y), 7))
            if key not in points:
                points[key] = geo.addPoint(x, y, 0.0)
            corners.append(points[key])
        edges = []
        for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
            if (b, a) in lines:
                edges.append(-lines[b, a])
                continue
            if (a, b) not in lines:
                lines[a, b] = geo.addLine(a, b)
            edges.append(lines[a, b])
        faces.append(geo.addPlaneSurface([geo.addCurveLoop(edges)]))
        outlines.append((corners, edges))
    geo.synchronize()
    return faces, *outlines[0]


def _set_sizes(gmsh: Any, contact: list[int], grading: Grading, scale: float) -> None:
    """Element sizes by their distance from the lines of the contact surface."""
    field = gmsh.model.mesh.field
    distance = field.add("Distance")
    field.setNumbers(distance, "CurvesList", contact)
    field.setNumber(distance, "Sampling", 3)
    target = field.add("MathEval")
    field.setString(target, "F", f"Min({grading.largest * scale},{grading.first}+{grading.growth}*F{distance})")
    field.setAsBackgroundMesh(target)
    for source in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
        gmsh.option.setNumber("Mesh." + source, 0)


def _generate(gmsh: Any, quadrilaterals: bool) -> None:
    gmsh.option.setNumber("Mesh.Algorithm", 8 if quadrilaterals else 6)
    gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 1)
    gmsh.option.setNumber("Mesh.RecombineAll", int(quadrilaterals))
    gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", int(quadrilaterals))
    gmsh.model.mesh.generate(2)


def _along_surface(gmsh: Any, points: list[int], lines: list[int], quadrilaterals: bool) -> Nodes:
    """Tags of the nodes on the contact surface, in order: at its points and, between quadrilaterals, on its lines."""
    nodes = [gmsh.model.mesh.getNodes(0, p)[0][0] for p in points]
    if quadrilaterals:
        middles = [gmsh.model.mesh.getNodes(1, line)[0][0] for line in lines]
        nodes = [node for pair in zip(nodes, middles, strict=False) for node in pair] + nodes[-1:]
    return np.array(nodes, dtype=np.int64)


def _compact(xy: Array, cells: Nodes, surface_nodes: Nodes, is_clamped: Mask, surface: Array) -> SectionMesh:
    """Mesh with the surface nodes numbered first, in order, at their exact positions."""
    used = np.unique(cells)
    order = np.concatenate([surface_nodes, np.setdiff1d(used, surface_nodes)])
    new = np.full(len(xy), -1, dtype=np.int64)
    new[order] = np.arange(len(order))
    points = xy[order].copy()
    points[: len(surface)] = surface
    return SectionMesh(points, new[cells], np.arange(len(surface)), is_clamped[order])
