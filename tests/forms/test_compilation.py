"""Compilation of forms while other processes compile, and after some that were stopped."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPT = """
import sys, time
import numpy as np, ufl
from mpi4py import MPI
import ffcx.codegeneration.jit as jit
from wheelrail.forms import compat
from wheelrail.forms.compilation import compiled

slowly = jit._compile_objects
def patient(*given, **named):
    print("compiles", flush=True)
    time.sleep(float(sys.argv[1]))
    return slowly(*given, **named)
points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
space = compat.space(compat.mesh_from_arrays(MPI.COMM_SELF, "triangle", np.array([[0, 1, 2]]), points), 1, 1)
print("begins", flush=True)
jit._compile_objects = patient
u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
_, _, values = compat.assemble_csr(compiled(7.5 * ufl.inner(u, v) * ufl.dx))
print(f"{values.sum():.6g}", flush=True)
"""


def started(folder: Path, wait: float) -> subprocess.Popen[str]:
    """A process that compiles a form, s slower than it could."""
    env = {**os.environ, "XDG_CACHE_HOME": str(folder), "WHEELRAIL_CACHE": str(folder / "own")}
    return subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(wait)], cwd=ROOT, env=env, stdout=subprocess.PIPE, text=True
    )


def lines(process: subprocess.Popen[str]) -> list[str]:
    return process.communicate(timeout=120)[0].split()


def until(process: subprocess.Popen[str], text: str) -> None:
    """Wait for a line of a process."""
    assert process.stdout is not None
    while (line := process.stdout.readline()) and text not in line:
        pass
    assert line, f"{text}: not printed"


@pytest.mark.parametrize("stop", [signal.SIGKILL, signal.SIGINT])
def test_a_form_whose_compilation_was_stopped_is_compiled(stop: signal.Signals, tmp_path: Path) -> None:
    stopped = started(tmp_path, 60.0)
    until(stopped, "compiles")
    stopped.send_signal(stop)
    stopped.communicate(timeout=60)
    assert lines(started(tmp_path, 0.0)) == ["begins", "compiles", "3.75"]
    assert lines(started(tmp_path, 0.0)) == ["begins", "3.75"]  # what was compiled stays


def test_a_process_waits_for_another_one_that_compiles_for_long(tmp_path: Path) -> None:
    first = started(tmp_path, 13.0)  # s; FFCx waits for 10
    until(first, "compiles")
    assert lines(started(tmp_path, 0.0)) == ["begins", "3.75"]
    assert lines(first) == ["3.75"]
