"""Bodies of a contact as pyvista's meshes, in mm: fields on them, cuts, and the pressure of the patches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.plots.style import PRESSURE_MAP
from wheelrail.scenes.views.plotter import pyvista
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.contact.stress.fields import BodyFields


MISES, MOVED, PRESSURE = "von Mises stress [MPa]", "displacement [µm]", "pressure [MPa]"
# Of even lightness and told apart by every kind of sight; pressure as in all other pictures.
MAPS = {MISES: "inferno", MOVED: "cividis_r", PRESSURE: PRESSURE_MAP}
ABOVE = 0.1  # mm that the patch is drawn above the rail's surface
STEEL = "#b8bec6"


def bodies_mesh(fields: BodyFields) -> Any:
    """Grid [mm] with "displacement" [mm] and "stress" [MPa] by point, and the scalars that colour it: von Mises stress
    [MPa] and the length of the displacement [µm].
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
    grid[MOVED] = 1e6 * np.linalg.norm(fields.displacement, axis=1)
    return grid


def moved(mesh: Any, scale: float, lift: float = 0.0) -> Any:
    """A mesh with its displacements so many times as large, and raised by so many mm."""
    shown = mesh.copy()
    shown.points = np.asarray(mesh.points) + scale * np.asarray(mesh["displacement"]) + np.array([0.0, 0.0, lift])
    return shown


def deformed(
    plotter: Any,
    mesh: Any,
    *,
    scale: float,
    largest: float,
    lift: float = 0.0,
    top: float = np.inf,
    bar: bool = True,
) -> Any:
    """Draw the skin of a body with its displacements scaled, coloured by them up to the largest [µm], and the edges of
    the undeformed body, up to the height top [mm]; the drawn mesh.
    """
    cut = mesh.bounds[5] > top
    below = mesh.clip("z", origin=(0.0, 0.0, top)) if cut else mesh
    shown = moved(below.extract_surface(algorithm="dataset_surface"), scale, lift)
    plotter.add_mesh(
        shown,
        scalars=MOVED,
        cmap=MAPS[MOVED],
        clim=(0.0, largest),
        smooth_shading=True,
        split_sharp_edges=True,
        ambient=0.25,
        show_scalar_bar=bar,
        scalar_bar_args=bar_style(MOVED) if bar else None,
    )
    skin = mesh.extract_surface(algorithm="dataset_surface")
    edges = skin.extract_feature_edges(45.0, boundary_edges=False, non_manifold_edges=False)
    edges = edges.clip("z", origin=(0.0, 0.0, top)) if cut else edges
    plotter.add_mesh(moved(edges, 0.0, lift), color="#707070", line_width=1.0)
    return shown


def pressure_surface(result: ContactResult, *, mirrored: bool = False) -> Any:
    """Loaded cells of all patches as quadrilaterals just above the rail, "pressure [MPa]" and "traction [MPa]" (three
    components, on the wheel) by cell; mirrored for a right-hand pair. Raises ValueError without contact.
    """
    from wheelrail.contact.kinematics.frames import MIRROR

    fields = result.fields
    if fields is None or not (fields.pressure > 0).any():
        raise ValueError("nothing touches: there is no patch to draw")
    own = fields.pressure > 0
    step, axes = fields.step[own], fields.axes[own]
    half = 0.5 * np.stack([step, fields.area[own] / step], axis=1)[..., None] * axes[:, :2]
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    corners = 1e3 * (fields.point[own][:, None] + np.einsum("ks,nsc->nkc", signs, half)) - ABOVE * axes[:, None, 2]
    traction = np.einsum("ns,nsc->nc", fields.traction[own], axes[:, :2])
    if mirrored:
        corners, traction = corners * MIRROR, traction * MIRROR
    count = len(corners)
    faces = np.column_stack([np.full(count, 4), np.arange(4 * count).reshape(-1, 4)])
    mesh = pyvista().PolyData(corners.reshape(-1, 3), faces.ravel())
    mesh.cell_data[PRESSURE] = 1e-6 * fields.pressure[own]
    mesh.cell_data["traction [MPa]"] = 1e-6 * traction
    return mesh


def riding(mesh: Any, body: Any, scale: float, lift: float = 0.0) -> Any:
    """A surface moved with the body below it: by its displacements, so many times as large, at the nearest points."""
    from scipy.spatial import cKDTree

    distance, near = cKDTree(body.points).query(mesh.points, k=6)
    weight = 1 / np.maximum(distance, 1e-6) ** 2
    weight /= weight.sum(axis=1, keepdims=True)
    shown = mesh.copy()
    shown["displacement"] = np.einsum("nk,nkc->nc", weight, np.asarray(body["displacement"])[near])
    return moved(shown, scale, lift)


def patch_pressure(plotter: Any, mesh: Any, *, bar: bool = False) -> None:
    """Draw the pressure on a surface of patch cells."""
    plotter.add_mesh(
        mesh,
        scalars=PRESSURE,
        cmap=MAPS[PRESSURE],
        clim=(0.0, float(mesh[PRESSURE].max())),
        lighting=False,
        show_scalar_bar=bar,
        scalar_bar_args=bar_style(PRESSURE) if bar else None,
    )


def stress_cut(
    plotter: Any, mesh: Any, *, around: Array, reach: float, largest: float, lift: float = 0.0, bar: bool = True
) -> Any:
    """Draw the part of a cut within reach [mm] of a place (3,) mm, coloured by von Mises stress up to the largest
    [MPa]; the drawn mesh.
    """
    box = np.ravel(np.column_stack([around - reach, around + reach]))
    part = moved(mesh.clip_box(box, invert=False), 0.0, lift)
    plotter.add_mesh(
        part,
        scalars=MISES,
        cmap=MAPS[MISES],
        clim=(0.0, largest),
        lighting=False,
        show_scalar_bar=bar,
        scalar_bar_args=bar_style(MISES) if bar else None,
    )
    return part


def bar_style(title: str) -> dict[str, Any]:
    """Where and how scalar bars stand; one to a pane, as pages have one place for them."""
    return {
        "title": title,
        "fmt": "%.0f",
        "n_labels": 4,
        "color": "black",
        "title_font_size": 15,
        "label_font_size": 13,
        "width": 0.5,
        "height": 0.07,
        "position_x": 0.25,
        "position_y": 0.03,
    }
