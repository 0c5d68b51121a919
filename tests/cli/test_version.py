"""Version and commit: of the command, in results."""

from __future__ import annotations

import shutil
import subprocess
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.support import version

ROOT = Path(__file__).parents[2]
NUMBER = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]


def test_the_command_prints_version_and_commit() -> None:
    outcome = CliRunner().invoke(app, ["--version"])
    assert outcome.exit_code == 0
    assert outcome.stdout.startswith(f"wheelrail {NUMBER}")
    assert outcome.stdout.strip().endswith(version.commit())


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository of one commit in place of this one."""
    if shutil.which("git") is None:
        pytest.skip("git is not installed")
    for command in ("init -q", "add .", "-c user.name=a -c user.email=a@b commit -qm first"):
        (tmp_path / "pyproject.toml").write_text(f'[project]\nversion = "{NUMBER}"\n')
        subprocess.run(["git", "-C", str(tmp_path), *command.split()], check=True)
    monkeypatch.setattr(version, "ROOT", tmp_path)
    version.commit.cache_clear()
    return tmp_path


def test_changed_files_are_marked(checkout: Path) -> None:
    clean = version.commit()
    assert len(clean) == 12
    (checkout / "pyproject.toml").write_text(f'[project]\nversion = "{NUMBER}"  # changed\n')
    version.commit.cache_clear()
    assert version.commit() == f"{clean}-dirty"
    assert version.release() == f"{NUMBER}, commit {clean}-dirty"


def test_an_installed_release_has_no_commit(checkout: Path) -> None:
    shutil.rmtree(checkout / ".git")
    (checkout / "pyproject.toml").unlink()
    version.commit.cache_clear()
    assert version.commit() == ""
    assert version.release() == metadata.version("wheelrail")


@pytest.fixture(autouse=True)
def fresh() -> None:
    version.commit.cache_clear()
