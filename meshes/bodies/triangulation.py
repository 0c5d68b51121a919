"""Graded 2D meshes of a body's cross-section with gmsh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array, Mask, Nodes


@dataclass(frozen=True)
class Grading:
    """Element size [m] at a distance d [m] from the contact surface: min(largest, first * size + growth * d)."""

    first: float = 0.7
    growth: float = 0.25
    largest: float = 30e-3


@dataclass(frozen=True)
class SectionMesh:
    """Mesh of a cross-section: points (n, 2) m, cells (m, 3) or (m, 4), surface (k,) nodes of the contact surface in
    order, clamped (n,) mask of the fixed nodes.
    """

    points: Array
    cells: Nodes
    surface: Nodes
    clamped: Mask


def triangulate(
    surface: Array,
    rest: Array,
    clamped: Mask,
    *,
    size: float,
    grading: Grading,
    quadrilaterals: bool = False,
) -> SectionMesh:
    """Mesh the polygon surface (k, 2) + rest (m, 2) m, keeping every point of the surface as a node.

    clamped (m + 1,) marks the polygon's edges that are fixed: from the last surface point along rest back to the first.
    Quadrilaterals come from halving a mesh of twice the size, so they need an odd number of surface points.
    """
    import gmsh  # heavy, and not needed when the mesh is cached

    if quadrilaterals and len(surface) % 2 == 0:
        raise ValueError(
            f"a surface of {len(surface)} points has an odd number of cells and cannot carry quadrilaterals"
        )
    stride = 2 if quadrilaterals else 1
    corners = np.vstack([surface[::stride], rest])
    n, last = len(corners), (len(surface) - 1) // stride
    scale = 1.0 / (size * stride)  # gmsh's tolerances are absolute
    started = not gmsh.isInitialized()
    if started:
        gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add("section")
        geo, field = gmsh.model.geo, gmsh.model.mesh.field
        points = [geo.addPoint(x, y, 0.0) for x, y in corners * scale]
        lines = [geo.addLine(points[i], points[(i + 1) % n]) for i in range(n)]
        face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
        geo.synchronize()
        for line in lines[:last]:
            gmsh.model.mesh.setTransfiniteCurve(line, 2)
        fixed = [line for line, is_fixed in zip(lines[last:], clamped, strict=True) if is_fixed]
        gmsh.model.addPhysicalGroup(1, lines[:last], name="contact")
        gmsh.model.addPhysicalGroup(1, fixed, name="clamped")
        gmsh.model.addPhysicalGroup(2, [face], name="body")
        distance = field.add("Distance")
        field.setNumbers(distance, "CurvesList", lines[:last])
        field.setNumber(distance, "Sampling", 3)
        target = field.add("MathEval")
        field.setString(target, "F", f"Min({grading.largest * scale},{grading.first}+{grading.growth}*F{distance})")
        field.setAsBackgroundMesh(target)
        for source in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
            gmsh.option.setNumber("Mesh." + source, 0)
        gmsh.option.setNumber("Mesh.Algorithm", 8 if quadrilaterals else 6)
        gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 1)
        gmsh.option.setNumber("Mesh.RecombineAll", int(quadrilaterals))
        gmsh.option.setNumber("Mesh.SubdivisionAlgorithm", int(quadrilaterals))
        gmsh.model.mesh.generate(2)
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
        on_surface = [gmsh.model.mesh.getNodes(0, p)[0][0] for p in points[: last + 1]]
        if quadrilaterals:
            middles = [gmsh.model.mesh.getNodes(1, line)[0][0] for line in lines[:last]]
            on_surface = [node for pair in zip(on_surface, middles, strict=False) for node in pair] + on_surface[-1:]
        surface_nodes = index[np.array(on_surface, dtype=np.int64)]
        gmsh.model.remove()
    finally:
        if started:
            gmsh.finalize()
    return _compact(xy, cells, surface_nodes, is_clamped, surface)


def _compact(xy: Array, cells: Nodes, surface_nodes: Nodes, is_clamped: Mask, surface: Array) -> SectionMesh:
    """Number the surface nodes first, in order, and put them exactly where they were asked for."""
    used = np.unique(cells)
    order = np.concatenate([surface_nodes, np.setdiff1d(used, surface_nodes)])
    new = np.full(len(xy), -1, dtype=np.int64)
    new[order] = np.arange(len(order))
    points = xy[order].copy()
    points[: len(surface)] = surface
    return SectionMesh(points, new[cells], np.arange(len(surface)), is_clamped[order])
