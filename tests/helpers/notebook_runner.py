"""Notebooks executed at a reduced size."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from study_workers import Here

from wheelrail.scenes.studies import run

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"
ALL = sorted(NOTEBOOKS.glob("*.py"))
VIEW = '"view"'  # tag


def cells(notebook: Path) -> Iterator[tuple[str, str]]:
    """Heading line and code of each code cell of a py:percent file."""
    text = notebook.read_text(encoding="utf-8")
    for part in ("\n" + text).split("\n# %%")[1:]:
        heading, _, body = part.partition("\n")
        if "[markdown]" not in heading:
            yield heading, body


def view_cell() -> str:
    """Code of the one cell that shows an interactive 3D view, which needs a process of its own."""
    (code,) = (body for notebook in ALL for heading, body in cells(notebook) if VIEW in heading)
    return code


def executed(name: str, **parameters: Any) -> dict[str, Any]:
    """Final namespace of a notebook whose tagged parameters cell is replaced. Studies work in this process. All
    figures must label their axes with units; figures are closed.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    notebook = NOTEBOOKS / name
    names: dict[str, Any] = {"__name__": notebook.stem}
    replaced = False
    pyplot.close("all")  # of other tests in this process
    try:
        with matplotlib.rc_context(), pytest.MonkeyPatch.context() as patched:
            patched.setattr(run, "processes", lambda count: Here())
            for heading, body in cells(notebook):
                if VIEW in heading:
                    continue
                exec(compile(body, f"{notebook.name}{heading}", "exec"), names)
                if '"parameters"' in heading:
                    assert parameters.keys() <= names.keys()
                    names |= parameters
                    replaced = True
            figures = [pyplot.figure(number) for number in pyplot.get_fignums()]
            for figure in figures:
                figure.draw_without_rendering()
    finally:
        pyplot.close("all")
    assert replaced
    assert figures, f"{name} has no picture"
    for ax in (ax for figure in figures for ax in figure.axes if ax.axison):
        if ax.get_label() != "<colorbar>":
            alike = ax.get_shared_x_axes().get_siblings(ax)
            assert any("[" in other.get_xlabel() for other in alike), (name, ax.get_title(), ax.get_xlabel())
        assert any(other.get_ylabel() for other in ax.get_shared_y_axes().get_siblings(ax)), (name, ax.get_title())
    return names
