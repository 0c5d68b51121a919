"""The compiled core: equations in NumPy at random states, and builds for different processors."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from random_states import KINDS, differences

import wheelrail.bindings._vehicle as core
from wheelrail import bindings

HELPERS = Path(__file__).parents[1] / "helpers"
RIGHT: dict[str, Any] = {
    "track": core.Track([0.0], [[[0.0] * 10]], 1.5, [0.0], [2.0]),
    "bodies": [core.Body(0.0, 0.5, 1e3, (1e3, 1e3, 1e3), False, [False] * 6)] * 2,
    "laws": [core.Law(True, [0.0, 1.0], [0.0, 1.0])],
    "elements": [],
    "pairs": [],
    "springs": [],
    "torques": [],
    "forces": [],
    "radius": 0.46,
    "gravity": 9.81,
    "release": 0.1,
    "kept": -1,
    "hold": (0.0, 0.0),
    "internal": 1,
}
ONE, NONE = core.Table(False, [0.0], [1.0]), core.Table(False, [], [])


def element(
    upper: int = 0,
    lower: int = 1,
    spring_law: int = -1,
    damper_law: int = -1,
    series: int = -1,
    slider: int = -1,
    flow: int = -1,
) -> Any:
    friction, surge = core.Friction(slider, 1.0, 1.0, 0.0), core.Surge(flow, 1.0, 1.0)
    direction = core.Direction(1.0, 1.0, spring_law, damper_law, series, 1.0, friction, surge)
    return core.Element(upper, lower, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0, 0.0, [direction] * 3)


WRONG: list[dict[str, Any]] = [
    {"bodies": []},
    {"kept": 2},
    {"elements": [element(upper=2)]},
    {"elements": [element(lower=-1)]},
    {"elements": [element(spring_law=1)]},
    {"elements": [element(damper_law=-2)]},
    {"elements": [element(series=1)]},
    {"elements": [element(slider=1)]},
    {"elements": [element(flow=1, series=0)]},
    {"elements": [element(flow=0)]},
    {"elements": [element()], "pairs": [[1, -1]]},
    {"elements": [element()], "pairs": [[0, 1]]},
    {"springs": [core.RotationalSpring(0, 2, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0))]},
    {"torques": [core.Torque(2, 0, False, ONE)]},
    {"torques": [core.Torque(1, 0, False, NONE)]},
    {"forces": [core.Force(0, (0.0, 0.0, 0.0), [ONE, NONE, ONE])]},
    {"laws": [core.Law(True, [0.0], [0.0])]},
    {"track": core.Track([0.0, 1.0], [[[0.0] * 10]], 1.5, [0.0], [2.0])},
    {"track": core.Track([0.0], [[]], 1.5, [0.0], [2.0])},
]


@pytest.mark.parametrize("wrong", WRONG, ids=lambda wrong: " ".join(wrong))
def test_indices_beyond_arrays_are_rejected(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="an index or a length does not fit"):
        core.Vehicle(**RIGHT | wrong)


def test_arrays_of_another_length_are_rejected() -> None:
    vehicle = core.Vehicle(**RIGHT | {"elements": [element(spring_law=0, series=0)], "pairs": [[0, -1]]})
    state, contacts = np.zeros(25), np.zeros((2, 2, 3))
    at = vehicle.sections(0.0, state)
    assert vehicle.accelerations((0.0, 10.0, 0.0, 0.0), state, at, contacts)[2] == -9.81
    for name, arrays in {
        "state": (state[:-1], at, contacts),
        "sections": (state, at[:1], contacts),
        "contacts": (state, at, contacts[:1]),
    }.items():
        with pytest.raises(ValueError, match=f"{name}: must have"):
            vehicle.accelerations((0.0, 10.0, 0.0, 0.0), *arrays)


@pytest.mark.parametrize("kind", KINDS)
def test_random_states_are_those_of_the_equations_in_numpy(kind: str) -> None:
    """2000 states; deflections are differences of positions of up to 50 m."""
    found = differences(kind, 2000)
    assert max(found.rates, found.reactions) < 1e-12
    assert found.beyond < 1e-13


def digest(build: Path, script: str, what: str) -> str:
    environment = os.environ | {"WHEELRAIL_CORE": str(build), "PYTHONPATH": str(bindings.HERE.parent.parent)}
    command = [sys.executable, HELPERS / script, *what.split()]
    return subprocess.run(command, env=environment, check=True, capture_output=True, text=True, timeout=120).stdout


@pytest.mark.parametrize(("script", "what"), [("random_states.py", "digest"), ("contact_poses.py", "24 9")])
def test_builds_for_different_processors_give_the_same_bits(script: str, what: str) -> None:
    if not list((bindings.HERE / "baseline").glob("_contact*")) or bindings.build().name == "baseline":
        pytest.skip("one build only; `make builds` makes others")
    assert digest(bindings.HERE / "baseline", script, what) == digest(bindings.build(), script, what)
