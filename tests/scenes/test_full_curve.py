"""scenes/full_curve.toml: its validity, and a piece of its run by both formulations on coarse meshes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.full_curve import differences, published, ran, row, solve_costs
from wheelrail.contact.models.full.model import FullContact
from wheelrail.scenes.schema.scene import RunScene, load_scene

FOLDER = Path(__file__).parents[2] / "scenes"


def scene() -> RunScene:
    loaded = load_scene(FOLDER / "full_curve.toml")
    assert isinstance(loaded, RunScene)
    return loaded


def test_full_curve_is_the_paper_s_beginning_with_all_displacements() -> None:
    paper, whole = (load_scene(FOLDER / name).model_dump() for name in ("paper_curve.toml", "full_curve.toml"))
    assert {key for key in paper if paper[key] != whole[key]} == {"model", "surface_size", "track", "solver"}
    assert (whole["model"], whole["laws"], whole["solver"]["method"]) == ("full", "paper", "rosenbrock")
    assert (scene().discretisation.bodies, scene().discretisation.points) == ("solid", "grid")
    curve, beginning = paper["track"], whole["track"]
    share = beginning["transition_length"] / curve["transition_length"]  # of a clothoid
    assert beginning["transition"] == "clothoid"
    assert beginning["curvature"] == pytest.approx(share * curve["curvature"], rel=1e-12)
    assert beginning["cant"] == pytest.approx(share * curve["cant"], rel=1e-12)
    assert beginning["tangent"] == 0.0
    assert beginning["transition_length"] / scene().vehicle.speed >= 0.5


def test_both_formulations_give_the_same_run() -> None:
    coarse, seconds = scene().model_copy(update={"surface_size": 8e-3}), 0.05  # m, s
    whole, condensed = (ran(coarse, model, seconds) for model in ("full", "condensed"))
    assert whole.history.status == condensed.history.status == "completed"
    assert len(whole.history) >= 4
    state, force = differences(whole.history, condensed.history)
    assert state < 1e-6
    assert force < 1e-6
    moved = np.abs(whole.history.state - whole.history.state[0]).max(axis=0)
    assert moved[6] > 1e-6  # m, of the wheelset to the side
    sides = whole.history.cost.contact.values()
    for cost in sides:
        assert cost.failed == 0
        assert cost.tangents >= len(whole.history) - 1  # the implicit method has the exact tangent
        assert cost.newton == cost.linear  # one iteration of BiCGStab for each of Newton's
    assert whole.history.cost.steps.differences == 0
    model = whole.contact.model
    assert isinstance(model, FullContact)
    preconditioner = model.solver.preconditioner
    assert preconditioner is not None
    newton, solves = (sum(getattr(cost, key) for cost in sides) for key in ("newton", "solves"))
    # one product with K^-1 for each Newton step, three where the known response of the residual is round-off, and one
    # for the start of each solve
    assert newton <= preconditioner.solves <= 1.2 * newton + solves
    assert newton < 3 * solves
    assert row("", whole)[-4] == "1.00"
    costs = solve_costs(coarse, whole, 2)
    assert costs["warm"].newton < costs["cold"].newton
    assert costs["warm"].products <= 1.5 * costs["warm"].newton + 1


def test_the_paper_s_table_is_printed_beside() -> None:
    (full, condensed) = published()
    assert full[2:4] == [31390, "not legible"]
    assert (full[6], full[7], full[9]) == ("1.00", "4.3 / 4.6", 8 * 3600 + 40 * 60)
    assert (condensed[6], condensed[7], condensed[9]) == ("0.64", "2.9 / 3.5", 2 * 3600 + 20 * 60)
