"""Invalid input: one error with file, location, value and what is allowed, exit code 2, immediately."""

from __future__ import annotations

import json
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


# A small process starts the command: the largest memory of a process counts that of its parent, too.
LAUNCHER = """
import json, os, subprocess, sys
_, status, used = os.wait4(subprocess.Popen(sys.argv[1:]).pid, 0)
print(json.dumps([os.waitstatus_to_exitcode(status), used.ru_maxrss, used.ru_utime + used.ru_stime]))
"""


@pytest.mark.parametrize("name", WORST)
def test_command_rejects_bad_input(name: str, tmp_path: Path) -> None:
    (case,) = (case for case in CASES if case.name == name)
    case.write(tmp_path)
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    line = [sys.executable, "-S", "-c", LAUNCHER, sys.executable, "-m", "wheelrail.cli", *case.command]
    with (tmp_path / "stderr").open("w+") as errors:
        ended = subprocess.run(line, stdout=subprocess.PIPE, stderr=errors, env=environment, cwd=tmp_path)
        said = (tmp_path / "stderr").read_text()
    *printed, usage = ended.stdout.decode().splitlines()
    status, memory, seconds = json.loads(usage)
    assert (status, printed) == (2, []), said
    assert "Traceback" not in said
    for part in case.says:
        assert part in " ".join(said.split())
    assert memory < 500_000  # kB
    if not name.startswith("film"):  # which loads the plotting libraries
        assert seconds < 2.0
