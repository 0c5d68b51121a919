"""Runtime folders: moved, in a bare virtual environment, they give the forces of this installation to the last bit."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pytest
from typer.testing import CliRunner

import wheelrail as wr
from wheelrail.api.elements.variables import OUTPUTS
from wheelrail.cli.main import app
from wheelrail.export.host import loaded_inputs
from wheelrail.export.runtime import FINITE_ELEMENTS, PACKAGES, write_scene

pytest.importorskip("cffi")
if shutil.which("cc") is None:
    pytest.skip("no C compiler", allow_module_level=True)

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PLACES = ((-1e-3, -2.8e-4), (-1.2e-3, -2.7e-4), (-1.4e-3, -2.6e-4))  # of host.c
# Modules that belong to the packages of requirements.txt and their own requirements.
MODULES = (
    "numpy",
    "scipy",
    "pydantic",
    "pydantic_core",
    "annotated_types",
    "typing_extensions",
    "typing_inspection",
    "lazy_loader",
    "packaging",
    "cffi",
    "_cffi_backend",
)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheelset of finite bodies with few strips, and a rail from a file."""
    folder = tmp_path_factory.mktemp("scene")
    text = (ROOT / "scenes/wheelset.toml").read_text(encoding="utf-8")
    (folder / "few.toml").write_text("strips = 8\ncells = 8\n" + text, encoding="utf-8")
    return folder / "few.toml"


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A virtual environment with nothing but the packages of the list, which are links to those of this process."""
    folder = tmp_path_factory.mktemp("bare") / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True, timeout=60)
    (packages,) = folder.glob("lib/python*/site-packages")
    for name in MODULES:
        spec = find_spec(name)
        assert spec is not None, name
        origin = Path(str(spec.origin))
        source = origin.parent if spec.submodule_search_locations else origin
        (packages / source.name).symlink_to(source)
        for libraries in source.parent.glob(f"{name}.libs"):
            (packages / libraries.name).symlink_to(libraries)
    return folder


def in_bare_environment(bare: Path, *command: Path | str) -> list[str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "WHEELRAIL"))}
    environment = kept | {"PATH": f"{bare / 'bin'}:/usr/bin:/bin", "HOME": str(bare)}
    done = subprocess.run(
        list(map(str, command)), env=environment, cwd="/", capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout[-500:] + done.stderr[-2000:]
    return done.stdout.splitlines()


def files_naming(folder: Path, *texts: str) -> Iterator[Path]:
    """Files with one of the texts."""
    for path in folder.rglob("*"):
        if path.is_file() and any(text.encode() in path.read_bytes() for text in texts):
            yield path


def numbers(scene: Path) -> list[float]:
    """What host.c prints of an element."""
    loaded = wr.load(scene)
    assert isinstance(loaded, wr.Wheelset)
    element, values, outputs = loaded.element(), [], np.zeros(len(OUTPUTS))
    inputs = loaded_inputs(loaded)
    for inputs[0], inputs[1] in PLACES:
        assert element.solve_array(inputs, outputs) == "converged"
        values += [*outputs, *element.tangent_array([3])[:, 0], *element.patch_array().ravel()]
        element.accept()
    return values


def test_the_environment_has_no_finite_elements(bare: Path) -> None:
    absent = (*FINITE_ELEMENTS, "wheelrail", "platformdirs", "typer", "xarray", "matplotlib")
    code = f"from importlib.util import find_spec; print([n for n in {absent!r} if find_spec(n)])"
    assert in_bare_environment(bare, bare / "bin/python", "-c", code) == ["[]"]


def test_a_moved_library(scene: Path, bare: Path, tmp_path: Path) -> None:
    expected = numbers(scene)
    first, moved = tmp_path / "made here", tmp_path / "elsewhere" / "moved"
    exported = CliRunner().invoke(app, ["export", "--c", str(first), str(scene), "--runtime"])
    assert exported.exit_code == 0, exported.stderr
    assert not list(files_naming(first, str(ROOT), str(tmp_path), os.environ["WHEELRAIL_CACHE"], str(scene.parent)))
    shutil.copytree(first, moved)
    shutil.rmtree(first)
    names = [line.split("==")[0] for line in (moved / "runtime/requirements.txt").read_text().splitlines()]
    assert tuple(names) == PACKAGES
    link = ["-L.", "-lwheelrail", "-Wl,-rpath,$ORIGIN", "-lm", "-lpthread", "-o", "host"]
    subprocess.run(["cc", "-I.", str(HERE / "host.c"), *link], cwd=moved, check=True, timeout=60)
    options = f'{{"scene": "{moved / "runtime/scene.toml"}"}}'
    values, second, *_ = in_bare_environment(bare, moved / "host", options, '{"model": "standard", "friction": 0.3}')
    assert [float.fromhex(text) for text in values.split()] == expected
    assert second == values  # in another thread


def test_a_unit_with_its_runtime(scene: Path, bare: Path, tmp_path: Path) -> None:
    """In a folder with a blank, as a program has unpacked it."""
    half_spaces, unit = tmp_path / "half_spaces.toml", tmp_path / "unit.fmu"
    half_spaces.write_text('bodies = "half-space"\n' + scene.read_text(encoding="utf-8"), encoding="utf-8")
    exported = CliRunner().invoke(app, ["export", "--fmu", str(unit), str(half_spaces), "--runtime"])
    assert exported.exit_code == 0, exported.stderr
    ZipFile(unit).extractall(tmp_path / "a b")
    (library,) = (tmp_path / "a b/binaries/linux64").iterdir()
    subprocess.run(["cc", str(HERE / "unit_host.c"), "-ldl", "-o", tmp_path / "host"], check=True, timeout=60)
    (token,) = re.findall('guid="(.*?)"', (tmp_path / "a b/modelDescription.xml").read_text(encoding="utf-8"))
    resources = (tmp_path / "a b/resources").as_uri()
    _, first, *_ = in_bare_environment(bare, tmp_path / "host", library, token, resources)
    *values, failed = first.split()
    assert failed == "0"
    assert [float.fromhex(value) for value in values[:12]] == numbers(half_spaces)[:12]


def test_bodies_that_need_finite_elements_are_refused(tmp_path: Path) -> None:
    scene = tmp_path / "solid.toml"
    text = (ROOT / "scenes/wheelset.toml").read_text(encoding="utf-8")
    scene.write_text('bodies = "solid"\n' + text, encoding="utf-8")
    exported = CliRunner().invoke(app, ["export", "--c", str(tmp_path / "out"), str(scene), "--runtime"])
    assert exported.exit_code == 2
    assert exported.stderr.startswith(f"{scene}: a runtime folder has no 3D meshes")


def test_a_standard_contact_is_solved_from_its_runtime(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    text = (ROOT / "scenes/wheelset.toml").read_text(encoding="utf-8")
    scene.write_text(text.replace('"condensed"', '"standard"'), encoding="utf-8")
    exported = CliRunner().invoke(app, ["export", "--c", str(tmp_path / "out"), str(scene), "--runtime"])
    assert exported.exit_code == 0, exported.stderr
    assert (tmp_path / "out/runtime/wheelrail/__init__.py").exists()


def test_files_of_the_scene_are_in_the_runtime(tmp_path: Path) -> None:
    """A unit or a library needs no file beside it."""
    (tmp_path / "rail.txt").write_text("points")
    (tmp_path / "table.nc").write_text("forces")
    scene = tmp_path / "scene.toml"
    scene.write_text(
        'table = "table.nc"\n[profiles]\nwheel = "S1002"\nrail = "60E1"\n[profiles.left]\nrail = "rail.txt"\n'
    )
    write_scene(scene, tmp_path / "unit")
    text = (tmp_path / "unit/scene.toml").read_text(encoding="utf-8")
    assert 'rail = "1_rail.txt"' in text
    assert 'table = "0_table.nc"' in text
    assert 'rail = "60E1"' in text
    assert (tmp_path / "unit/1_rail.txt").read_text(encoding="utf-8") == "points"
    assert (tmp_path / "unit/0_table.nc").read_text(encoding="utf-8") == "forces"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--c", "x", "--runtime"], "export: SCENE is required"),
        (["scene.toml", "--out", "x", "--runtime"], "export: --runtime: allowed only with --fmu and --c"),
        ([str(ROOT / "scenes/hertz.toml"), "--c", "x", "--runtime"], f"{ROOT / 'scenes/hertz.toml'}: kind = "),
        ([str(ROOT / "scenes/wheelset.toml"), "--fmu", "x.fmu", "--fmi", "1.0"], "--fmi 1.0: must be 2.0 or 3.0"),
    ],
)
def test_wrong_arguments(arguments: list[str], says: str) -> None:
    outcome = CliRunner().invoke(app, ["export", *arguments])
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith(says)
