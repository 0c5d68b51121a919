"""A folder with all that a library or a unit needs beside Python and its packages; it can be moved."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import tomli_w

import wheelrail
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.laws.pointwise import store_libraries
from wheelrail.export.warm_up import SCENE, warm_up
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.scene import WheelsetScene, load_scene
from wheelrail.scenes.schema.toml import parse, read_text
from wheelrail.support.cache import cache_folders

PACKAGES = ("numpy", "scipy", "pydantic", "lazy_loader", "cffi")
FINITE_ELEMENTS = ("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh")  # are not needed at run time
BODIES = "wheel", "rail"
_WARM_UP = """
import sys
from pathlib import Path
sys.modules.update(dict.fromkeys({absent!r}))  # as if they were not installed
from wheelrail.export.warm_up import warm_up
warm_up(Path(sys.argv[1]))
"""


def write_scene(scene: Path, folder: Path) -> None:
    """Write scene.toml, with the profile and table files that the scene reads, into a folder.

    Raises SceneError, OSError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    data = parse(read_text(scene), scene)
    profiles = data.get("profiles", {})
    named = [(data, "table"), *((profiles, body) for body in BODIES)]
    named += [(profiles[side], body) for side in SIDES if side in profiles for body in BODIES]
    for table, key in named:
        file = scene.parent / str(table.get(key, ""))
        if key in table and file.is_file():
            name = f"{len(list(folder.iterdir()))}_{file.name}"
            shutil.copyfile(file, folder / name)
            table[key] = name
    (folder / SCENE).write_bytes(tomli_w.dumps(data).encode())


def export_runtime(folder: Path, scene_folder: Path) -> None:
    """Write a runtime folder: this package, the compliances of a wheelset, laws and a list of packages.

    Parameters:
        folder: is created; an older runtime in it is replaced.
        scene_folder: that of the wheelset's scene.toml.

    The wheelset is solved from the folder alone, without finite elements. Raises OSError for a folder that cannot be
    written, SceneError for a scene that is no wheelset, whose contact fails or whose solves need finite elements.
    """
    scene = load_scene(scene_folder / SCENE)
    if isinstance(scene, WheelsetScene) and (
        scene.model in ("full", "table") or (scene.has_elements and scene.discretisation.bodies == "solid")
    ):
        models = 'model = "full", model = "table", bodies = "solid"'
        raise SceneError(f"a runtime folder has no 3D meshes and reads no NetCDF: not allowed with {models}")
    warm_up(scene_folder)  # computes the compliances, with finite elements
    package = folder / "wheelrail"
    for old in (package, folder / "cache"):
        if old.exists():
            shutil.rmtree(old)
    shutil.copytree(Path(wheelrail.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__", "*.hpp"))
    requirements = "".join(f"{name}=={version(name)}\n" for name in PACKAGES)
    (folder / "requirements.txt").write_text(requirements, encoding="utf-8")
    store_libraries(folder / "cache")
    _solve(folder, scene_folder)


def _solve(folder: Path, scene_folder: Path) -> None:
    """Solve the wheelset with the package of the runtime folder, and fill its cache with the data read.

    Raises OSError with the last line of the failure.
    """
    caches = [folder / "cache", *cache_folders()]
    environment = os.environ | {
        "PYTHONPATH": str(folder),
        "PYTHONDONTWRITEBYTECODE": "1",
        "WHEELRAIL_CACHE": os.pathsep.join(str(cache.absolute()) for cache in caches),
    }
    code = _WARM_UP.format(absent=FINITE_ELEMENTS)
    command = [sys.executable, "-c", code, str(scene_folder.absolute())]
    done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise OSError(f"the wheelset cannot be solved without finite elements: {reason}")
