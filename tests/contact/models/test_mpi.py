"""`full` on two ranks of mpirun against one process: equal results, each rank with a part of both meshes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from two_ranks import solved

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.skipif(shutil.which("mpirun") is None, reason="there is no mpirun")


def mpirun(*command: str) -> subprocess.CompletedProcess[str]:
    """Runs Python on two ranks, on any number of cores."""
    allowed = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    patient = {"OMPI_MCA_mpi_yield_when_idle": "1"}  # a rank that waits gives its core away: others may be at work
    env = {**os.environ, **allowed, **patient, "PYTHONPATH": str(ROOT)}
    start = ["mpirun", "-n", "2", "--oversubscribe", "--bind-to", "none", sys.executable]
    return subprocess.run([*start, *command], capture_output=True, text=True, timeout=300, env=env, cwd=ROOT)


@pytest.fixture(scope="module")
def ranks() -> list[dict[str, Any]]:
    done = mpirun("tests/helpers/two_ranks.py")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert isinstance(found, list)
    return found


@pytest.fixture(scope="module")
def alone() -> dict[str, Any]:
    return solved()


CASES = ("paper", "warm", "exact", "multigrid", "load", "wheel on rail")
# of the largest: two solves that stop at a residual of 1e-9 in other places
TOLERANCE = {"paper": 1e-9, "warm": 1e-9, "exact": 1e-8, "multigrid": 1e-8, "load": 1e-8, "wheel on rail": 1e-9}


@pytest.mark.parametrize("case", CASES)
def test_two_ranks_give_the_result_of_one(case: str, ranks: list[dict[str, Any]], alone: dict[str, Any]) -> None:
    one = alone[case]
    for name in ("force", "moment", "peak", "stick", "pressure", "traction", "moved", "displacement"):
        expected, found = np.array(one[name]), np.array(ranks[0][case][name])
        scale = np.abs(expected).max(initial=0.0)
        if name in ("moment", "traction"):  # all round-off without friction
            scale = max(scale, 1e-3 * abs(one["force"][2] if name == "moment" else one["peak"][0]))
        np.testing.assert_allclose(found, expected, rtol=0, atol=TOLERANCE[case] * scale, err_msg=name)
    assert one["force"][2] > 1e3
    assert len(one["peak"]) == 1


@pytest.mark.parametrize("case", CASES)
def test_ranks_agree_and_own_half_of_each_body(case: str, ranks: list[dict[str, Any]], alone: dict[str, Any]) -> None:
    first, second = (rank[case] for rank in ranks)
    assert {k: v for k, v in first.items() if k != "owned"} == {k: v for k, v in second.items() if k != "owned"}
    for mine, other, whole in zip(first["owned"], second["owned"], alone[case]["owned"], strict=True):
        assert mine + other == whole
        assert min(mine, other) > 0.4 * whole


def test_each_rank_starts_from_its_own_part_of_a_guess(ranks: list[dict[str, Any]]) -> None:
    assert ranks[0]["paper"]["newton"] >= 5
    assert ranks[0]["warm"]["newton"] <= 1


def test_an_error_on_one_rank_ends_the_other() -> None:
    done = mpirun("tests/helpers/two_ranks.py", "stumble")  # within the time limit
    assert done.returncode != 0
    assert "MemoryError: out of memory on one rank" in done.stderr


def test_command_rejects_models_that_are_not_distributed() -> None:
    done = mpirun("-m", "wheelrail.cli", "contact", "scenes/hertz.toml", "--json")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.count('model = "condensed"') == 1
    assert "Traceback" not in done.stderr


def test_command_prints_on_the_first_rank_only(tmp_path: Path) -> None:
    scene = tmp_path / "full.toml"
    body = "radii = [0.3, 0.3]\nE = 210e9\nnu = 0.3\n"
    scene.write_text(
        'kind = "hertz"\nmodel = "full"\nlaws = "paper"\nfriction = 0.0\napproach = 15e-6\nsurface_size = 6e-3\n'
        f"[upper]\n{body}[lower]\n{body}"
    )
    done = mpirun("-m", "wheelrail.cli", "contact", str(scene), "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["status"] == "converged"
    assert done.stdout.count("\n") == 1
