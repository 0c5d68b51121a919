"""The paper's tables: compared quantities, errors and failures."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import small_wheelset

from benchmarks.paper.error import Ran, difference
from benchmarks.paper.figure import picture
from benchmarks.paper.fixed_states import accuracies, states
from benchmarks.paper.published import TABLES
from benchmarks.paper.runs import Runs
from benchmarks.paper.segment import PaperBody, TrackSegment
from benchmarks.paper.tables import HEAD, markdown, printed, row
from benchmarks.paper.variants import ETAS, LU, SOLID, WAVES_EXACT, PaperVariant, krylov, sparse, table
from wheelrail.contact.kinematics.frames import SIDES
from wheelrail.contact.models.full.newton import FullOptions
from wheelrail.contact.solvers.options import NewtonOptions
from wheelrail.vehicle.simulation.contact_cost import ContactCost
from wheelrail.vehicle.simulation.history import RunCost

SECONDS = 0.002


@pytest.fixture(scope="module")
def part() -> TrackSegment:
    """A part of the scene's run on a straight track and coarse, small meshes."""
    made = TrackSegment(PaperBody("small"), 0.0, SECONDS)
    made.__dict__["contact"] = small_wheelset.wheelset()  # in place of the scene's own
    return made


def test_error_of_identical_and_shifted_runs(part: TrackSegment) -> None:
    shifted_state = part.reference.state.copy()
    shifted_state[:, 6] += 3e-6
    rows = [
        replace(row, state=state, force=row.force + 7.0)
        for row, state in zip(part.reference.rows, shifted_state, strict=True)
    ]
    shifted = replace(part.reference, rows=rows)
    assert difference(part.reference, part.reference) == (0.0, 0.0)
    y, force = difference(shifted, part.reference)
    assert y == pytest.approx(3e-6)
    assert force == pytest.approx(7.0)


def test_errors_and_counts_of_a_run(part: TrackSegment) -> None:
    ran = part.compared(part.run("ode23", {"linear": "bicgstab", "forcing": 0.01}))
    assert not ran.failure
    assert ran.solves == sum(side.solves for side in ran.cost.contact.values()) > 0
    assert ran.linear > 0
    assert 0 < ran.force < 0.05


def test_options_are_those_of_the_form() -> None:
    """Eq. (12) and (15) have different options."""
    assert FullOptions(**dict(sparse("difference"))).jacobian == "difference"
    assert NewtonOptions(**dict(krylov(0.5))).forcing == 0.5
    assert NewtonOptions(**dict(LU)).linear == "lu"


def test_rows_of_the_tables() -> None:
    assert [float(dict(v.options)["forcing"]) for v in table("9")] == list(ETAS)
    assert {v.method for v in table("5")} == {"ode23"}
    assert {v.method for v in table("6")} == {"ode45"}
    assert {v.full for v in table("5")} == {True, False}
    assert {"linear" in dict(v.options) for v in table("7")} == {True, False}
    with pytest.raises(ValueError, match="no table 8"):
        table("8")


def test_scenes_of_bodies_are_valid() -> None:
    assert SOLID.scene().surface_size == 2e-3
    exact = WAVES_EXACT.scene()
    how = exact.discretisation
    assert (exact.laws, how.bodies, how.points) == ("exact", "waveguide", "grid")


def test_loose_tolerances_have_larger_errors(part: TrackSegment) -> None:
    run = part.run("ode23", dict(LU))
    found = accuracies(part, states(part, run, 2))
    cold = [one for one in found if not one.warm]
    assert cold[0].creep > 10 * cold[-1].creep
    assert cold[0].newton < cold[-1].newton
    assert cold[-1].force < 1e-8
    assert not any(one.failed for one in found)


def test_failed_variant_is_a_row_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = Runs(0.0, SECONDS, SECONDS, say=lambda _: None)

    def fail(*_: object) -> TrackSegment:
        raise RuntimeError("the mesh is gone")

    monkeypatch.setattr(Runs, "part", fail)
    variant = PaperVariant("Eq. (15), ODE23, LU", SOLID, "ode23", LU)
    ran = runs.of(variant)
    cells = row(variant, ran, SECONDS)
    assert len(cells) == len(HEAD.split("|"))
    assert "the mesh is gone" in cells[-1]


def test_an_unfinished_run_has_no_error(part: TrackSegment) -> None:
    ran = part.compared(replace(part.reference, status="failed: step"))
    assert ran.failure == "failed: step"
    assert np.isnan(ran.force)


def test_printed_tables_are_those_of_the_paper() -> None:
    text = printed("7")
    assert "10 h 51 min" in text
    assert "| 27409 | 31814 | 8396 | 29495 | 2.9 | 3.5 | 2 h 20 min |" in text
    assert "not legible" in printed("5")
    assert set(TABLES) == {"5", "6", "7"}
    assert markdown("a|b", [[1, "x"]]).splitlines()[-1] == "| 1 | x |"


def test_picture(tmp_path: Path) -> None:
    sides = {side: ContactCost(solves=10, newton=20, linear=60, seconds=0.1) for side in SIDES}
    ran = Ran(RunCost(contact=sides, seconds=0.3), 1e-6, 1e-3)
    picture(tmp_path / "x.png", [(v, ran, 0.1) for v in (*table("9"), *table("7"))])
    assert (tmp_path / "x.png").read_bytes()[1:4] == b"PNG"
