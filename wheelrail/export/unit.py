"""A wheelset scene as a functional mock-up unit (FMI 2.0, 3.0) for model exchange and co-simulation."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory
from uuid import uuid4
from zipfile import ZIP_DEFLATED, ZipFile

from wheelrail.api.elements.variables import PARAMETERS
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.export.host import loaded_inputs, loaded_wheelset
from wheelrail.export.library import compile_library, is_native
from wheelrail.export.model_description import Fmi, UnitModel, model_description
from wheelrail.export.native import copy_library, write_native
from wheelrail.export.runtime import export_runtime, write_scene
from wheelrail.export.warm_up import SCENE
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import WheelsetScene, load_scene
from wheelrail.support.atomic_file import atomic_file
from wheelrail.support.version import versions

PLATFORM: dict[Fmi, str] = {"2.0": "linux64", "3.0": "x86_64-linux"}
RUNTIME = "../../resources/runtime"  # from the folder of the library


def export_unit(scene: Path, unit: Path, fmi: Fmi = "2.0", *, runtime: bool = False) -> None:
    """Write a functional mock-up unit with library, scene and profiles of files.

    Parameters:
        scene: wheelset scene (TOML).
        unit: file to write.
        fmi: version of the interface.
        runtime: whether the unit starts a Python, with the packages of a runtime folder in it.

    Without runtime a contact that can be solved without Python is; others start the Python of this installation.

    Start values are an equilibrium with the load of the scene. Raises SceneError for another scene, ValueError for a
    load that cannot be carried, OSError without a compiler, cffi or Python's headers, or for a file that cannot
    be written, and both as `export_runtime`.
    """
    checked = load_scene(scene)
    if not isinstance(checked, WheelsetScene):
        raise SceneError(f'{scene}: kind = "{checked.kind}": must be "wheelset"')
    coefficients = [checked.side(side).friction for side in SIDES]
    numbers = [float(value) for value in coefficients if isinstance(value, float | int)]
    with TemporaryDirectory() as work:
        folder, token = Path(work), str(uuid4())
        resources, binaries = folder / "resources", folder / "binaries" / PLATFORM[fmi]
        for place in (resources, binaries):
            place.mkdir(parents=True)
        write_scene(scene, resources)
        wheelset = loaded_wheelset(f'{{"scene": "{SCENE}"}}', resources)
        native = not runtime and is_native(wheelset, unit)
        if runtime:
            export_runtime(resources / "runtime", resources)
        if native:
            write_native(wheelset, resources, token)
        model = UnitModel(
            fmi=fmi,
            identifier=re.sub(r"\W", "_", f"wheelrail_{unit.stem}", flags=re.ASCII),
            token=token,
            version=versions()["wheelrail"],
            start=loaded_inputs(wheelset).tolist(),
            friction=numbers if len(numbers) == len(SIDES) else (),
            has_tangent=checked.model != "standard" or (native and checked.tangential != "polach"),
        )
        (folder / "modelDescription.xml").write_text(model_description(model), encoding="utf-8")
        library = binaries / f"{model.identifier}.so"
        if native:
            copy_library(library)
        else:
            module = f"_{model.identifier}_{token.replace('-', '')}"
            compile_library(library, module, _source(model), RUNTIME if runtime else "")
        with atomic_file(unit) as part, ZipFile(part, "w", ZIP_DEFLATED) as archive:
            for file in sorted(folder.rglob("*")):
                if file.is_file():
                    archive.write(file, file.relative_to(folder))


def _source(model: UnitModel) -> str:
    """C code of the FMI functions, with the constants of the unit."""
    friction: list[float] = list(model.friction) or [0.0] * len(PARAMETERS)
    start, coefficients = (", ".join(map(repr, numbers)) for numbers in (model.start, friction))
    constants = f'''static int constants(const char *folder, Constants *own)
{{
    static const Constants values = {{"{model.token}", {{{start}}}, {{{coefficients}}}}};
    (void)folder;
    *own = values;
    return 0;
}}'''
    unit, fmi = (files("wheelrail.export").joinpath(name) for name in ("unit.c", f"fmi{model.fmi[0]}.c"))
    texts = unit.read_text(encoding="utf-8"), constants, fmi.read_text(encoding="utf-8")
    return "\n".join((f'#define SCENE "{SCENE}"', *texts))
