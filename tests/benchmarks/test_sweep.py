"""Smoothness and tangents over a sweep, of forces that are known."""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from benchmarks.sweep import EXACT, PANELS, WIDE, Sweep, beyond, rows_beside, smoothness
from wheelrail.contact.kinematics.wheelset_state import WheelsetState
from wheelrail.contact.models.wheelset import WheelsetContact
from wheelrail.support.arrays import Array

STIFFNESS, BEND, TURN = 1e9, 3e14, 0.31e-6  # N/m, N/m2 and m: of the vertical force over y, bent at one place


@dataclass
class BentForce:
    """Vertical force with a bend over y, and its tangent times a factor."""

    factor: float = 1.0

    def __call__(self, state: WheelsetState, side: str, guess: object = None) -> SimpleNamespace:
        past = max(state.y - TURN, 0.0)
        return SimpleNamespace(
            ok=True, force=np.array([0, 0, STIFFNESS * state.y + BEND * past**2]), moment=np.zeros(3)
        )

    def tangent(self, state: WheelsetState, side: str, result: object) -> Array:
        slopes = np.zeros((6, len(state.coordinates)))
        slopes[2, state.coordinates.index("y")] = self.factor * (STIFFNESS + 2 * BEND * max(state.y - TURN, 0.0))
        return slopes


def tangent_errors(factor: float) -> list[Any]:
    contact = BentForce(factor)
    state = WheelsetState()
    errors = Sweep(cast(WheelsetContact, contact), 0.0).tangent_errors(0.0, state, cast(Any, contact(state, "left")))
    return [error for error in errors if error.coordinate == "y"]


def test_an_exact_tangent_with_a_bend() -> None:
    """Four places are enough without the bend, more are needed across it."""
    errors = tangent_errors(1.0)
    assert [error.change for error in errors] == [-2e-7, 2e-7, -2e-6, 2e-6]
    assert max(error.error for error in errors) < EXACT
    assert [error.panels > PANELS[0] for error in errors] == [False, False, False, True]


def test_a_wrong_tangent_is_noticed() -> None:
    errors = tangent_errors(1.001)
    assert all(error.error > 5e-4 and error.panels == PANELS[-1] for error in errors)


def test_a_kink_is_more_than_the_curvature_nearby() -> None:
    y = np.arange(8 * WIDE) / WIDE
    smooth = np.tile(1e-3 * y[:, None] ** 2, 6)
    _, curvature, ratio = smoothness(smooth)
    assert np.nanmax(ratio) < 1 / 3
    assert curvature[len(y) // 2, 0] == pytest.approx(2e-3 / WIDE**2)
    bent = smooth + 4e-3 * np.maximum(y - y[4 * WIDE], 0)[:, None]
    second, _, ratio = smoothness(bent)
    assert beyond(ratio) == [(4 * WIDE, 4 * WIDE)]
    assert second[4 * WIDE, 0] == pytest.approx(4e-3 / WIDE + 2e-3 / WIDE**2)


def test_rows_of_another_version(tmp_path: Path) -> None:
    file = tmp_path / "other.json"
    file.write_text(json.dumps({"columns": ["y", "patches", "Fx", "Fy", "Fz"], "rows": [[0.001, 2, 3.0, 4.0, 5.0]]}))
    np.testing.assert_array_equal(rows_beside(str(file)), [[0.001, 3.0, 4.0]])


@pytest.mark.parametrize("text", ["{", "[]", '{"columns": ["y", "Fx"], "rows": []}', None])
def test_a_file_that_is_no_sweep(tmp_path: Path, text: str | None) -> None:
    """An error before the sweep that names the file."""
    file = tmp_path / "other.json"
    if text is not None:
        file.write_text(text)
    with pytest.raises(argparse.ArgumentTypeError, match=r"other\.json is not the --json file of a sweep"):
        rows_beside(str(file))
