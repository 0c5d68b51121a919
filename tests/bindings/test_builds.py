"""The compiled core: equations in NumPy at random states, and builds for different processors."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from random_states import KINDS, differences

import wheelrail.bindings as core

HELPERS = Path(__file__).parents[1] / "helpers"


@pytest.mark.parametrize("kind", KINDS)
def test_random_states_are_those_of_the_equations_in_numpy(kind: str) -> None:
    """2000 states; deflections are differences of positions of up to 50 m."""
    found = differences(kind, 2000)
    assert max(found.rates, found.reactions) < 1e-12
    assert found.beyond < 1e-13


def digest(build: Path) -> str:
    environment = os.environ | {"WHEELRAIL_CORE": str(build), "PYTHONPATH": str(core.HERE.parent.parent)}
    command = [sys.executable, HELPERS / "random_states.py", "digest"]
    return subprocess.run(command, env=environment, check=True, capture_output=True, text=True, timeout=120).stdout


def test_builds_for_different_processors_give_the_same_bits() -> None:
    if core.build().name == "baseline":
        pytest.skip("a processor with one build only")
    assert digest(core.HERE / "baseline") == digest(core.build())
