"""The benchmark of error over time: CONTACT's rows, the extrapolated reference, small models, table and figure."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from benchmarks.error_vs_time import plan as error_plan
from benchmarks.error_vs_time import report as error_vs_time
from benchmarks.error_vs_time import wheel_on_rail
from benchmarks.error_vs_time.cases import ModelVariant, TimedCase, creep_cases, timing_case
from benchmarks.error_vs_time.figure import STYLES, wheel_panel
from benchmarks.error_vs_time.measure import normal_row, rolling_row
from benchmarks.error_vs_time.plan import rows
from benchmarks.error_vs_time.reference import Reference, contact_rows, extrapolated, long_cell_rows
from benchmarks.error_vs_time.sampled import sampled_cases
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.lattice.resolution import LatticeResolution

SMALL = ModelVariant("lattice, half-space", "half-space", LatticeResolution(6, 8))


@cache
def coarse() -> Reference:
    """Extrapolated from 24 x 24 and 12 x 12: the ellipse that is timed and one case per ratio of semi-axes."""
    return extrapolated(LatticeResolution(24, 24), creep_cases(44), lambda _: None)


def test_timed_ellipse_is_that_of_contact() -> None:
    case = timing_case()
    np.testing.assert_allclose(case.pair.exact.semi_axes, (6e-3, 5e-3), rtol=1e-7)
    assert case.pair.exact.approach == pytest.approx(7.4854e-5, rel=2e-5)  # CONTACT, dx 0.1 mm
    # extrapolation of first order in dx from the two finest grids
    np.testing.assert_allclose(
        np.array(case.contact_forces) * case.bound, (2 * 7309.03 - 7337.52, -2 * 5502.27 + 5527.89), rtol=1e-5
    )


def test_the_reference_agrees_with_contact() -> None:
    found = coarse()
    assert found.order > 1.0
    assert np.abs(found.contact_deviations).max() < 2e-3  # of mu F_n; CONTACT's own uncertainty is up to 1.8e-3
    assert f"order {found.order:.2f}" in found.description()


def test_an_extrapolation_needs_convergence(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = iter([0.0, 1.0, 2.0])  # differences that do not decrease
    monkeypatch.setattr(TimedCase, "solved", lambda *_: None)
    monkeypatch.setattr(TimedCase, "forces", lambda *_: np.full(2, next(steps)))
    monkeypatch.setattr(ModelVariant, "loaded_depth", lambda *_: 0.0)
    with pytest.raises(RuntimeError, match="do not converge"):
        extrapolated(LatticeResolution(24, 32), (), lambda _: None)


@pytest.mark.parametrize("finest", [(24, 18), (32, 20)])
def test_cells_of_a_reference_can_be_halved_twice(finest: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match="must be"):
        extrapolated(LatticeResolution(*finest), (), lambda _: None)


def test_errors_of_contact_are_those_of_its_grids() -> None:
    every = contact_rows(np.array(timing_case().contact_forces))
    found = {task: [row for row in every if row["task"] == task] for task in ("normal", "rolling")}
    creep = [row["creep error"] for row in sorted(found["rolling"], key=lambda row: int(row["points"]))]
    np.testing.assert_allclose(creep, (0.9, 0.8, 0.4, 0.3, 0.15), atol=0.03)  # % of mu F_n
    assert [row["points"] for row in found["normal"]] == [99, 385, 1529, 2383, 9473]
    assert found["normal"][0]["area error"] == pytest.approx(100 * (99 / (30 * np.pi) - 1), rel=1e-6)


def test_long_cells_are_contacts_fair_settings() -> None:
    cold, warm = ({r["division"]: r for r in long_cell_rows() if ("warm" in r["family"]) == w} for w in (False, True))
    fair, square = cold["100 x 20"], max(contact_rows(np.zeros(2)), key=lambda row: float(row["median"]))
    assert fair["sampled RMS"] == pytest.approx(0.148)  # % of mu F_n
    assert fair["median"] == pytest.approx(0.18)  # s
    assert fair["median"] < square["median"] / 50  # the square grid of equal error: 0.15 %
    assert warm["100 x 20"]["median"] == pytest.approx(0.09)


def test_one_wheel_with_one_and_two_patches_stands_beside_contact(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wheel_on_rail, "REPEATS", 1)
    monkeypatch.setattr(wheel_on_rail, "FINENESSES", ((8, 10), (14, 12)))
    monkeypatch.setattr(wheel_on_rail, "FINEST", (20, 14))
    strips, contact = list(wheel_on_rail.strip_rows()), list(wheel_on_rail.contact_rows())
    cases = [(80, 1), (70, 2), (25, 2)]
    assert [(row["load"], row["patches"], row["division"]) for row in strips] == [
        (*case, division) for case in cases for division in ("8 x 10", "14 x 12")
    ]
    assert [row["median"] for row in contact] == [0.201, 3.49, 0.044, 0.328, 0.02, 0.12]
    assert all(row["solves"] > 2 and 0 < row["least"] <= row["median"] for row in strips)
    assert all(row["warm"] > 0 and row["cold"] > 0 for row in strips)
    assert all(row["force error"] < 0.5 for row in strips)  # % of mu F_n
    assert all(row["peak error"] < 10 for row in strips)  # %, of four strips at 25 kN
    axis = Figure().subplots()
    wheel_panel(axis, [*strips, *contact])
    places = [(line.get_xdata()[0], line.get_ydata()[0]) for line in axis.lines]
    assert places[:6] == [(1e3 * row["median"], k // 2) for k, row in enumerate(strips)]
    assert [place for _, place in places[6:]] == [0, 0, 1, 1, 2, 2]
    names = [label.get_text() for label in axis.get_yticklabels()]
    assert names == ["80 kN\n1 patch", "70 kN\n2 patches", "25 kN\n2 patches"]


def test_sampled_ellipses_cover_their_ranges() -> None:
    cases = sampled_cases(40, 0)
    assert cases == sampled_cases(40, 0)
    assert cases != sampled_cases(40, 1)
    ratios = np.array([np.divide(*case.pair.exact.semi_axes) for case in cases])
    assert ratios.min() < 0.3
    assert ratios.max() > 3.5
    assert np.all((ratios > 0.2) & (ratios < 5.0))
    moved = np.array([case.creep for case in cases]) != 0
    np.testing.assert_array_equal(moved[:4], [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    assert all(case.contact_forces is None for case in cases)


def test_errors_of_sampled_ellipses_stand_apart() -> None:
    known, sampled = coarse().cases[1], sampled_cases(1, 0)[0]
    both = Reference(LatticeResolution(24, 24), (timing_case(), known, sampled), np.zeros((3, 2)), 1.0, 0.0)
    row = rolling_row(SMALL, both, both.cases[1:])
    for name, case in (("creep", known), ("sampled", sampled)):
        forces = case.forces(case.solved(SMALL.of(case.pair, case.friction), SMALL.loaded_depth(case.pair)))
        assert row[f"{name} worst"] == pytest.approx(100 * np.abs(forces).max(), rel=1e-6)
    assert both.contact_deviations.shape == (2, 2)


def test_cold_and_warm_models_are_close_to_hertz_and_to_the_reference() -> None:
    for warm in (False, True):
        variant = ModelVariant("lattice", "half-space", SMALL.fineness, warm=warm)
        normal, creep = normal_row(variant), rolling_row(variant, coarse(), coarse().cases[1:])
        assert abs(normal["force error"]) < 0.6  # %
        assert abs(normal["peak error"]) < 2.0
        assert abs(normal["area error"]) < 3.0
        assert 0 < creep["creep error"] < 1.0  # % of mu F_n
        assert creep["creep RMS"] <= creep["creep worst"] < 1.0
        for row in (normal, creep):
            assert row["start"] == ("warm" if warm else "cold")
            assert 0 < row["least"] <= row["median"]


def test_slow_models_skip_the_creep_cases() -> None:
    row = rolling_row(SMALL, coarse(), coarse().cases[1:], patience=0.0)
    assert "creep error" in row
    assert "creep RMS" not in row


def test_a_model_that_fails_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object, **__: object) -> None:
        raise RuntimeError("contact failed: no answer")

    monkeypatch.setattr(error_plan, "normal_row", failing)
    (row,) = rows(SMALL, coarse(), ())
    assert row["failed"] == "contact failed: no answer"


def test_variants_name_their_laws() -> None:
    assert ModelVariant("", "waveguide").laws == "exact"
    assert ModelVariant("", "waveguide", stiffness=1e15, regularisation=1e-5).laws == "K 1e+15, eps 1e-05"
    assert SMALL.division == "6 x 8"
    model = SMALL.of(timing_case().pair, 0.0)
    assert getattr(model, "laws") == ContactLaws(friction=0.0)  # noqa: B009


def test_every_family_has_its_own_style() -> None:
    every = [*error_plan.lattices(False), *error_plan.grids(False), *error_plan.laws(False), *error_plan.solids()]
    assert {variant.family for variant in every} | {"CONTACT", *(row["family"] for row in long_cell_rows())} == set(
        STYLES
    )
    assert len(set(STYLES.values())) == len(STYLES)


def test_report_and_figure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(error_vs_time, "extrapolated", lambda *_: coarse())
    monkeypatch.setattr(error_vs_time, "machine_description", lambda: "this machine")
    monkeypatch.setattr(error_plan, "QUICK_FINENESSES", ((4, 6),))
    monkeypatch.setattr(error_plan, "BODIES", ("half-space",))
    monkeypatch.setattr(error_plan, "grids", lambda _: iter(()))
    monkeypatch.setattr(error_plan, "laws", lambda _: iter(()))
    monkeypatch.setattr(error_vs_time, "strip_rows", lambda: iter(()))
    picture, data = tmp_path / "error.png", tmp_path / "error.json"
    monkeypatch.setattr("sys.argv", ["error_vs_time", "--quick", "--picture", str(picture), "--json", str(data)])
    error_vs_time.main()
    told = capsys.readouterr().out
    assert "| lattice, half-space, warm | 4 x 6 | exact | 24 |" in told
    assert "| CONTACT | dx 1 mm |" in told
    found = json.loads(data.read_text())["rows"]
    assert len(found) == 4 + 10 + 10 + 6
    assert "| CONTACT | dx 0.2 mm | 70 | 2 |" in told
    assert picture.stat().st_size > 10_000
