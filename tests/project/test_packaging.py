"""Contents of the wheel, and agreement of the other set-ups on libraries."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest
import yaml
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.scenes.example_scenes import examples
from wheelrail.scenes.schema.toml import parse

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SCIENCE = ("contact", "forms", "meshes", "vehicle")
SOURCES = ["pyproject.toml", "README.md", "LICENSE", "bindings", "scenes", "wheelrail", *SCIENCE]
CARRIED = {".py", ".pyi", ".so", ".toml", ".html", ".css", ".js", ".c", ".h", ".f90", ".in"}
BUILT = ("*.so", "_[!_]*.pyi", "CMake[!L]*", "*.cmake", "*.ninja", "*.a", ".*")  # what compiling leaves
pytest.importorskip("scikit_build_core")


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Copy of the sources with their links, so that building does not change them."""
    tree = tmp_path_factory.mktemp("tree")
    for name in SOURCES:
        if (ROOT / name).is_dir():
            ignored = shutil.ignore_patterns("__pycache__", *BUILT)
            shutil.copytree(ROOT / name, tree / name, ignore=ignored, symlinks=True)
        else:
            shutil.copy(ROOT / name, tree / name)
    return tree


def _built(tree: Path, source: Path, folder: str, *options: str) -> Path:
    command = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", folder, source]
    command += [f"--config-settings={option}" for option in options]
    subprocess.run(command, cwd=tree, check=True, timeout=580, capture_output=True)
    (built,) = (tree / folder).glob("*.whl")
    return built


@pytest.fixture(scope="module")
def wheel(tree: Path) -> Path:
    launcher = f"{sys.executable};{ROOT / 'tests/helpers/compiler_launcher.py'};{tree / 'bindings'}"
    return _built(tree, Path("."), "dist", f"cmake.define.CMAKE_CXX_COMPILER_LAUNCHER={launcher}")


def _contents(wheel: Path) -> set[str]:
    return {name for name in ZipFile(wheel).namelist() if ".dist-info/" not in name}


def test_wheel_contains_all_code_and_data(wheel: Path) -> None:
    wanted = {"wheelrail/py.typed"}
    for top in ("wheelrail", *SCIENCE):
        for folder, _, names in os.walk(ROOT / top):  # which does not follow links
            place = Path(folder).relative_to(ROOT)
            inside = place if top == "wheelrail" else "wheelrail" / place
            wanted |= {str(inside / name) for name in names if Path(name).suffix in CARRIED}
    wanted |= {f"wheelrail/scenes/examples/{file.name}" for file in (ROOT / "scenes").glob("*.toml")}
    builds = [file.parent for file in (ROOT / "wheelrail/bindings").glob("*/_contact*.so")]
    wanted |= {
        (build.relative_to(ROOT) / "lib/libwheelrail.so").as_posix() for build in builds
    }  # beside the sources one
    assert _contents(wheel) == wanted
    assert {"wheelrail/contact/models/condensed.py", "wheelrail/scenes/examples/hertz.toml"} <= wanted


def test_source_distribution_builds_the_same_wheel(tree: Path, wheel: Path) -> None:
    """But for the compiled core, whose sources it carries."""
    build = "from scikit_build_core.build import build_sdist; build_sdist('sdist')"
    subprocess.run([sys.executable, "-c", build], cwd=tree, check=True, timeout=580, capture_output=True)
    (archive,) = (tree / "sdist").glob("*.tar.gz")
    core = {name for name in _contents(wheel) if name.startswith("wheelrail/bindings/") and not name.endswith(".py")}
    assert _contents(_built(tree, archive, "from-sdist", "wheel.cmake=false")) == _contents(wheel) - core
    with tarfile.open(archive) as opened:
        carried = {name.partition("/")[2] for name in opened.getnames()}
    headers = {file.relative_to(ROOT).as_posix() for top in SCIENCE for file in (ROOT / top).rglob("core/*.hpp")}
    others = {"bindings/CMakeLists.txt", "bindings/vehicle.cpp", "wheelrail/support/core/dual.hpp"}
    assert len(headers) > 50
    assert carried >= headers | others


