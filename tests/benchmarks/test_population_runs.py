"""The population of vehicle runs: one integer draws a run, and faults that its oracles detect."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.population import drawn_run
from benchmarks.population.drawn_run import Run
from benchmarks.population.runs import (
    BY_METHOD,
    EVENTS,
    USUAL,
    beyond_friction,
    conclusion,
    faults,
    judged,
    off_the_rails,
    spin,
)
from wheelrail.vehicle.integration.integrate import METHODS
from wheelrail.vehicle.multibody.coordinates import Y
from wheelrail.vehicle.simulation import time_run
from wheelrail.vehicle.simulation.history import History
from wheelrail.vehicle.steady.equilibrium import equilibrium

SEED = 164  # a plane wagon in a curve of 270 m


@cache
def pair() -> tuple[History, History]:
    """The run of the seed, and itself in place of one with short steps."""
    run = Run(SEED).history(60.0)
    return run, run


def altered(history: History, **factors: float) -> History:
    """With one component of all forces, or the states, times a factor."""
    force, state = factors.get("force", 1.0), factors.get("state", 1.0)
    rows = [replace(row, force=force * row.force, state=state * row.state) for row in history.rows]
    return replace(history, rows=rows)


def test_a_seed_gives_one_run_and_the_population_covers_its_ranges() -> None:
    many = [Run(seed) for seed in range(300)]
    assert all(own.drawn == Run(own.seed).drawn for own in many[:20])
    speeds, radii = np.array([own.speed for own in many]), np.array([own.radius for own in many])
    assert speeds.min() < 5.0
    assert speeds.max() > 50.0
    assert radii.min() < 280.0
    assert 0.2 < np.isinf(radii).mean() < 0.4
    assert {own.method for own in many} == set(METHODS)
    assert {own.plane for own in many} == {own.sleepers for own in many} == {True, False}
    assert {own.vehicle.speed_hold is None for own in many[:20]} == {True, False}
    some = [own.irregularities for own in many if own.drawn["rough"] > 0.25]
    assert len([of for of in some if of is not None and len(of.stations) == 101]) > 50
    loads = [own.loads for own in many[:20]]
    assert any(own.forces for own in loads)
    assert any(own.torques for own in loads)
    assert len({own.pair for own in many}) >= 10


def test_mirror_images_of_a_track() -> None:
    for own in (Run(seed) for seed in range(8)):
        image, at = Run(own.seed, mirrored=True), np.linspace(0.0, 150.0, 31)
        assert [image.track.curvature(s)[0] for s in at] == [-own.track.curvature(s)[0] for s in at]
        if own.irregularities is not None and image.irregularities is not None:
            left, right = own.irregularities.derivatives(at)[0], image.irregularities.derivatives(at)[0]
            np.testing.assert_allclose(right, left[:, [2, 3, 0, 1]] * [-1.0, 1.0, -1.0, 1.0], atol=1e-15)


def test_a_right_run_has_no_fault() -> None:
    run, short = pair()
    assert run.status == "completed"
    assert list(faults(run, short, None)) == []


@pytest.mark.parametrize(
    ("planted", "found"),
    [
        ({"force": 1.02}, "vertical forces differ by 0.02"),
        ({"force": np.nan}, "no numbers"),
        ({"state": 2.0}, "largest |y|"),
        ({"status": "failed: no reason"}, "failed: no reason, but with short steps completed"),
    ],
)
def test_planted_faults_are_found(planted: dict[str, float | str], found: str) -> None:
    run, short = pair()
    status = planted.get("status")
    wrong = replace(run, status=str(status)) if status else altered(run, **planted)  # type: ignore[arg-type]
    assert any(found in text for text in faults(wrong, short, None))


def test_a_mirror_image_that_differs_is_found() -> None:
    run, short = pair()
    assert "mirror image" in "; ".join(faults(run, short, altered(run, state=1.0 + 1e-12)))


def test_what_raises_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def raises(*arguments: object, **options: object) -> None:
        raise ZeroDivisionError("planted")

    monkeypatch.setattr(drawn_run, "simulate", raises)
    assert judged(SEED).kind == "wrong"
    assert "ZeroDivisionError: planted" in judged(SEED).reason


def at_event(event: str, method: str = "rosenbrock") -> Run:
    return Run(0, fixed=tuple((USUAL | {"method": BY_METHOD[method]} | EVENTS[event]).items()))


@pytest.mark.parametrize("method", METHODS)
def test_events_are_met_by_the_methods_they_name(method: str) -> None:
    assert at_event("curve, wagon", method).method == method
    assert at_event("curve").irregularities is None
    assert at_event("sleepers, wagon").sleepers


def test_a_run_that_jumps_over_a_curve_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the resolution of what is prescribed, by the momentum of its rows and by short steps."""

    class Unresolved:
        def __init__(self, *arguments: object) -> None: ...

        def longest_step(self, time: float, state: object, at: object, step: float) -> float:
            return step

    right = at_event("curve, wagon", "rosenbrock4").history(60.0)
    monkeypatch.setattr(time_run, "Excitation", Unresolved)
    jumped = at_event("curve, wagon", "rosenbrock4").history(60.0)
    assert right.status == jumped.status == "completed"
    found = "; ".join(faults(jumped, right, None))
    assert "lateral forces differ" in found
    assert "largest |y|" in found
    assert conclusion(right, right, None) == ("right", "")


