"""A wheelset scene as a functional mock-up unit (FMI 2.0) for model exchange and co-simulation."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4
from zipfile import ZIP_DEFLATED, ZipFile

import tomli_w

from wheelrail.api.elements.variables import PARAMETERS
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.export.host import loaded_wheelset
from wheelrail.export.library import compile_library
from wheelrail.export.model_description import UnitModel, model_description
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import WheelsetScene, load_scene
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.version import versions

PLATFORM = "linux64"


def export_unit(scene: Path, unit: Path) -> None:
    """Write a functional mock-up unit with library, scene and profiles of files.

    Parameters:
        scene: wheelset scene (TOML).
        unit: file to write.

    Raises SceneError for another scene, OSError without a compiler, cffi or Python's headers, or for a file that cannot
    be written.
    """
    checked = load_scene(scene)
    if not isinstance(checked, WheelsetScene):
        raise SceneError(f'{scene}: kind = "{checked.kind}": must be "wheelset"')
    coefficients = [checked.side(side).friction for side in SIDES]
    numbers = [float(value) for value in coefficients if isinstance(value, float | int)]
    with TemporaryDirectory() as work:
        folder, guid = Path(work), str(uuid4())
        resources, binaries = folder / "resources", folder / "binaries" / PLATFORM
        for place in (resources, binaries):
            place.mkdir(parents=True)
        write_scene(scene, resources)
        model = UnitModel(
            identifier=re.sub(r"\W", "_", f"wheelrail_{unit.stem}", flags=re.ASCII),
            guid=guid,
            version=versions()["wheelrail"],
            start=loaded_wheelset('{"scene": "scene.toml"}', resources).element().start_array().tolist(),
            friction=numbers if len(numbers) == len(SIDES) else (),
            has_tangent=checked.model != "standard",
        )
        (folder / "modelDescription.xml").write_text(model_description(model), encoding="utf-8")
        library = binaries / f"{model.identifier}.so"
        compile_library(library, f"_{model.identifier}_{guid.replace('-', '')}", _source(model))
        with atomic_file(unit) as part, ZipFile(part, "w", ZIP_DEFLATED) as archive:
            for file in sorted(folder.rglob("*")):
                if file.is_file():
                    archive.write(file, file.relative_to(folder))


def write_scene(scene: Path, folder: Path) -> None:
    """Write scene.toml and the profiles that it reads from files into a folder. Raises SceneError, OSError."""
    data = parse(read_text(scene), scene)
    profiles = data["profiles"]
    for table in (profiles, *(profiles[side] for side in SIDES if side in profiles)):
        for body in ("wheel", "rail"):
            file = scene.parent / str(table.get(body, ""))
            if body in table and file.is_file():
                name = f"{len(list(folder.iterdir()))}_{file.name}"
                copyfile(file, folder / name)
                table[body] = name
    (folder / "scene.toml").write_bytes(tomli_w.dumps(data).encode())


def _source(model: UnitModel) -> str:
    """C code of the FMI functions, with the constants of the unit."""
    friction: list[Any] = list(model.friction) or [0.0] * len(PARAMETERS)
    constants = (
        f'#define GUID "{model.guid}"',
        f"static const double START[] = {{{', '.join(map(repr, model.start))}}};",
        f"static const double PARAMETER_START[] = {{{', '.join(map(repr, friction))}}};",
        "static const char *const PARAMETER_NAME[] = {" + ", ".join(f'"{v.name}"' for v in PARAMETERS) + "};",
    )
    return "\n".join((*constants, files("wheelrail.export").joinpath("fmi2.c").read_text(encoding="utf-8")))
