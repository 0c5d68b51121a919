"""The population of vehicle runs: one integer draws a run, and faults that its oracles detect."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from benchmarks.population import runs
from benchmarks.population.runs import Run, faults, judged
from wheelrail.vehicle.simulation.history import History

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
    assert {own.method for own in many} == {"rosenbrock", "rosenbrock4", "ode23"}
    assert {own.plane for own in many} == {True, False}
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

    monkeypatch.setattr(runs, "simulate", raises)
    assert judged(SEED).kind == "wrong"
    assert "ZeroDivisionError: planted" in judged(SEED).reason
