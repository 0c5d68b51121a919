"""Machine code kept on disk is that of the sources as they are, those of functions that are called included."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
USES = "from meshes.compiled import compiled\n"
OUTER = USES + "from contact.inner import inner\n@compiled\ndef outer(x):\n    return inner(x)\n"
INNER = USES + "@compiled\ndef inner(x):\n    return {} * x\n"


def said(folder: Path) -> str:
    code = (
        "from contact.outer import outer; from numba import config;"
        "print(outer(2.0), sum(outer.stats.cache_hits.values()), repr(config.CACHE_DIR))"
    )
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    environment.pop("NUMBA_CACHE_DIR", None)
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, cwd=folder, capture_output=True, text=True, check=True
    )
    return run.stdout.strip()


def test_a_change_in_a_called_file_is_seen(tmp_path: Path) -> None:
    for package in ("meshes", "contact"):
        (tmp_path / package).mkdir()
        (tmp_path / package / "__init__.py").touch()
    shutil.copy(ROOT / "meshes" / "compiled.py", tmp_path / "meshes")
    (tmp_path / "contact" / "outer.py").write_text(OUTER)
    (tmp_path / "contact" / "inner.py").write_text(INNER.format(3.0))
    assert said(tmp_path) == "6.0 0 ''"
    assert said(tmp_path) == "6.0 1 ''"
    (tmp_path / "contact" / "inner.py").write_text(INNER.format(5.0))
    assert said(tmp_path) == "10.0 0 ''"
    (kept,) = tmp_path.glob("meshes/__pycache__/compiled-*")  # of older sources nothing is left
    assert any(kept.rglob("*.nbc"))
