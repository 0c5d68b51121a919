"""Closed standard streams, and names of files with brackets or in other encodings."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from malformed_inputs import WHEELSET, standard
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.cli.output import result_console
from wheelrail.support.terminal import progress_console

ROOT = Path(__file__).parents[2]


def shell(folder: Path, arguments: str) -> subprocess.CompletedProcess[str]:
    """The command in a shell, with redirections."""
    line = f"{sys.executable} -m wheelrail.cli {arguments}"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True, env=environment, cwd=folder, timeout=60)


@pytest.mark.parametrize("arguments", ["--version", "example", "contact scene.toml --json"])
def test_closed_standard_output_is_an_error(tmp_path: Path, arguments: str) -> None:
    (tmp_path / "scene.toml").write_text(standard(WHEELSET))
    done = shell(tmp_path, f"{arguments} >&-")
    assert (done.returncode, done.stderr.splitlines()) == (
        2,
        ["standard output: closed; must be open, if only on /dev/null"],
    )
    assert shell(tmp_path, f"{arguments} >&- 2>&-").returncode == 2


def test_closed_standard_error_and_input_are_none(tmp_path: Path) -> None:
    done = shell(tmp_path, "example hertz <&- 2>&-")
    assert (done.returncode, done.stderr) == (0, "")
    assert 'kind = "hertz"' in done.stdout
    (tmp_path / "scene.toml").write_text("x")
    done = shell(tmp_path, "contact scene.toml <&- 2>&-")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "")


def test_names_in_other_encodings(tmp_path: Path) -> None:
    done = shell(tmp_path, "contact $'sc\\xff.toml'")
    assert done.returncode == 2
    assert done.stderr.startswith("sc")
    assert "No such file" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_a_name_too_long_is_shortened(tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["contact", "x" * 5000])
    assert done.exit_code == 2
    assert len(done.stderr) < 300
    assert "File name too long" in done.stderr


def test_brackets_in_names_of_files_are_no_markup() -> None:
    for console in (progress_console(), result_console()):
        with console.capture() as said:
            console.print("[red]a[/red]/[/b] contains an interrupted run", soft_wrap=True, highlight=False)
        assert said.get() == "[red]a[/red]/[/b] contains an interrupted run\n"