def test_wheel_works_in_a_clean_environment(wheel: Path, tmp_path: Path) -> None:
    """An environment with the dependencies, but none of this project's folders: from a file to a result."""
    clean = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", clean], check=True)
    python = clean / "bin/python"
    (inside,) = (clean / "lib").glob("python*/site-packages")
    # The plain path brings the libraries along, but not the editable install of this project: its hook is a .pth file.
    (inside / "libraries.pth").write_text(sysconfig.get_path("purelib") + "\n", encoding="utf-8")
    install = [sys.executable, "-m", "pip", "--python", python, "install", "-q", "--no-deps", "--ignore-installed"]
    subprocess.run([*install, wheel], check=True, timeout=580)
    work = tmp_path / "work"
    work.mkdir()
    where = "import wheelrail.contact.models, wheelrail as w; print(w.__file__, w.contact.models.__file__)"
    assert _output([python, "-c", where], work).count(str(inside)) == 2
    names = ("api", "cli", "contact", "forms", "meshes", "scenes", "support", "vehicle")
    unknown = f"from importlib.util import find_spec; print(*map(find_spec, {names}))"
    assert set(_output([python, "-I", "-c", unknown], work).split()) == {"None"}
    command = clean / "bin/wheelrail"
    scene = _output([command, "example", "hertz"], work)
    scene = re.sub(r"(?m)^(model|surface_size|slip_order)\b.*\n", "", scene)
    (work / "mine.toml").write_text('model = "standard"\n' + scene, encoding="utf-8")
    assert "converged" in _output([command, "contact", "mine.toml"], work)


def _output(command: Iterable[Any], folder: Path) -> str:
    there = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.run(
        list(map(str, command)), cwd=folder, env=there, check=True, timeout=580, capture_output=True, text=True
    ).stdout


def test_examples_are_printed_unchanged() -> None:
    listed = CliRunner().invoke(app, ["example"])
    assert listed.exit_code == 0
    assert [line.split()[0] for line in listed.stdout.splitlines()[1:]] == list(examples())
    assert all(heading for heading in examples().values())
    for name in examples():
        printed = CliRunner().invoke(app, ["example", name])
        assert printed.stdout == (ROOT / "scenes" / f"{name}.toml").read_text(encoding="utf-8")
        assert parse(printed.stdout, name)


def test_unknown_example_is_an_error() -> None:
    outcome = CliRunner().invoke(app, ["example", "herz"])
    assert outcome.exit_code == 2
    assert outcome.stderr.startswith("NAME = 'herz': must be one of cooperrider, cooperrider_bogie, curve, ")


def requirement(text: str) -> tuple[str, str]:
    """Name as registries compare it, and the versions allowed."""
    name, versions = re.fullmatch(r"\s*([\w.-]+)\s*(.*?)\s*", text).groups()  # type: ignore[union-attr]
    return re.sub(r"[-_.]+", "-", name).lower(), versions.replace(" ", "")


def test_conda_environment_names_the_same_libraries_and_versions() -> None:
    """Without extras for tests and documentation; gmsh is installed with the project itself."""
    listed = yaml.safe_load((ROOT / "environment.yml").read_text(encoding="utf-8"))["dependencies"]
    conda = dict(requirement(text) for text in listed if isinstance(text, str))
    (by_pip,) = (entry["pip"] for entry in listed if isinstance(entry, dict))
    assert by_pip == ["--editable ."]
    project = PROJECT["project"]
    extras = project["optional-dependencies"]
    wanted = dict(map(requirement, [*project["dependencies"], *extras["view"], *extras["cluster"]]))
    wanted.pop("gmsh")
    conda["matplotlib"] = conda.pop("matplotlib-base")
    assert {name: conda.get(name) for name in wanted} == wanted
    assert {"fenics-dolfinx", "petsc4py", "mpi4py"} <= conda.keys()


def test_unknown_debian_release_is_rejected() -> None:
    outcome = subprocess.run(["tests/debian.sh", "woody"], cwd=ROOT, capture_output=True, text=True, timeout=20)
    assert outcome.returncode == 2
    assert "RELEASE=woody: must be trixie (Debian 13, dolfinx 0.9) or sid" in outcome.stderr
