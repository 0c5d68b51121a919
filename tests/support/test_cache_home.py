"""Commands without a home folder, or with one that cannot be written."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from solid_scene import SOLIDS

ROOT = Path(__file__).parents[2]
STANDARD = """
kind = "hertz"
model = "standard"
tangential = "polach"
friction = 0.3
speed = 20.0
creepage = [1e-3, 0.0, 0.0]
load = 10e3
upper = {radii = [0.46, 0.3], E = 210e9, nu = 0.3}
lower = {radii = [inf, 0.3], E = 210e9, nu = 0.3}
"""
WITHOUT_USER = """
import os, sys
import pwd
def unknown(uid):
    raise KeyError(uid)
pwd.getpwuid = unknown
from wheelrail.cli.entry import main
main()
"""


@pytest.mark.parametrize(("home", "text"), [(None, STANDARD), ("/dev/null", SOLIDS)], ids=["standard", "full"])
def test_contact_without_a_home_folder(tmp_path: Path, home: str | None, text: str) -> None:
    (tmp_path / "scene.toml").write_text(text)
    removed = ("HOME", "WHEELRAIL_CACHE", "XDG_CACHE_HOME", "XDG_CONFIG_HOME")
    environment = {name: value for name, value in os.environ.items() if name not in removed}
    environment |= {"PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path)}
    environment |= {} if home is None else {"HOME": home}
    line = [sys.executable, "-c", WITHOUT_USER, "contact", "scene.toml", "--json"]
    done = subprocess.run(line, env=environment, cwd=tmp_path, capture_output=True, text=True, timeout=550)
    assert done.returncode == 0, done.stderr
    assert '"status": "converged"' in done.stdout
    left = [name for name in os.listdir(tmp_path) if not name.startswith("ompi.")]  # Open MPI 5 keeps a folder
    assert left == ["scene.toml"]
