"""The scaling benchmark: fits of synthetic data, products by FFT against dense ones, and a complete run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.common.measurement import Row
from benchmarks.common.measurement_tables import POINT_COLUMNS, exponents, table
from benchmarks.common.power_law import crossover, power
from benchmarks.scaling import plan as scaling_plan
from benchmarks.scaling.figure import draw
from benchmarks.scaling.isolated import rows
from benchmarks.scaling.lower_bounds import AlongX, OverPlane
from benchmarks.scaling.report import measured
from wheelrail.contact.models.full.two_body_stiffness import rigid_motions


def test_power_law_fit() -> None:
    sizes = [10.0, 20.0, 1e3, 1e2, 5e3, 1e4]  # in any order
    costs = [max(3e-3 * n**1.5, 1.0) for n in sizes]  # a constant overhead at small sizes
    found = power(sizes, costs)
    assert found is not None
    assert found.exponent == pytest.approx(1.5, rel=1e-9)
    assert found.factor == pytest.approx(3e-3, rel=1e-8)
    assert (found.low, found.high, found.count) == (1e3, 1e4, 3)
    assert found.worst < 1e-9
    assert "1.50 (1e+03 to 1e+04, 3 sizes)" in str(found)


def test_deviation_from_a_power_law_is_reported() -> None:
    n = np.geomspace(10, 1e4, 4)
    found = power(list(n), list(n**2 * [1.0, 2.0, 1.0, 2.0]))
    assert found is not None
    assert found.worst > 0.3
    assert power([1.0, 2.0], [1.0, 2.0]) is None
    with pytest.raises(ValueError, match="positive"):
        power([1.0, 2.0, 3.0], [1.0, 0.0, 1.0])


def test_crossovers() -> None:
    n = [10.0, 100.0, 1000.0]
    squares, cubes = [x**2 for x in n], [x**3 / 50 for x in n]
    assert crossover(n, cubes, squares) == "50"
    assert crossover(n, squares, [x / 2 for x in squares]) == "below 10"
    assert crossover(n, squares, [2 * x for x in squares]).startswith("above 1000 (2 times")
    assert crossover([], [], []) == "not measured"


def test_products_by_fft_are_those_of_the_dense_matrix() -> None:
    random = np.random.default_rng(1)
    nx, ny, c = 5, 4, 2
    row = np.arange(nx)
    kernel = random.standard_normal((2 * nx - 1, ny * c, ny * c))
    between = row[:, None] - row + nx - 1
    field = random.standard_normal((nx, ny * c))
    np.testing.assert_allclose(AlongX(kernel) @ field, np.einsum("xzab,zb->xa", kernel[between], field), rtol=1e-12)
    flat = random.standard_normal((nx, ny, c))
    surface = random.standard_normal((2 * nx - 1, 2 * ny - 1, c, c))
    line = np.arange(ny)
    whole = surface[between][:, :, line[:, None] - line + ny - 1]  # (x, x', y, y', c, c)
    np.testing.assert_allclose(OverPlane(surface) @ flat, np.einsum("xzywab,zwb->xya", whole, flat), rtol=1e-12)


def test_rigid_motions_cause_no_strain() -> None:
    points = np.random.default_rng(2).standard_normal((6, 3))
    turned = rigid_motions(points).reshape(6, 3, 6)
    for i in range(6):
        for j in range(i):
            # distances are constant: relative motion is normal to the line between two points
            np.testing.assert_allclose((points[i] - points[j]) @ (turned[i] - turned[j]), 0.0, atol=1e-14)
    assert np.linalg.matrix_rank(turned.reshape(18, 6)) == 6


def test_report_and_figure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(scaling_plan, "QUICK_SIZES", (20,))
    monkeypatch.setattr(scaling_plan, "POINTS", {("lattice", "half-space"): {"normal": 20, "rolling, LU": 20}})
    found = measured(["points"], quick=True)
    normal, creeping = found["points"]
    assert [row["task"] for row in found["points"]] == ["normal", "rolling, LU"]
    assert abs(normal["force error"]) < 2.0  # % at some 20 points
    assert 0 < creeping["creep error"] < 5.0  # % of mu F_n
    assert creeping["memory"] > 0
    assert "| lattice, half-space | normal |" in capsys.readouterr().out
    draw(tmp_path / "scaling.png", found["points"], found["floor"], [], [])
    assert (tmp_path / "scaling.png").stat().st_size > 10_000


def test_a_case_that_fails_is_a_row() -> None:
    (row,) = rows("elastic", {"method": "no such", "across": 3}, seconds=60)
    assert "KeyError" in row["failed"]
    (late,) = rows("floor", {"sizes": [50]}, seconds=0.01)
    assert late["failed"] == "over 0.01 s"


def test_failed_rows_are_shown_but_not_fitted() -> None:
    some: list[Row] = [
        {"family": "f", "task": "normal", "points": n, "seconds": 1e-6 * n**2, "phases": {}} for n in (10, 100, 1000)
    ]
    told = table("T", POINT_COLUMNS, [*some, {"family": "f", "points": 9999, "failed": "over 1 s"}])
    assert "over 1 s" in told
    fitted = exponents("E", {"f": some}, "points", [("time", lambda row: row["seconds"])])
    assert "| f | 2.00 (10 to 1e+03, 3 sizes) |" in fitted
