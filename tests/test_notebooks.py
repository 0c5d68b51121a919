"""Every notebook runs from top to bottom, at a reduced size, and its numbers hold."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

NOTEBOOKS = Path(__file__).parents[1] / "notebooks"


def cells(notebook: Path) -> Iterator[tuple[str, str]]:
    """Heading line and code of each code cell of a py:percent file."""
    text = notebook.read_text(encoding="utf-8")
    for part in ("\n" + text).split("\n# %%")[1:]:
        heading, _, body = part.partition("\n")
        if "[markdown]" not in heading:
            yield heading, body


def executed(notebook: Path, **parameters: Any) -> dict[str, Any]:
    """Names that a notebook ends with; the parameters replace those of its cell with that tag."""
    names: dict[str, Any] = {"__name__": notebook.stem}
    replaced = False
    for heading, body in cells(notebook):
        exec(compile(body, f"{notebook.name}{heading}", "exec"), names)
        if '"parameters"' in heading:
            assert parameters.keys() <= names.keys()
            names |= parameters
            replaced = True
    assert replaced
    return names


@pytest.fixture(autouse=True)
def own_cache(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A cache of its own, unless the session has set one up."""
    import os

    if "WHEELRAIL_CACHE" not in os.environ:
        monkeypatch.setenv("WHEELRAIL_CACHE", str(tmp_path / "cache"))


def test_first_contact(tmp_path: Path) -> None:
    import matplotlib

    matplotlib.use("Agg")
    names = executed(
        NOTEBOOKS / "first_contact.py",
        SIZES=(1.8e-3, 1.2e-3, 0.8e-3),
        ROLLING_SIZE=1.2e-3,
        CREEPAGES=(0.3e-3, 1e-3, 4e-3),
    )
    errors = np.abs(names["peak_error"])
    assert errors[-1] < 0.03
    assert errors[-1] < 0.5 * errors[0]
    along = -names["creep_force"] / 3e3
    assert np.all(np.diff(along) > 0)
    assert along[-1] == pytest.approx(1.0, abs=1e-6)  # all slips
    for number, figure in enumerate((names["figure"], names["rolling_figure"])):
        figure.savefig(tmp_path / f"{number}.png")
        assert (tmp_path / f"{number}.png").stat().st_size > 10_000
        assert all(ax.get_xlabel() and ax.get_ylabel() for ax in names["panels"])
    matplotlib.pyplot.close("all")
