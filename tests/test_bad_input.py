"""Input that cannot be used: one complaint with file, place, value and what is allowed, exit status 2, at once."""

from __future__ import annotations

from pathlib import Path

import pytest
from bad_input import Case, every_case
from typer.testing import CliRunner

from scenes.cli import app

ROOT = Path(__file__).parents[1]
CASES = every_case()


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_bad_input_is_refused_with_one_complaint(case: Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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
