"""Survey of random ellipses: its sample, a few cases, and the log from which it continues."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.ellipses import report
from benchmarks.ellipses.report import CONVERGED, logged, outcome, run, show, solve
from benchmarks.ellipses.sample import FRICTION, LATERAL_RADII, LOADS, ROLLING_RADII, rolling_ellipse
from wheelrail.contact.laws.friction import FallingFriction
from wheelrail.contact.models.lattice.resolution import LatticeResolution

COARSE, SEED = LatticeResolution(4, 10), 5


def test_the_sample_covers_its_ranges() -> None:
    cases = [rolling_ellipse(SEED, number) for number in range(2000)]
    loads, rolling_radii, lateral_radii, friction = np.array(
        [(case.pair.load, *case.pair.radii, case.friction.mu) for case in cases]
    ).T
    for values, limits in ((loads, LOADS), (rolling_radii, ROLLING_RADII), (lateral_radii, LATERAL_RADII)):
        assert values.min() == pytest.approx(limits[0], rel=2e-2)
        assert values.max() == pytest.approx(limits[1], rel=2e-2)
    assert friction.min() < 0.01
    assert FRICTION - 0.01 < friction.max() <= FRICTION
    assert 400 < sum(isinstance(case.friction, FallingFriction) for case in cases) < 600


def test_cases_converge_and_slide_at_five_times_saturation() -> None:
    cases = [rolling_ellipse(SEED, number) for number in range(8)]
    assert [solve(case, COARSE).status for case in cases] == [CONVERGED] * len(cases)
    case = next(case for case in cases if not isinstance(case.friction, FallingFriction))
    xi = 5 * np.hypot(*case.creepages[:2])
    result = solve(replace(case, creepages=(xi, 0.0, 0.0)), COARSE)
    # elastic slip turns some tractions by a little
    assert abs(result.force[0]) == pytest.approx(case.friction.mu * result.force[2], rel=1e-3)


def test_a_run_continues_its_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    log = tmp_path / "ellipses.jsonl"
    first = run(range(3), SEED, COARSE, log)
    assert [o.fine for o in first] == [CONVERGED, "", ""]
    assert 0 < first[0].creep_force < 0.2
    with log.open("a", encoding="utf-8") as stream:
        stream.write('{"number": 3, "str')  # killed as it wrote
    solved: list[int] = []
    monkeypatch.setattr(report, "outcome", lambda case, *a, **k: solved.append(case.number) or outcome(case, *a, **k))
    assert [o.number for o in run(range(5), SEED, COARSE, log)] == [0, 1, 2, 3, 4]
    assert solved == [3, 4]
    assert sorted(o.number for o in logged(log)) == [0, 1, 2, 3, 4]


def test_failures_are_shown_with_their_case(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ValueError("no table")

    monkeypatch.setattr(report, "hertz_model", broken)
    text = show(run([4], SEED, COARSE, None))
    assert "1 failed" in text
    assert "1 x failed: ValueError: no table" in text
    assert str(rolling_ellipse(SEED, 4)) in text
