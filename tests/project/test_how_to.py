"""How-to pages do what they say: their study files and Python code run as they stand."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest

from wheelrail.scenes.studies.run import run_study

mpl.use("Agg")
ROOT = Path(__file__).parents[2]


def blocks(page: str, language: str) -> list[str]:
    """Code blocks of a how-to page in a language."""
    text = (ROOT / "docs" / "how-to" / f"{page}.md").read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a copy of the scene that the page names."""
    shutil.copy(ROOT / "scenes" / "hertz.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_convergence_study_of_the_page(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "my_study.toml").write_text(blocks("convergence", "toml")[0])
    (code,) = blocks("convergence", "python")
    names: dict[str, Any] = {}
    exec(compile(code, "convergence.md", "exec"), names)
    data = names["study"].data
    assert set(data["status"].values.flat) == {"converged"}
    assert re.fullmatch(r"peak pressure: order \d\.\d ± \d\.\d\n", capsys.readouterr().out)
    exact, penalty = (data.sel(laws=name) for name in ("exact", "paper"))
    assert 1.0 < float(exact["order_approach"]) < 2.6
    assert float(exact["relative_error_approach"][-1]) < 0.08
    shift = (penalty["approach"] - exact["approach"]).isel(surface_size=-1) * 2.0 * 1e15
    peak = penalty["reference_max_pressure"].isel(surface_size=-1)
    assert float((shift / peak).mean()) == pytest.approx(1.0, abs=0.15)  # p0 / (2 K), with the coarse grid's p0^2


def test_the_penalty_study_of_the_page(folder: Path) -> None:
    (folder / "penalty.toml").write_text(blocks("convergence", "toml")[1])
    data = run_study(folder / "penalty.toml")
    assert set(data["status"].values.flat) == {"converged"}
    for name in ("max_pressure", "approach"):
        assert float(data[f"order_{name}"]) == pytest.approx(1.0, abs=0.05)
