"""Each extra alone brings along what its part of the program imports: processes that see nothing else do the work."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

VIEW = """
from wheelrail.scenes.views.html import save_view
from wheelrail.scenes.views.plotter import plotter, pyvista
from pathlib import Path
import ipywidgets
view = plotter(size=(160, 120), off_screen=True)
view.add_mesh(pyvista().Sphere())
save_view(view, Path("view.html"))
save_view(view, Path("view.png"))
for film in (lambda: view.open_movie("view.mp4", framerate=5), lambda: view.open_gif("view.gif", fps=5)):
    film()
    view.write_frame()
    view.mwriter.close()
assert all(Path(f"view.{ending}").stat().st_size > 100 for ending in ("html", "png", "mp4", "gif"))
"""
CLUSTER = """
from wheelrail.scenes.studies.workers import cluster
from distributed import Client, LocalCluster
with LocalCluster(n_workers=1, processes=False, dashboard_address=None) as local, Client(local) as client:
    assert client.submit(sum, [1, 2]).result() == 3
"""
NOTEBOOK = """
import jupytext, nbformat, nbclient
from jupyterlab.labapp import LabApp
book = jupytext.reads("# %%\\nprint(6 * 7)\\n", "py:percent")
nbclient.NotebookClient(book, timeout=60, kernel_name="python3").execute()
assert book.cells[0].outputs[0]["text"] == "42\\n"
"""
EXPORT = """
from pathlib import Path
from wheelrail.export.library import export_library
assert "libwheelrail.so" in {file.name for file in Path(export_library(Path("library"), None)).parent.iterdir()}
"""
DOCS = f"""
import importlib, sys
sys.path.insert(0, {str(ROOT / "docs")!r})
import conf, jupytext
from sphinx.application import Sphinx
Path = conf.Path
Path("site").mkdir()
Path("site/index.md").write_text("# title\\n")
app = Sphinx("site", {str(ROOT / "docs")!r}, "out", "doctrees", "dummy", freshenv=True, status=None,
             confoverrides={{"nb_execution_mode": "off"}})
"""
BASE = """
import importlib, pkgutil
import wheelrail
names = [found.name for found in pkgutil.walk_packages(wheelrail.__path__, "wheelrail.")]
assert len(names) > 300
for name in names:
    if not name.endswith("__main__"):
        importlib.import_module(name)
"""


def done_with(extras: tuple[str, ...], script: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """End of a process that sees the dependencies of the extras alone."""
    paths = os.pathsep.join([str(ROOT), str(ROOT / "tests/helpers")])
    return subprocess.run(
        [sys.executable, "-c", f"from only_extra import only; only(*{extras})\n{script}"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


@pytest.mark.parametrize(
    ("extras", "script"),
    [
        ((), BASE),
        (("view",), VIEW),
        (("cluster",), CLUSTER),
        (("notebook",), NOTEBOOK),
        (("export",), EXPORT),
        (("docs",), DOCS),
    ],
    ids=["none", "view", "cluster", "notebook", "export", "docs"],
)
def test_an_extra_alone_suffices(extras: tuple[str, ...], script: str, tmp_path: Path) -> None:
    done = done_with(extras, script, tmp_path)
    assert done.returncode == 0, done.stderr[-3000:]


def test_packages_of_other_extras_are_hidden(tmp_path: Path) -> None:
    """The tests above can fail."""
    done = done_with(("export",), "import pyvista", tmp_path)
    assert "No module named 'pyvista'" in done.stderr


def test_a_missing_extra_is_one_line(tmp_path: Path) -> None:
    """Before anything is solved."""
    view = """
import sys
from wheelrail.cli.entry import main
from wheelrail.scenes.example_scenes import example
open("scene.toml", "w").write(example("hertz"))
sys.argv = ["wheelrail", "view", "scene.toml", "--out", "view.png"]
main()
"""
    done = done_with((), view, tmp_path)
    assert (done.returncode, done.stderr) == (1, '3D views need pyvista: pip install "wheelrail[view]"\n')


def test_exploring_without_its_extra_is_one_line(tmp_path: Path) -> None:
    explore = "import sys; from wheelrail.cli.entry import main; sys.argv = ['wheelrail', 'explore']; main()"
    done = done_with((), explore, tmp_path)
    message = 'explore needs trame and trame_vuetify: pip install "wheelrail[view]"\n'
    assert (done.returncode, done.stderr) == (1, message)
