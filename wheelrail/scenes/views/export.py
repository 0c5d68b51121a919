"""Export of the fields of a contact for ParaView: VTK files of the bodies, of cuts and of the patches, in mm."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wheelrail.scenes.views.body_meshes import bodies_mesh, pressure_surface
from wheelrail.scenes.views.view import bodies_of, side_fields

if TYPE_CHECKING:
    from wheelrail.scenes.contacts.side_solution import SideSolution
    from wheelrail.scenes.schema.scene import HertzScene, WheelsetScene

PARTS = ("body", "lateral_cut", "longitudinal_cut")


def export_side(
    scene: HertzScene | WheelsetScene,
    side: str,
    solved: SideSolution,
    folder: Path,
) -> list[Path]:
    """Write the fields of one side: `SIDE_BODY_PART.vtu` and `SIDE_patches.vtp`; returns the files.

    Parameters:
        scene: of the contact.
        side: "left", "right" or "contact".
        solved: solution of the side.
        folder: for the files; created if missing.

    Point data of a body: displacement, mm and um, stress (nine components) and von Mises stress, MPa; they are those of
    waveguide bodies under the computed tractions, for all models. Cell data of the patches: pressure and traction on
    the wheel or upper body, MPa. Raises SceneError and RunFailed as `wheelrail.scenes.views.view.view_side`, OSError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name, _, fields in side_fields(scene, side, solved, bodies_of(scene, "both")):
        for part, field in zip(PARTS, fields, strict=True):
            files.append(folder / f"{side}_{name}_{part}.vtu")
            bodies_mesh(field).save(files[-1])
    files.append(folder / f"{side}_patches.vtp")
    pressure_surface(solved.result, mirrored=side == "right").save(files[-1])
    return files
