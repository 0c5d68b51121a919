"""Invalid input: one error with file, location, value and what is allowed, exit code 2, immediately."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from malformed_inputs import Case, every_case
from typer.testing import CliRunner

from wheelrail.cli.main import app

ROOT = Path(__file__).parents[2]
CASES = every_case()


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_bad_input_gives_one_error(case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    case.write(tmp_path)
    outcome = CliRunner().invoke(app, case.command)
    said = " ".join(outcome.stderr.replace("│", " ").split())
    assert outcome.exception is None or isinstance(outcome.exception, SystemExit), outcome.exception
    assert outcome.exit_code == 2, outcome.output
    assert "Traceback" not in said
    for part in case.says:
        assert part in said
    assert len(said) < 1500
    assert outcome.stdout == ""
    assert not (tmp_path / "out").exists()


WORST = (
    "huge",
    "a million numbers",
    "dots",
    "60 000 unknown keys",
    "key too long",
    "wheel: too many points",
    "run: waves beyond memory",
    "study: too many cases",
    "film: of results of a pair",
)


@pytest.mark.parametrize("name", WORST)
def test_command_rejects_bad_input(name: str, tmp_path: Path) -> None:
    (case,) = (case for case in CASES if case.name == name)
    case.write(tmp_path)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    line = [sys.executable, "-m", "wheelrail.cli", *case.command]
    with (tmp_path / "stdout").open("w+") as results, (tmp_path / "stderr").open("w+") as errors:
        process = subprocess.Popen(line, stdout=results, stderr=errors, env=environment, cwd=tmp_path)
        _, status, usage = os.wait4(process.pid, 0)
        said = (tmp_path / "stderr").read_text()
    assert (os.waitstatus_to_exitcode(status), (tmp_path / "stdout").read_text()) == (2, ""), said
    assert "Traceback" not in said
    for part in case.says:
        assert part in " ".join(said.split())
    assert usage.ru_maxrss < 500_000  # kB
    if not name.startswith("film"):  # which loads the plotting libraries
        assert usage.ru_utime + usage.ru_stime < 2.0  # s
