"""Files in the working directory change nothing in the libraries."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
REPORT = """
import json, os
import wheelrail
from petsc4py import PETSc
from dolfinx import jit
import matplotlib
try:
    from ffcx.options import get_options
except ImportError:
    from ffcx.parameters import get_parameters as get_options
jit_options = getattr(jit, "get_options", None) or jit.get_parameters
print(json.dumps([
    PETSc.Options().hasName("from_folder"),
    jit_options()["cffi_extra_compile_args"],
    get_options()["epsilon"],
    matplotlib.rcParams["lines.linewidth"],
    matplotlib.get_backend(),
    os.getcwd(),
]))
"""


def settings(folder: Path, **environment: str) -> list[object]:
    """Settings of the libraries in a process with this working directory, and that directory afterwards."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("PETSC_OPTIONS")}
    environment = {**kept, "PYTHONPATH": str(ROOT), "HOME": str(folder / "home"), **environment}
    done = subprocess.run(
        [sys.executable, "-c", REPORT], env=environment, cwd=folder, capture_output=True, text=True, check=True
    )
    found: list[object] = json.loads(done.stdout)
    return found


def test_settings_in_the_working_directory_are_not_read(tmp_path: Path) -> None:
    clean, other = tmp_path / "clean", tmp_path / "other"
    for folder in (clean, other):
        folder.mkdir()
    (other / ".petscrc").write_text("-from_folder 1\n")
    (other / "matplotlibrc").write_text("lines.linewidth: 7.5\nbackend: module://harm\n")
    (other / "harm.py").write_text("raise SystemExit('imported from the working directory')\n")
    for name in ("parameters", "options"):
        (other / f"dolfinx_jit_{name}.json").write_text('{"cffi_extra_compile_args": ["-DHARM"]}')
        (other / f"ffcx_{name}.json").write_text('{"epsilon": 0.5}')
    *expected, first = settings(clean)
    *found, second = settings(other)
    assert found == expected
    assert (first, second) == (str(clean), str(other))
    assert found[0] is False


def test_settings_of_the_user_are_read(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / ".petscrc").write_text("-from_folder 1\n")
    assert settings(tmp_path)[0] is True
