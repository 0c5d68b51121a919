"""3D view of one contact: deformed bodies, pressure on the rail, stress on cut planes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from wheelrail.scenes.views.body_meshes import (
    DISPLACEMENT,
    MISES,
    PRESSURE,
    bodies_mesh,
    deformed,
    displaced_with,
    patch_pressure,
    pressure_surface,
    stress_cut,
)
from wheelrail.scenes.views.plotter import plotter as new_plotter
from wheelrail.support.arrays import Array

if TYPE_CHECKING:
    from wheelrail.contact.results.result import ContactResult
    from wheelrail.contact.stress.fields import BodyFields


SHOWN = 6.0  # mm, drawn length of the largest displacement with the default scale
SEPARATION = 70.0  # mm, distance of the bodies in the left pane
UPPER_HEIGHT = 110.0  # mm above the patch, upper end of the upper body there
CUT_SEPARATION = 0.8  # half patch lengths, distance of the cuts in the right pane
REACH = 2.6  # half patch lengths, extent of the cuts
ANGLE = 30.0  # degrees, view angle of the camera
# Half the height of a view, and how far its middle lies below that of the bodies, over the diagonal of all that is
# drawn. Labels have sizes in pixels: in views 800 pixels wide those of the axes stay above the colour bar.
DISTANCE, BELOW = 0.86, 0.15


@dataclass(frozen=True)
class DrawnBody:
    """Fields of one body for its drawing.

    Parameters:
        name: of the body.
        upper: whether it is the upper body.
        whole: fields of the whole body, for the deformed shape.
        cuts: fields on cut planes, for the stress.
    """

    name: str
    upper: bool
    whole: BodyFields
    cuts: tuple[BodyFields, ...]


def contact_scene(
    result: ContactResult,
    bodies: tuple[DrawnBody, ...],
    *,
    title: str,
    scale: float | None = None,
    mirrored: bool = False,
    off_screen: bool | None = None,
    peak: float | None = None,
) -> Any:
    """PyVista plotter with two panes: deformed bodies and pressure; von Mises stress on cuts through the patch.

    Parameters:
        result: of the contact.
        bodies: fields of one or both bodies, already mirrored for a right-hand pair.
        title: of the view.
        scale: displacement magnification factor; a round number by default.
        mirrored: whether to mirror the patch, for a right-hand pair.
        off_screen: whether to render without a window.
        peak: upper end of the pressure's colours, MPa; the largest pressure by default.

    For `.show()` (also in a notebook) or `save_view`. Raises ValueError without contact.
    """
    patch = pressure_surface(result, mirrored=mirrored)
    middle = np.average(np.asarray(patch.cell_centers().points), axis=0, weights=patch[PRESSURE])
    half = 0.5 * max(patch.bounds[1] - patch.bounds[0], patch.bounds[3] - patch.bounds[2])
    view = new_plotter((1, 2), size=(1600, 900), off_screen=off_screen)
    meshes = [(body, bodies_mesh(body.whole)) for body in bodies]
    largest = max(float(mesh[DISPLACEMENT].max()) for _, mesh in meshes)
    scale = round_scale(SHOWN / (1e-3 * largest)) if scale is None else scale
    peak = float(patch[PRESSURE].max()) if peak is None else peak
    _left(view, meshes, patch, (middle, scale, largest, peak))
    view.title = (
        f"{title}\nleft: bodies separated, displacements magnified x {scale:g};"
        f" pressure up to {peak:.0f} MPa (yellow)\n"
        "right: von Mises stress on longitudinal and lateral cuts below the patch"
    )
    view.add_text(
        f"{title}\ndisplacements magnified x {scale:g}, bodies separated\npressure up to {peak:.0f} MPa (yellow)",
        font_size=10,
        color="black",
    )
    view.subplot(0, 1)
    _right(view, bodies, patch, (middle, half, peak))
    view.add_text(
        "von Mises stress below the patch\non longitudinal and lateral cuts, bodies separated",
        font_size=10,
        color="black",
    )
    view.subplot(0, 0)
    return view


def round_scale(value: float) -> float:
    """The largest of 1, 2, 5, 10, 20, ... that does not exceed a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step * power for step in (1, 2, 5) if step * power <= value * (1 + 1e-12)))


def _left(
    view: Any, meshes: list[tuple[DrawnBody, Any]], patch: Any, drawing: tuple[Array, float, float, float]
) -> None:
    """Deformed bodies; drawing: middle of the patch mm, magnification, largest displacement µm and pressure MPa."""
    middle, scale, largest, peak = drawing
    lower = None
    for number, (body, mesh) in enumerate(meshes):
        offset_z = SEPARATION if body.upper and len(meshes) > 1 else 0.0
        deformed(
            view, mesh, scale=scale, offset_z=offset_z, top=middle[2] + UPPER_HEIGHT, largest=largest, bar=number == 0
        )
        if lower is None or not body.upper:
            lower = mesh
    patch_pressure(view, displaced_with(patch, lower, scale), peak=peak)
    _frame(view, direction=np.array([1.0, -0.9, 0.42]))


def _right(view: Any, bodies: tuple[DrawnBody, ...], patch: Any, drawing: tuple[Array, float, float]) -> None:
    """Cuts; drawing: middle of the patch and half its length mm, largest pressure MPa."""
    middle, half, peak = drawing
    gap, reach = CUT_SEPARATION * half, REACH * half
    cuts = [(body, bodies_mesh(cut)) for body in bodies for cut in body.cuts]
    largest = max(float(mesh[MISES].max()) for _, mesh in cuts)
    for number, (body, mesh) in enumerate(cuts):
        offset_z = gap if body.upper and len(bodies) > 1 else 0.0
        stress_cut(view, mesh, around=middle, reach=reach, largest=largest, offset_z=offset_z, bar=number == 0)
    patch_pressure(view, patch, peak=peak)
    _frame(view, direction=np.array([1.0, -1.15, 0.5]))


def _frame(view: Any, direction: Array) -> None:
    """Axes in mm, and a camera position that shows everything above the colour bars."""
    view.add_axes(color="black", line_width=3, viewport=(0.0, 0.13, 0.16, 0.29))
    axes = view.show_bounds(
        bounds=view.bounds,  # fixed ones, with which labels do not change
        xtitle="x, forward [mm]",
        ytitle="y, left [mm]",
        ztitle="z, up [mm]",
        font_size=9,
        color="#404040",
        location="outer",
        n_xlabels=4,
        n_ylabels=4,
        n_zlabels=4,
        fmt="%.0f",
    )
    axes.GetAxisLabels(1).SetValue(0, " ")  # of y, at the corner where the last label of x is
    bounds = np.array(view.bounds).reshape(3, 2)
    centre, size = bounds.mean(axis=1), float(np.linalg.norm(np.ptp(bounds, axis=1)))
    distance = DISTANCE * size / np.tan(np.radians(0.5 * ANGLE))
    view.camera.view_angle = ANGLE
    focus = centre - [0.0, 0.0, BELOW * size]
    view.camera_position = [focus + distance * direction / np.linalg.norm(direction), focus, (0, 0, 1)]
