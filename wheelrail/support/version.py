"""Version of the package, and the commit of a checkout."""

from __future__ import annotations

import subprocess
import tomllib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

ROOT = Path(__file__).parents[2]  # of a checkout
LIBRARIES = ("numpy", "scipy", "fenics-dolfinx", "petsc4py", "xarray")
PATIENCE = 5.0  # s for git


@cache
def versions() -> dict[str, str]:
    """Versions of this package and of the libraries that compute, by name."""
    numbers = {"wheelrail": _own()}
    for name in LIBRARIES:
        try:
            numbers[name] = version(name)
        except PackageNotFoundError:
            continue
    return numbers


def _own() -> str:
    """Version that the checkout states (its metadata may be outdated), or that of the installed package."""
    project = ROOT / "pyproject.toml"
    if project.exists():
        return str(tomllib.loads(project.read_text(encoding="utf-8"))["project"]["version"])
    try:
        return version("wheelrail")
    except PackageNotFoundError:
        return "not installed"


@cache
def commit() -> str:
    """Abbreviated hash of the checkout's commit, with "-dirty" if files differ; "" for an installed release."""
    if not (ROOT / ".git").exists() or not (ROOT / "pyproject.toml").exists():
        return ""
    command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"]
    try:
        described = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    except (OSError, subprocess.SubprocessError):
        return ""
    return described.stdout.strip()


def release() -> str:
    """Version and commit in one line: "0.2.0, commit 0123456789ab"."""
    number, revision = _own(), commit()
    return f"{number}, commit {revision}" if revision else number
