"""Notebooks 01 to 04 at a reduced size, and their conversion by Jupyter."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from notebook_runner import ALL, NOTEBOOKS, executed

REDUCED: dict[str, dict[str, Any]] = {
    "01_profiles_and_contact_geometry.py": {
        "POSITIONS": 161,
        "ELASTIC": {"surface_size": 3e-3, "strips": 6, "cells": 8},
    },
    "02_hertz_and_mesh_convergence.py": {
        "STRIPS": (6, 11, 22),
        "GRIDS": (1.6e-3, 0.8e-3),
        "LOADS": (10e3, 20e3),
        "DEPTHS": (0.24, 0.48, 0.8),
    },
    "03_full_condensed_waveguide.py": {
        "FRICTIONS": (0.0,),
        "SIZE": 2.4e-3,
        "HALVED_SOLIDS": 0,
        "HALVED_GRIDS": 1,
        "LATTICES": ((8, 6), (16, 10)),
        "FINEST": (16, 16),
    },
    "04_rolling_creepage_stick_slip.py": {"EVERY": 4, "CELLS": {"strips": 12, "cells": 16}},
}


def check_geometry(names: dict[str, Any]) -> None:
    """The wave that was integrated is Klingel's; both wheels mirror each other."""
    assert 2 * names["half"] == pytest.approx(names["klingel"], rel=0.01)
    assert names["conicity"] == pytest.approx(0.177, abs=0.002)
    left, right = (names["geometry"].sel(side=side).rolling_radius.values for side in ("left", "right"))
    np.testing.assert_allclose(left, right[::-1], atol=1e-9)


def check_hertz(names: dict[str, Any]) -> None:
    """Hertz's circle of 10 kN, and what is below it."""
    assert names["exact"].peak == pytest.approx(659.0e6, rel=1e-3)
    assert abs(names["peak"]) < 0.005
    assert names["order"] == pytest.approx(1.0, abs=0.3)  # scatters with the place of the outer strips
    assert np.mean(names["kappa"]) == pytest.approx(0.40, abs=0.015)
    assert names["mises"].max() == pytest.approx(0.62, abs=0.005)


def check_ways(names: dict[str, Any]) -> None:
    """All ways to the force are within what a coarse mesh allows of Hertz's load."""
    force = names["comparison"]["normal force [N]"].astype(float)
    assert np.abs(force / 10e3 - 1).max() < 0.15
    assert force["full", 0.0] == pytest.approx(force["condensed", 0.0], rel=1e-9)


def check_rolling(names: dict[str, Any]) -> None:
    """CONTACT's creep forces on the circle, Kalker's coefficients on three ellipses."""
    assert np.abs(names["error"]["finite elements"]).max() < 0.012
    assert np.abs(names["deviation"]).max() < 0.02
    assert [round(ratio, 2) for ratio in names["measured"]] == [0.5, 1.0, 2.0]


CHECKS = (check_geometry, check_hertz, check_ways, check_rolling)


@pytest.mark.parametrize(("name", "check"), list(zip(REDUCED, CHECKS, strict=True)), ids=[name[:2] for name in REDUCED])
def test_notebook_reduced(name: str, check: Any) -> None:
    check(executed(name, **REDUCED[name]))


@pytest.mark.parametrize("notebook", ALL, ids=lambda path: path.stem[:2])
def test_notebook_pairs(notebook: Any) -> None:
    """Conversion to .ipynb and back is lossless; pairing and the tag of the parameters cell are in the metadata."""
    import jupytext
    import nbformat

    read = jupytext.read(notebook)
    text = nbformat.writes(read)
    again = nbformat.reads(text, as_version=4)
    nbformat.validate(again)
    assert again.metadata.jupytext.formats == "ipynb,py:percent"
    assert sum("parameters" in cell.metadata.get("tags", []) for cell in again.cells) == 1

    def body(script: str) -> str:
        return script.split("# ---\n", 2)[2]

    assert body(jupytext.writes(again, "py:percent")) == body(notebook.read_text(encoding="utf-8"))


