"""PyVista meshes of the bodies of a contact, in mm: fields, cuts, and the pressure of the patches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.plots.style import PRESSURE_MAP
from wheelrail.scenes.views.plotter import colour_bar, pyvista
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.contact.stress.fields import BodyFields


MISES, DISPLACEMENT, PRESSURE = "von Mises stress [MPa]", "displacement [µm]", "pressure [MPa]"
# Perceptually uniform and safe for colour-blind readers; pressure as in all other figures.
MAPS = {MISES: "inferno", DISPLACEMENT: "cividis_r", PRESSURE: PRESSURE_MAP}
ABOVE = 0.1  # mm, height of the drawn patch above the rail surface
STEEL = "#b8bec6"


def bodies_mesh(fields: BodyFields) -> Any:
    """Grid, mm, with point data: "displacement", mm, "stress", MPa, von Mises stress, MPa, and the magnitude of the
    displacement, µm.
    """
    pv = pyvista()
    types = {
        "triangle": pv.CellType.TRIANGLE,
        "quadrilateral": pv.CellType.QUAD,
        "wedge": pv.CellType.WEDGE,
        "tetrahedron": pv.CellType.TETRA,
        "hexahedron": pv.CellType.HEXAHEDRON,
    }
    grid = pv.UnstructuredGrid({types[fields.shape]: fields.cells}, 1e3 * fields.points)
    grid["displacement"] = 1e3 * fields.displacement
    grid["stress"] = 1e-6 * fields.stress.reshape(-1, 9)
    grid[MISES] = 1e-6 * fields.von_mises
    grid[DISPLACEMENT] = 1e6 * np.linalg.norm(fields.displacement, axis=1)
    return grid


def displaced(mesh: Any, scale: float, offset_z: float = 0.0) -> Any:
    """Copy of a mesh, displaced by its magnified displacements and translated upwards.

    Parameters:
        mesh: with "displacement", mm.
        scale: displacement magnification factor.
        offset_z: upwards, mm.
    """
    copy = mesh.copy()
    copy.points = np.asarray(mesh.points) + scale * np.asarray(mesh["displacement"]) + np.array([0.0, 0.0, offset_z])
    return copy


def deformed(
    plotter: Any,
    mesh: Any,
    *,
    scale: float,
    largest: float,
    offset_z: float = 0.0,
    top: float = np.inf,
    bar: bool = True,
) -> Any:
    """Draw the deformed surface of a body and the edges of the undeformed one.

    Parameters:
        plotter: PyVista plotter.
        mesh: of the body, see `bodies_mesh`.
        scale: displacement magnification factor.
        largest: upper end of the colour scale, µm.
        offset_z: upwards, mm.
        top: height up to which the body is drawn, mm.
        bar: whether to draw a colour bar.

    Returns the drawn mesh.
    """
    is_cut = mesh.bounds[5] > top
    clipped = mesh.clip("z", origin=(0.0, 0.0, top)) if is_cut else mesh
    drawn = displaced(clipped.extract_surface(algorithm="dataset_surface"), scale, offset_z)
    looks = {"smooth_shading": True, "split_sharp_edges": True, "ambient": 0.25}
    coloured(plotter, drawn, DISPLACEMENT, largest, bar=bar, **looks)
    surface = mesh.extract_surface(algorithm="dataset_surface")
    edges = surface.extract_feature_edges(45.0, boundary_edges=False, non_manifold_edges=False)
    edges = edges.clip("z", origin=(0.0, 0.0, top)) if is_cut else edges
    plotter.add_mesh(displaced(edges, 0.0, offset_z), color="#707070", line_width=1.0)
    return drawn


def pressure_surface(result: ContactResult, *, mirrored: bool = False) -> Any:
    """Loaded cells of all patches as quadrilaterals just above the rail; mirrored for a right-hand pair.

    Cell data: "pressure [MPa]" and "traction [MPa]" (three components, on the wheel). Raises ValueError without
    contact.
    """
    from wheelrail.contact.kinematics.frames import MIRROR

    fields = result.fields
    if fields is None or not (fields.pressure > 0).any():
        raise ValueError("the bodies are not in contact: no patch to draw")
    loaded = fields.drawn
    axes = fields.axes[loaded]
    half = 0.5 * np.stack([fields.step[loaded], fields.width[loaded]], axis=1)[..., None] * axes[:, :2]
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = 1e3 * (fields.point[loaded][:, None] + np.einsum("ks,nsc->nkc", signs, half)) - ABOVE * axes[:, None, 2]
    traction = np.einsum("ns,nsc->nc", fields.traction[loaded], axes[:, :2])
    if mirrored:
        corners, traction = corners * MIRROR, traction * MIRROR
    count = len(corners)
    faces = np.column_stack([np.full(count, 4), np.arange(4 * count).reshape(-1, 4)])
    mesh = pyvista().PolyData(corners.reshape(-1, 3), faces.ravel())
    mesh.cell_data[PRESSURE] = 1e-6 * fields.pressure[loaded]
    mesh.cell_data["traction [MPa]"] = 1e-6 * traction
    return mesh


def displaced_with(mesh: Any, body: Any, scale: float, offset_z: float = 0.0) -> Any:
    """Surface displaced with its body, by interpolation from the six nearest points.

    Parameters:
        mesh: surface, mm.
        body: mesh with "displacement", mm.
        scale: displacement magnification factor.
        offset_z: upwards, mm.
    """
    from scipy.spatial import cKDTree

    distance, nearest = cKDTree(body.points).query(mesh.points, k=6)
    weight = 1 / np.maximum(distance, 1e-6) ** 2
    weight /= weight.sum(axis=1, keepdims=True)
    copy = mesh.copy()
    copy["displacement"] = np.einsum("nk,nkc->nc", weight, np.asarray(body["displacement"])[nearest])
    return displaced(copy, scale, offset_z)


def coloured(plotter: Any, mesh: Any, name: str, largest: float, *, bar: bool, **looks: Any) -> None:
    """Draw a mesh in the colours of one of its values, on a scale from zero.

    Parameters:
        plotter: PyVista plotter.
        mesh: with the values.
        name: of the values, with their unit.
        largest: upper end of the scale.
        bar: whether to draw a colour bar.
        looks: options of `add_mesh`.
    """
    shown = {"cmap": MAPS[name], "clim": (0.0, largest), "show_scalar_bar": False}
    actor = plotter.add_mesh(mesh, scalars=name, **shown, **looks)
    if bar:
        colour_bar(plotter, actor.mapper, name)


def patch_pressure(plotter: Any, mesh: Any, *, peak: float, bar: bool = False) -> None:
    """Draw the pressure of the patch cells, on a scale up to a peak, MPa."""
    coloured(plotter, mesh, PRESSURE, peak, bar=bar, lighting=False)


def stress_cut(
    plotter: Any, mesh: Any, *, around: Array, reach: float, largest: float, offset_z: float = 0.0, bar: bool = True
) -> Any:
    """Draw a cut around the patch, coloured by von Mises stress.

    Parameters:
        plotter: PyVista plotter.
        mesh: of the cut, see `bodies_mesh`.
        around: (3,) centre, mm.
        reach: half width of the drawn box, mm.
        largest: upper end of the colour scale, MPa.
        offset_z: upwards, mm.
        bar: whether to draw a colour bar.

    Returns the drawn mesh.
    """
    box = np.ravel(np.column_stack([around - reach, around + reach]))
    drawn = displaced(mesh.clip_box(box, invert=False), 0.0, offset_z)
    coloured(plotter, drawn, MISES, largest, bar=bar, lighting=False)
    return drawn
