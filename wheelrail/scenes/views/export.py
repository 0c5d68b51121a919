"""Export of the fields of a contact for ParaView: files of the bodies, of cuts and of the patches, in mm."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, cast

from wheelrail.scenes.contacts.solve import built_model
from wheelrail.scenes.schema.scene import HertzScene
from wheelrail.scenes.views.body_meshes import bodies_mesh, pressure_surface
from wheelrail.scenes.views.view import bodies_of, side_fields

if TYPE_CHECKING:
    from wheelrail.contact.kinematics.frames import Side
    from wheelrail.contact.models.wheelset import ContactModel, WheelsetContact
    from wheelrail.scenes.contacts.side_solution import SideSolution
    from wheelrail.scenes.schema.scene import WheelsetScene

PARTS = ("body", "lateral_cut", "longitudinal_cut")


def export_side(
    scene: HertzScene | WheelsetScene,
    side: str,
    solved: SideSolution,
    folder: Path,
    model: ContactModel | WheelsetContact | None = None,
) -> list[Path]:
    """Write the fields of one side: `SIDE_BODY_PART.vtu`, `SIDE_patches.vtp`, and of solids `SIDE_BODY_solid.xdmf`.

    Parameters:
        scene: of the contact.
        side: "left", "right" or "contact".
        solved: solution of the side.
        folder: for the files; created if missing.
        model: contact model of the scene; built from it by default, which takes time for solids.

    Returns the files. Point data of a body: displacement, mm and um, stress (nine components) and von Mises stress,
    MPa: in the .vtu files those of waveguide bodies under the computed tractions, for all models; in the .xdmf files
    those of the meshed solids of the model itself. Cell data of the patches: pressure and traction on the wheel or
    upper body, MPa. Raises SceneError and RunFailed as `wheelrail.scenes.views.view.view_side`, OSError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name, _, fields in side_fields(scene, side, solved, bodies_of(scene, "both")):
        for part, field in zip(PARTS, fields, strict=True):
            files.append(folder / f"{side}_{name}_{part}.vtu")
            bodies_mesh(field).save(files[-1])
    files.append(folder / f"{side}_patches.vtp")
    pressure_surface(solved.result, mirrored=side == "right").save(files[-1])
    if scene.discretisation.bodies == "solid":
        files += _export_solids(scene, side, solved, folder, built_model(scene) if model is None else model)
    return files


def _export_solids(
    scene: HertzScene | WheelsetScene,
    side: str,
    solved: SideSolution,
    folder: Path,
    model: ContactModel | WheelsetContact,
) -> list[Path]:
    """Write displacement and stress of both meshed solids; parameters as for `export_side`."""
    from wheelrail.contact.models.condensed import CondensedContact
    from wheelrail.contact.stress.solid_fields import solid_fields
    from wheelrail.contact.stress.xdmf_file import write_xdmf

    assert solved.pose is not None
    right = side == "right"  # solved as its mirror image
    pose = solved.pose.mirrored() if right else solved.pose
    pair = model if isinstance(scene, HertzScene) else cast("WheelsetContact", model).of(cast("Side", side)).model
    files: list[Path] = []
    bodies = solid_fields(cast("CondensedContact", pair), pose, solved.result)
    for name, fields in zip(bodies_of(scene, "both"), bodies, strict=True):
        files += write_xdmf(fields.mirrored() if right else fields, folder / f"{side}_{name}_solid.xdmf")
    return files
