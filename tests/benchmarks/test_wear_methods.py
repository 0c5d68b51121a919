"""Wear by contact methods: tables and picture of one short step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.wear.methods import draw, new_table, sections, worn, worn_table


def test_tables_and_picture_of_the_standard_contact(tmp_path: Path) -> None:
    """T-gamma on new wheels is that on the page of the documentation; the section is that of USFD's mild branch."""
    data = {"standard": worn("standard", 1e4, 1e-4)}
    assert "| standard | 2.7, 1.1 | 26.9, 11.3 | 47.2, 19.7 |" in new_table(data)
    assert worn_table(data).count("\n") == 2
    t_gamma = data["standard"]["t_gamma"].values[0, 0]
    mild = 0.18 * 5.3e-9 / 7850.0 * t_gamma / (2.0 * np.pi * 0.46)  # m2 per m
    assert sections(data["standard"])[0] == pytest.approx(mild, rel=0.02)
    draw(data, tmp_path / "methods.png")
    assert (tmp_path / "methods.png").stat().st_size > 10_000
