"""Cost of the interfaces of a contact element, at a reduced size."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from benchmarks.endurance import endure
from benchmarks.interface import LOADED, PAIR, REFUSED, SCENE, in_c, in_python, loaded
from wheelrail.export.library import export_library


def test_times_from_python() -> None:
    times = in_python(200)
    assert times["solve_array, refused input"] < times["solve_array"]
    assert all(0.0 < time < 1e-2 for time in times.values())


def test_times_and_memory_from_c(tmp_path: Path) -> None:
    pytest.importorskip("cffi")
    if shutil.which("cc") is None:
        pytest.skip("no C compiler")
    export_library(tmp_path)
    time, growth = in_c(tmp_path, 2000, json.dumps(PAIR), REFUSED)
    assert 0.0 < time < 1e-2
    assert growth < 1000  # kB over 1800 calls, 0 measured: less than 0.6 kB a call


def test_times_of_loaded_wheels(tmp_path: Path) -> None:
    kind, *numbers = loaded("standard", tmp_path, 200).strip("| ").split(" | ")
    python, native, growth = map(float, numbers)
    assert kind == "standard"
    assert 0.0 < native < 1e5  # us
    assert 0.0 < python < 1e5
    assert growth < 1000


def test_wild_inputs_leave_no_trace(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE.format(LOADED["standard"]), encoding="utf-8")
    first, last = endure(scene, tmp_path / "made", 5000)
    assert (first[0], last[0]) == (1000, 5000)
    assert 4 <= last[2] <= 5  # -0.05 may be a state with forces
    assert last[1] - first[1] < 1000  # kB, 0 to 200 measured
