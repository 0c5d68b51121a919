"""Part of the random stress test: every case converges to a consistent result."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.stability import solve as stability_run
from benchmarks.stability.depth_estimate import NoDepth, depth_for
from benchmarks.stability.invariants import LIMITS, broken, findings
from benchmarks.stability.report import attempt, show, trouble
from benchmarks.stability.sample import RADIUS, RAILS, SampledCase, cases
from benchmarks.stability.solve import BETWEEN, SolveOutcome, model_of, solve, vertical_load
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.models.builders import wheel_rail_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.wheelset import ContactModel
from wheelrail.contact.results.result import ContactResult, Patch
from wheelrail.meshes.profiles.named import named_profile

WIDE = 500.0  # N: narrower contacts have fewer than two strips
SIZE = 3e-3  # m: spectra of coarse lines take half a second each
COUNT, SEED = 10, 7


@cache
def outcomes() -> tuple[SolveOutcome, ...]:
    """On the same lines, whose spectra are cached."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(stability_run, "SIZES", (SIZE,))
        return tuple(attempt(replace(case, size=SIZE), twin=False) for case in cases(COUNT, SEED))


def test_solvable_cases_converge_within_all_limits() -> None:
    assert [(o.reason, o.broken, o.case) for o in outcomes() if o.kind == "failed" or o.broken] == []


def test_strips_with_large_yaw() -> None:
    strips = [o for o in outcomes() if o.strips]
    assert len(strips) > COUNT / 3
    assert [(o.reason, o.case) for o in strips if o.kind != "converged"] == []


def test_grids_report_contacts_between_points() -> None:
    blind = [o for o in outcomes() if o.kind == "no answer"]
    assert not any(o.strips for o in blind)
    assert all("carries contact points" in o.reason or o.reason == BETWEEN for o in blind)


@cache
def half_spaces(rail: str) -> ContactModel:
    profiles, how = (named_profile("S1002"), named_profile(rail)), Discretisation(SIZE, bodies="half-space")
    return wheel_rail_pair(profiles, RADIUS, (Material(), Material()), ContactLaws(np.inf, 0.0, 0.0), how)


def test_depth_estimate_on_half_spaces_and_elastic_bodies() -> None:
    found = [o for o in outcomes() if o.strips and o.case.load > WIDE]
    ratios = []
    for outcome in found[:5]:
        pose, motion = outcome.case.at(outcome.depth)
        ratios.append(vertical_load(half_spaces(outcome.case.rail)(pose, motion, None)) / outcome.case.load)
    # 0.81 to 1.51 in 60 cases: virtual penetration neglects yaw, which matters on the flange
    assert min(ratios) > 0.7
    assert max(ratios) < 1.6
    assert all(0 < o.load < 1.6 * o.case.load for o in found)


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


@cache
def rubbing() -> tuple[SampledCase, float, ContactResult]:
    """A case with friction, its depth and result."""
    outcome = next(o for o in outcomes() if o.strips and o.case.friction > 0.1)
    pose, motion = outcome.case.at(outcome.depth)
    return outcome.case, outcome.depth, model_of(outcome.case)(pose, motion, None)


def changed(result: ContactResult, **factors: float) -> ContactResult:
    """Some of its fields times a factor."""
    fields = result.fields
    assert fields is not None
    return replace(result, fields=replace(fields, **{name: getattr(fields, name) * f for name, f in factors.items()}))


def elsewhere(result: ContactResult) -> ContactResult:
    """With the band of its patches on the field side."""

    def moved(patch: Patch) -> Patch:
        return replace(patch, wheel_band=(0.045, 0.05))

    return replace(result, patches=tuple(map(moved, result.patches)))


@pytest.mark.parametrize(
    ("wrong", "noticed"),
    [
        (lambda r: changed(r, traction=-1.0), {"force", "law", "work"}),
        (lambda r: changed(r, slip=-1.0), {"law", "work"}),
        (lambda r: changed(r, traction=1.001), {"force", "moment", "friction", "law"}),
        (lambda r: changed(r, pressure=-1.0), {"force", "moment", "pull", "friction"}),
        (lambda r: changed(r, penetration=1.001), {"undeformed"}),
        (lambda r: changed(r, displacement=1.02), {"penetration"}),
        (lambda r: changed(r, pressure=0.0), set(LIMITS)),
        (lambda r: replace(r, patches=()), {"patches", "missed"}),
        (elsewhere, {"missed"}),
    ],
)
def test_wrong_results_are_detected(wrong: Callable[[ContactResult], ContactResult], noticed: set[str]) -> None:
    case, depth, result = rubbing()
    model = model_of(case)
    assert broken(case, findings(case, depth, result, model)) == []
    assert set(broken(case, findings(case, depth, wrong(result), model))) >= noticed


def test_deviations_from_the_twin_are_detected() -> None:
    alone = SolveOutcome(rubbing()[0], "converged", figures=dict.fromkeys(LIMITS, 0.0))
    assert trouble(alone) == ""
    for outcome, said in (
        (replace(alone, twin="converged", force_differs=0.5), "from its twin"),
        (replace(alone, twin="failed: not found"), "not found"),
        (replace(alone, history=1e-3), "other starts"),
    ):
        assert said in trouble(outcome)
        assert said in show([outcome])
    rough = replace(alone, twin="converged", force_differs=0.5, rough=True)
    assert trouble(rough) == ""
    assert "few strips" in show([rough])


@pytest.mark.parametrize("status", ["separated", "failed: not found"])
def test_no_force_despite_penetration_is_a_failure(monkeypatch: pytest.MonkeyPatch, status: str) -> None:
    case, _, _ = rubbing()
    nothing = replace(ContactResult.separated(), status=status)
    monkeypatch.setattr(stability_run, "model_of", lambda _: lambda *_: nothing)
    outcome = solve(case)
    assert outcome.kind == "failed"
    assert status in show([outcome])


def test_results_are_deterministic() -> None:
    """Bitwise for one model; to round-off for a new model, whose tables have other lines."""
    case, depth, _ = rubbing()
    pose, motion = case.at(depth)
    one, again = (model_of(case)(pose, motion, None) for _ in range(2))
    assert (again.force == one.force).all()
    assert (again.moment == one.moment).all()
    assert repr(again.patches) == repr(one.patches)
    stability_run._pair.cache_clear()
    new = model_of(case)(pose, motion, None)
    assert new.force == pytest.approx(one.force, abs=1e-9 * float(np.linalg.norm(one.force)))


def test_no_depth_for_a_wheel_beside_the_rail() -> None:
    aside: SampledCase = replace(cases(4, 0)[0], y=0.2)
    with pytest.raises(NoDepth):
        depth_for(aside)
