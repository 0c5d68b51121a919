"""The README's example in Python and its commands run."""

from __future__ import annotations

import json
import os
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from wheelrail.cli.main import app
from wheelrail.contact.analytical.hertz import hertz, modulus
from wheelrail.scenes.schema.scene import load_scene

ROOT = Path(__file__).parents[2]
README, CONTRIBUTING, OVERVIEW = (
    (ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "CONTRIBUTING.md", "docs/overview.md")
)
STEEL = (2.1e11, 0.3)


def blocks(language: str) -> list[str]:
    """Code blocks of the README in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)


def coarser(text: str, size: str) -> str:
    """Text with a larger surface size [m], which takes seconds instead of half a minute."""
    changed, count = re.subn(r"surface_size( ?)=( ?)[0-9.e-]+", rf"surface_size\1=\g<2>{size}", text)
    assert count == 1
    return changed


@pytest.fixture(autouse=True)
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A separate cache, unless the session has one."""
    if "WHEELRAIL_CACHE" not in os.environ:
        monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path / "cache"))


def test_length() -> None:
    """What a reader takes in at a glance: the picture first; tables are in the documentation."""
    assert len(README.encode()) < 8000
    assert README.splitlines()[2].startswith("![")
    assert "|---|" not in README


def test_accuracy_in_one_sentence() -> None:
    """With the figures of the tables."""
    words = " ".join(README.split())
    said = re.search(r"over 132 cases by ([0-9.]+) % of mu N \(RMS; ([0-9.]+) % at most\), and a contact takes", words)
    took = re.search(r"takes ([0-9.]+) ms from cold and ([0-9.]+) ms in a time integration", words)
    assert said is not None
    assert took is not None
    assert f"| creep forces, 132 cases | CONTACT, extrapolated | {said[1]} % of mu N | {said[2]} % |" in OVERVIEW
    assert re.search(rf"\| strips [\w ]+, the default \| \d+ \| {took[1]} \| {took[2]} \|", OVERVIEW)


def test_example_in_python(capsys: pytest.CaptureFixture[str]) -> None:
    (example,) = blocks("python")
    assert len([line for line in example.splitlines() if line]) == 5
    names: dict[str, Any] = {}
    exec(compile(example, "README.md", "exec"), names)
    exact = hertz(0.5 / 0.46, 0.5 / 0.3, modulus(STEEL, STEEL), force=60e3)
    solution, patch = names["solution"], names["patch"]
    assert solution.data["vertical_force"].item() == pytest.approx(60e3, rel=1e-6)
    assert patch.max_pressure == pytest.approx(exact.peak, rel=0.006)
    said = re.search(r"prints `(\d+ MPa, creep force -\d+ N)`", README)
    assert said is not None
    assert capsys.readouterr().out == said[1] + "\n"


def test_quoted_hertz_peak_pressure() -> None:
    exact = hertz(0.5 / 0.46, 0.5 / 0.3, modulus(STEEL, STEEL), force=60e3)
    assert f"(Hertz: {exact.peak / 1e6:.0f} MPa)" in README


def test_example_on_the_command_line(tmp_path: Path) -> None:
    commands = re.findall(r"wheelrail (contact|run) (\S+\.toml)", "".join(blocks("sh")))
    assert {command for command, _ in commands} == {"contact", "run"}
    for command, scene in commands:
        assert (load_scene(ROOT / scene).kind == "run") == (command == "run")
    first = ROOT / commands[0][1]
    (tmp_path / "scene.toml").write_text(coarser(first.read_text(encoding="utf-8"), "1e-3"), encoding="utf-8")
    outcome = CliRunner().invoke(app, ["contact", str(tmp_path / "scene.toml"), "--json"])
    assert outcome.exit_code == 0
    report = json.loads(outcome.stdout)
    assert report["status"] == "converged"
    assert report["contact"]["normal_force"] == pytest.approx(10e3, rel=1e-6)
    exact = hertz(0.5 / 0.46, 1 / 0.3, modulus(STEEL, STEEL), force=10e3)
    assert report["contact"]["patches"][0]["max_pressure"] == pytest.approx(exact.peak, rel=0.1)


def test_commands_and_folders_exist() -> None:
    targets = set(re.findall(r"^make (\w+)", "".join(blocks("sh")), flags=re.MULTILINE))
    assert targets == {"run", "notebooks", "test"}
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert all(re.search(rf"^{target}:", makefile, flags=re.MULTILINE) for target in targets)
    folders = re.findall(r"^\| `(\w+)/` \|", CONTRIBUTING, flags=re.MULTILINE)
    assert len(folders) == 11
    assert all((ROOT / folder).is_dir() for folder in folders)


def test_licence_and_version_agree() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {project['version']}\n" in citation
    assert f"\nlicense: {project['license']['text']}\n" in citation
    assert "GNU LESSER GENERAL PUBLIC LICENSE" in (ROOT / "LICENSE").read_text(encoding="utf-8")
    (date,) = re.findall(r"^date-released: (\d{4}-\d\d-\d\d)$", citation, flags=re.MULTILINE)
    assert f"## {project['version']} - {date}\n" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_statements_agree_with_scenes_and_tables() -> None:
    """The approach is the one a user gets; scenes are described by their laws; the finite bodies by their supports."""
    validation, limits = (
        (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8") for name in ("validation", "limits")
    )
    uncorrected = re.search(r"\| hertz \| approach, uncorrected \| % \| ([0-9.]+) \| ([0-9.]+) \|", validation)
    assert uncorrected is not None
    (row,) = (line for line in OVERVIEW.splitlines() if line.startswith("| peak pressure; semi-axes; approach |"))
    assert row.count(f"; {uncorrected[1]} %") == 1
    assert row.count(f"; {uncorrected[2]} %") == 1
    for command in "".join(blocks("sh")).splitlines():
        scene, _, comment = command.partition("#")
        if match := re.search(r"scenes/\w+\.toml", scene):
            paper = 'laws = "paper"' in (ROOT / match[0]).read_text(encoding="utf-8")
            assert paper or "the paper's laws" not in comment, command
    for text in (OVERVIEW, limits):
        words = " ".join(text.split())
        assert "percentage points" in words
        assert re.search(r"clamped at its foot.*clamped at its bore|clamped at its foot, wheel at its bore", words)
        assert "rail pads" in words.lower()
        assert "Peak pressure and patch are not affected" not in words
