"""A short part of the random stress test: every case converges, and its result holds together."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.stability import attempt, show, trouble
from benchmarks.stability_check import LIMITS, broken, findings
from benchmarks.stability_depth import NoDepth, depth_for
from benchmarks.stability_run import Outcome, model_of
from benchmarks.stability_sample import RAILS, Case, cases

SIZE = 2e-3  # m: spectra of coarse lines take a second each
COUNT, SEED = 16, 7


@cache
def outcomes() -> tuple[Outcome, ...]:
    return tuple(attempt(replace(case, size=SIZE), twin=False) for case in cases(COUNT, SEED))


def test_every_case_that_has_an_answer_converges_and_keeps_all_limits() -> None:
    assert [o for o in outcomes() if o.kind == "failed" or o.broken] == []


def test_fitted_cells_follow_the_contact_wherever_yaw_takes_it() -> None:
    fitted = [o for o in outcomes() if o.fitted]
    assert len(fitted) > COUNT / 3
    assert [o.reason for o in fitted if o.kind != "converged"] == []


def test_loads_are_about_those_asked_for() -> None:
    ratio = [o.load / o.case.load for o in outcomes() if o.fitted and o.case.friction < 0.1]
    assert ratio
    assert min(ratio) > 0.3
    assert max(ratio) < 3.0


def test_the_sample_covers_its_ranges() -> None:
    many = cases(2000, 0)
    assert {case.rail for case in many} == set(RAILS)
    for name, low, high in (("y", -9e-3, 9e-3), ("roll", -1e-2, 1e-2), ("yaw", -3e-2, 3e-2), ("load", 1e2, 2e5)):
        values = np.array([getattr(case, name) for case in many])
        span = high - low
        assert values.min() == pytest.approx(low, abs=2e-3 * span)
        assert values.max() == pytest.approx(high, abs=1e-2 * span)
    assert any(not np.isfinite(case.stiffness_per_area) for case in many)
    assert any(case.regularisation == 0 for case in many)
    assert any(case.friction == 0 for case in many)
    assert cases(2000, 0) == many


def test_wrong_results_are_noticed() -> None:
    case = next(o.case for o in outcomes() if o.fitted and o.case.friction > 0.1)
    depth = depth_for(case)
    pose, motion = case.at(depth)
    result = model_of(case)(pose, motion, None)
    assert result.fields is not None
    assert broken(findings(case, pose, result)) == []
    doubled = replace(result.fields, traction=-2 * result.fields.traction, pressure=-result.fields.pressure)
    assert set(broken(findings(case, pose, replace(result, fields=doubled)))) >= {"force", "moment", "pull", "friction"}
    outcome = Outcome(case, "converged", force_differs=0.5, figures=dict.fromkeys(LIMITS, 0.0))
    assert "from its twin" in trouble(outcome)
    assert "from its twin" in show([outcome])


def test_a_wheel_beside_the_rail_has_no_depth() -> None:
    aside: Case = replace(cases(4, 0)[0], y=0.2)
    with pytest.raises(NoDepth):
        depth_for(aside)
