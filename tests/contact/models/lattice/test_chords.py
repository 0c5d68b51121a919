"""Steps with kept factors, corrected by Broyden's rank-one updates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from wheelrail.bindings._contact import (
    LatticeProblem,
    LatticeSolution,
    LatticeStart,
    chords,
    evaluate,
    factorised,
    linearised,
    moved,
    newton_step,
    relative_size,
)
from wheelrail.contact.kinematics.frames import RigidMotion, Twist
from wheelrail.contact.laws.material import Material
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.loading.hertz import hertz_pose
from wheelrail.contact.models.builders import hertz_pair
from wheelrail.contact.models.discretisation import Discretisation
from wheelrail.contact.models.lattice.model import LatticeContact
from wheelrail.support.arrays import Array

STEEL = Material(2.1e11, 0.3)
ROLLING = RigidMotion(*(Twist(np.array([v, 0.0, 0.0]), np.zeros(3), np.zeros(3)) for v in (-0.9995, -1.0005)))
DEPTH = 80e-6  # m
CONTRACTION = 0.5  # of a step, for another one with the same factors


@pytest.fixture(scope="module")
def model() -> LatticeContact:
    how = Discretisation(1e-3, bodies="half-space", points="lattice", strips=8, cells=8)
    pair = hertz_pair(((0.46, 0.3), (np.inf, np.inf)), (STEEL, STEEL), ContactLaws(friction=0.3), how, load=60e3)
    assert isinstance(pair, LatticeContact)
    return replace(pair, tolerance=1e-9)


def solution(model: LatticeContact, depth: float) -> tuple[LatticeProblem, LatticeSolution]:
    """Equations at an approach m, and their solution with factors of the Jacobian there."""
    problem = model.problem(hertz_pose(depth), ROLLING)
    start = model.solve(problem).warm_start
    assert isinstance(start, LatticeStart)
    (found,) = start.solutions
    assert found is not None
    found.factors = factorised(linearised(found.values, problem.of(found.strips)))[1]
    return problem, found


def broyden(values: Array, problem: LatticeProblem, start: LatticeSolution, evaluations: int) -> tuple[Array, Array]:
    """State and next step (S, block) after some residuals, with explicit updates of the dense Jacobian."""
    data = problem.of(start.strips)
    shape, whole = values.shape, data.places.whole
    unit = np.eye(values.size).reshape(-1, *shape)
    weight = np.array([relative_size(values, part)[1] ** 2 for part in unit])
    jacobian = start_jacobian(start)
    residual = evaluate(values, data).residual.ravel()
    for k in range(evaluations):
        step = -np.linalg.solve(jacobian, residual)
        if k == evaluations - 1:
            break
        values = moved(values, step.reshape(shape), 1.0, whole)
        after = evaluate(values, data).residual.ravel()
        metric = weight * step
        jacobian = jacobian + np.outer(after, metric) / (metric @ step)  # after is y - J step
        residual = after
    return values, step.reshape(shape)


def start_jacobian(start: LatticeSolution) -> Array:
    """Jacobian (n, n) of the factors of a solution, scaled back."""
    factors, n = start.factors, len(start.factors.rows)
    lower, upper = np.tril(factors.lu, -1) + np.eye(n), np.triu(factors.lu)
    product = lower.astype(float) @ upper.astype(float)
    for k in range(n - 1, -1, -1):
        other = factors.pivots[k]
        product[[k, other]] = product[[other, k]]
    return np.asarray(product / (factors.rows[:, None] * factors.columns))


def test_steps_are_those_of_explicit_rank_one_updates(model: LatticeContact) -> None:
    _, start = solution(model, DEPTH)
    problem, _ = solution(model, 1.02 * DEPTH)
    values = start.values
    steps = chords(values, problem.of(start.strips), start.factors, 1e-6, np.inf)
    assert steps.converged
    assert steps.evaluations >= 3
    expected, step = broyden(values, problem, start, steps.evaluations)
    assert relative_size(values, steps.values - expected)[0] < 1e-6
    assert relative_size(values, steps.step - step)[0] < 0.2 * steps.size


def test_updates_save_residuals(model: LatticeContact) -> None:
    """Against the same factors without updates, from several approaches to another one."""
    problem, here = solution(model, DEPTH)
    data, updated, plain = problem.of(here.strips), 0, 0
    for nearby in (0.95, 0.97, 1.01, 1.03):
        _, start = solution(model, nearby * DEPTH)
        values = start.values
        steps = chords(values, data, start.factors, 1e-8, np.inf)
        assert steps.converged
        final = moved(steps.values, steps.step, 1.0, data.places.whole)
        assert relative_size(final, final - here.values)[0] < 1e-7
        updated += steps.evaluations
        plain += 1
        step = newton_step(start.factors, evaluate(values, data).residual)
        while relative_size(start.values, step)[0] >= 1e-8:
            values = moved(values, step, 1.0, data.places.whole)
            step = newton_step(start.factors, evaluate(values, data).residual)
            plain += 1
    assert updated < 0.85 * plain


def test_steps_that_contract_slowly_end(model: LatticeContact) -> None:
    """With factors of twice the Jacobian every step leaves half of the error."""
    problem, here = solution(model, DEPTH)
    _, start = solution(model, 1.01 * DEPTH)
    factors = start.factors._replace(columns=0.4 * start.factors.columns)
    steps = chords(start.values, problem.of(here.strips), factors, 1e-8, np.inf)
    assert not steps.converged
    assert steps.first > CONTRACTION
    assert steps.evaluations == 2
