"""One contact in three dimensions: both bodies deformed, pressure on the rail, stress on cuts below the surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from scenes.pictures.bodies import (
    MISES,
    MOVED,
    bodies_mesh,
    deformed,
    patch_pressure,
    pressure_surface,
    riding,
    stress_cut,
)
from scenes.pictures.off_screen import plotter as new_plotter

if TYPE_CHECKING:
    from contact.body_fields import BodyFields
    from contact.result import ContactResult

SHOWN = 6.0  # mm that the largest displacement is drawn as when no scale is given
LIFT = 45.0  # mm between the bodies in the left pane
APART = 0.6  # half patch lengths between their cuts in the right pane
REACH = 3.5  # half patch lengths that the cuts are shown to


@dataclass(frozen=True)
class SeenBody:
    """Fields of one body: whole for the deformed picture, cuts for the stress; upper one or lower one."""

    name: str
    upper: bool
    whole: BodyFields
    cuts: tuple[BodyFields, ...]


def contact_scene(
    result: ContactResult,
    bodies: tuple[SeenBody, ...],
    *,
    title: str,
    scale: float | None = None,
    mirrored: bool = False,
    off_screen: bool | None = None,
) -> Any:
    """A pyvista plotter with two panes: bodies deformed and pressure; von Mises stress on cuts through the patch.

    scale of displacements, a round one without it; mirrored for a right-hand pair, whose fields must be mirrored
    already. Show it (`.show()`, also in a notebook), or write it with `save_view`. Raises ValueError without contact.
    """
    patch = pressure_surface(result, mirrored=mirrored)
    middle = np.average(np.asarray(patch.cell_centers().points), axis=0, weights=patch["pressure [MPa]"])
    half = 0.5 * max(patch.bounds[1] - patch.bounds[0], patch.bounds[3] - patch.bounds[2])
    view = new_plotter((1, 2), size=(1600, 900), off_screen=off_screen)
    meshes = [(body, bodies_mesh(body.whole)) for body in bodies]
    largest = max(float(mesh[MOVED].max()) for _, mesh in meshes)
    scale = round_scale(SHOWN / (1e-3 * largest)) if scale is None else scale
    _left(view, meshes, patch, scale, largest)
    view.add_text(f"{title}\nbodies moved apart, displacements x {scale:g}", font_size=10, color="black")
    view.subplot(0, 1)
    _right(view, bodies, patch, middle, half)
    view.add_text("von Mises stress below the patch\ncuts along and across, bodies apart", font_size=10, color="black")
    view.subplot(0, 0)
    return view


def round_scale(value: float) -> float:
    """The largest of 1, 2, 5, 10, 20 .. not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(step * power for step in (1, 2, 5) if step * power <= value * (1 + 1e-12)))


def _left(view: Any, meshes: list[tuple[SeenBody, Any]], patch: Any, scale: float, largest: float) -> None:
    lower = None
    for number, (body, mesh) in enumerate(meshes):
        lift = LIFT if body.upper and len(meshes) > 1 else 0.0
        deformed(view, mesh, scale=scale, lift=lift, largest=largest, bar=number == 0)
        if lower is None or not body.upper:
            lower = mesh
    patch_pressure(view, riding(patch, lower, scale))
    _frame(view)
    bounds = np.array(view.bounds).reshape(3, 2)
    reach = float(np.ptp(bounds, axis=1).max())
    centre = bounds.mean(axis=1) - [0.0, 0.0, 0.04 * reach]
    view.camera_position = [centre + reach * np.array([1.1, -1.15, 0.55]), centre, (0, 0, 1)]
    view.camera.zoom(1.15)


def _right(view: Any, bodies: tuple[SeenBody, ...], patch: Any, middle: Any, half: float) -> None:
    gap, reach = APART * half, REACH * half
    cuts = [(body, bodies_mesh(cut)) for body in bodies for cut in body.cuts]
    largest = max(float(mesh[MISES].max()) for _, mesh in cuts)
    for number, (body, mesh) in enumerate(cuts):
        lift = gap if body.upper and len(bodies) > 1 else 0.0
        stress_cut(view, mesh, around=middle, reach=reach, largest=largest, lift=lift, bar=number == 0)
    patch_pressure(view, patch)
    _frame(view)
    view.camera_position = [middle + reach * np.array([2.2, -2.6, 1.1]), middle - [0, 0, 0.25 * reach], (0, 0, 1)]


def _frame(view: Any) -> None:
    view.add_axes(color="black", line_width=3)
    view.show_bounds(
        xtitle="x, forward [mm]",
        ytitle="y, to the left [mm]",
        ztitle="z, up [mm]",
        font_size=9,
        color="#404040",
        location="outer",
        n_xlabels=4,
        n_ylabels=4,
        n_zlabels=4,
        fmt="%.0f",
    )
