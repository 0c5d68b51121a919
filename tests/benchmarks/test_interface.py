"""Cost of the interfaces of a contact element, at a reduced size."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from benchmarks.interface import PAIR, REFUSED, in_c, in_python, loaded
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