def test_make_notebooks(tmp_path: Path) -> None:
    """The commands of the Makefile: notebooks beside the text files, and JupyterLab there."""
    done = subprocess.run(
        ["make", "-n", "-o", "V/ready-for-notebooks", "VENV=V", f"PY={sys.executable}", "LAB=--version", "notebooks"],
        cwd=NOTEBOOKS.parent,
        capture_output=True,
        text=True,
        check=True,
    )
    convert, serve = (line for line in done.stdout.splitlines() if line.startswith(sys.executable))
    (tmp_path / "notebooks").mkdir()
    for file in ALL[:2]:
        shutil.copy(file, tmp_path / "notebooks")
    subprocess.run(convert, shell=True, cwd=tmp_path, check=True, timeout=60)
    names = {file.name for file in (tmp_path / "notebooks").glob("*.ipynb")}
    assert names == {file.with_suffix(".ipynb").name for file in ALL[:2]}
    served = subprocess.run(serve, shell=True, cwd=tmp_path, check=True, timeout=60, capture_output=True, text=True)
    assert re.fullmatch(r"\d+\.\d+\.\d+\n", served.stdout)
    assert "--notebook-dir=notebooks" in serve


def executed_by_jupyter(notebook: Any, monkeypatch: pytest.MonkeyPatch, timeout: int = 120) -> list[list[Any]]:
    """Displayed data of every code cell, with the inline backend of Jupyter."""
    import nbclient

    root = str(NOTEBOOKS.parent)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([root, os.environ.get("PYTHONPATH", "")]).rstrip(os.pathsep))
    monkeypatch.delenv("MPLBACKEND", raising=False)
    nbclient.NotebookClient(
        notebook, timeout=timeout, kernel_name="python3", resources={"metadata": {"path": str(NOTEBOOKS)}}
    ).execute()
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    return [[output.data for output in cell.outputs if "data" in output] for cell in code]


def images(displayed: list[Any]) -> int:
    return sum("image/png" in data for data in displayed)


FIGURES = """import wheelrail as wr
solution = wr.Hertz(upper=(0.46, 0.3), lower=(0.5, 0.3), friction=0.3, model="standard").solve(
    load=10e3, speed=10.0, creepage=(1e-3, 0.0, 0.0))
# %%
solution.plot()
# %%
ax = solution.plot.pressure()
bx = solution.plot.section()
# %%
wr.plot_convergence([1e-3, 2e-3], {"peak": [1e-3, 4e-3]})
# %%
import matplotlib.pyplot as plt
plt.plot([0, 1])
# %%
solution.plot.tractions(ax=plt.subplots()[1])
# %%
plt.figure().add_subplot()
second = plt.figure()
solution.plot(figure=second)
"""
TABLE = "solution.patches"


def test_cells_display_their_figures_and_tables_in_jupyter(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first figure of a session comes from this package; later ones, the user's own included, are displayed too."""
    from nbformat.v4 import new_code_cell, new_notebook

    cells = [new_code_cell(source) for source in [*FIGURES.split("# %%\n"), TABLE]]
    *figures, table = executed_by_jupyter(new_notebook(cells=cells), monkeypatch)
    assert [*map(images, figures)] == [0, 1, 2, 1, 1, 1, 2]
    assert any("<table" in data.get("text/html", "") for data in table)


def test_style_leaves_other_parameters_alone() -> None:
    import matplotlib

    from wheelrail.scenes.plots.style import STYLE, styled

    with matplotlib.rc_context({"interactive": False, "font.size": 11.0}):
        with styled({"svg.hashsalt": "a"}):
            assert matplotlib.rcParams["font.size"] == STYLE["font.size"]
            assert matplotlib.rcParams["svg.hashsalt"] == "a"
            matplotlib.rcParams["interactive"] = True
        assert matplotlib.rcParams["interactive"]
        assert matplotlib.rcParams["font.size"] == 11.0
        assert matplotlib.rcParams["svg.hashsalt"] is None
