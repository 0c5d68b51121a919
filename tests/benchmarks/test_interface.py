"""Cost of the interfaces of a contact element, at a reduced size."""

from __future__ import annotations

import shutil

import pytest

from benchmarks.interface import in_c, in_python


def test_times_from_python() -> None:
    times = in_python(200)
    assert times["solve_array, refused input"] < times["solve_array"]
    assert all(0.0 < time < 1e-2 for time in times.values())


def test_times_and_memory_from_c() -> None:
    pytest.importorskip("cffi")
    if shutil.which("cc") is None:
        pytest.skip("no C compiler")
    time, growth = in_c(2000)
    assert 0.0 < time < 1e-2
    assert growth < 1000  # kB over 1800 calls, 0 measured: less than 0.6 kB a call