@cache
def at_curve(event: str) -> History:
    return at_event(event).history(60.0)


def test_the_population_covers_its_kinds() -> None:
    many = [Run(seed) for seed in range(150)]
    kinds = ("named", "turning", "supple")
    assert all(0.02 < np.mean([bool(getattr(own, kind)) for own in many]) < 0.3 for kind in kinds)
    assert {own.rubbing(100.0)[0] for own in many} == {0.4, 1.0, 1.5}
    own = at_event("contacts by name, curve")
    first, second = own.vehicle.wheelsets[:2]
    assert own.coefficient(first, 0.0) == 2.0 * own.coefficient(second, 0.0) == own.friction
    assert not {part.wheelset for part in at_event("independent wheels, curve").loads.torques} & {*own.turning}


@pytest.mark.parametrize("event", ["contacts by name, curve", "leaves, curve"])
def test_friction_of_another_place_or_wheelset_is_found(event: str) -> None:
    """Runs with uniform friction reach the bound, and are beyond that of the event."""
    run = at_curve("curve")
    assert 0.99 < beyond_friction(run, at_event("curve")) <= 1.0 + 1e-3
    assert beyond_friction(run, at_event(event)) > 1.5
    own = at_curve(event)
    assert 0.99 < beyond_friction(own, at_event(event)) <= 1.0 + 1e-3
    assert "bound of friction" in "; ".join(faults(run, run, None, at_event(event)))
    assert list(faults(own, own, None, at_event(event))) == []


def test_normals_of_a_flange_root_and_of_a_tread() -> None:
    """The root of S1002 turns from the tread to 70 degrees; a patch of 10 mm on the crown of a tread by little."""
    own = at_event("curve")
    assert 1.0 < own.turn("wheelset_1", -0.042, -0.025) < 1.25
    assert own.turn("wheelset_1", -0.005, 0.005) < 0.05


def test_moments_between_wheels_that_turn_by_themselves() -> None:
    run, own = at_curve("independent wheels, curve"), at_event("independent wheels, curve")
    assert spin(run, own.turning) < 2e-3
    couple = np.array([[0.0, 100.0, 0.0], [0.0, -100.0, 0.0]])  # N m, far less than in a rigid axle
    wrong = replace(run, rows=[replace(row, moment=row.moment + couple) for row in run.rows])
    assert "moments between wheels" in "; ".join(faults(wrong, wrong, None, own))


def moved(history: History, y: float) -> History:
    """With the wheelset at another place at the end, said to have left the rails."""
    state, name = history.rows[-1].state.copy(), history.dynamics.vehicle.wheelsets[0]
    state[history.dynamics.coordinates.index(name, Y)] = y
    last = replace(history.rows[-1], state=state)
    return replace(history, rows=[*history.rows[:-1], last], status="failed: the wheelset has left the rails")


def test_a_derailment_is_explained_by_displacements_not_by_its_status() -> None:
    run, _ = pair()
    assert off_the_rails(run) == ""
    on, off = moved(run, 6e-3), moved(run, 0.03)
    assert conclusion(on, on, None)[0] == "unexplained failure"
    assert conclusion(off, off, None)[0] == "explained failure"
    assert conclusion(off, on, None)[0] == "unexplained failure"
    assert conclusion(replace(off, status="completed"), off, None)[0] == "wrong"


def test_what_data_do_not_settle_is_explained() -> None:
    """Seed 870004 on the edge of derailment: the wheel falls from a flange climbed by 17 mm, or with 0.1 % more
    friction leaves the rails. Short steps that differ are wrong unless that little friction changes them as much.
    """
    run, short = pair()
    other = altered(short, force=1.5)
    assert conclusion(run, other, None)[0] == "wrong"
    assert conclusion(run, other, None, None, lambda: other)[0] == "wrong"
    kind, reason = conclusion(run, other, None, None, lambda: short)
    assert kind == "explained failure"
    assert "by 0.1% more friction largest Q" in reason
    assert conclusion(altered(run, force=2.0), other, None, None, lambda: short)[0] == "wrong"  # breaks a law, too
    assert Run(3, rougher=1.5).friction == pytest.approx(1.5 * Run(3).friction)


def test_wheels_whose_creep_forces_are_at_their_limit_find_their_spin() -> None:
    """Newton's method led from one limit to the other and back on rails with a friction of 0.05; a vehicle that rolls
    freely on straight track has neither a longitudinal force nor a lateral position.
    """
    dynamics = Run(870019).dynamics
    found = equilibrium(dynamics)
    assert max(abs(found.state[dynamics.coordinates.index(name, Y)]) for name in dynamics.vehicle.wheelsets) < 1e-9
    for sides in found.contacts.values():
        assert abs(sides["left"].force[0]) < 1e-5 * sides["left"].force[2]
