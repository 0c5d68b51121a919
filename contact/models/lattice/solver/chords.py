"""Compiled: steps with the same factors, those of an earlier state or of a Jacobian that is still close enough.

Broyden's good method: every step corrects the Jacobian by a rank-one update, so that steps contract the faster, the
more of them there are. P. Deuflhard, Newton Methods for Nonlinear Problems, 2011, sec. 2.1.4 (QNERR).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.solver.factors import Factors, Lapack, newton_step
from wheelrail.contact.models.lattice.system.equations import EquationData, Evaluation, evaluate
from wheelrail.contact.models.lattice.system.state import inner_product, leaving, longest, moved, relative_size
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import compiled, inlined

STEPS = 8  # with the same factors
CONTRACTION = 0.5  # of a step, for another one with the same factors: Deuflhard's
LEFT = 0.3  # of the tolerance, error left by the last step if the following ones contracted like it


class Steps(NamedTuple):
    """State after some steps with the same factors.

    Parameters:
        converged: whether the next step is below the tolerance, and what it will leave below `LEFT` times that.
        values: (S, block), the state.
        step: (S, block), the next one.
        leaves: (S,) strips that leave by it.
        size: its relative size; infinite where none could be evaluated.
        first: relative size of the step after the first one over that; infinite if it could not be evaluated.
        evaluation: at the values.
        evaluations: of the residual.
    """

    converged: bool
    values: Array
    step: Array
    leaves: Mask
    size: float
    first: float
    evaluation: Evaluation
    evaluations: int


@inlined
def chords(
    values: Array, data: EquationData, factors: Factors, solver: Lapack, tolerance: float, farthest: float
) -> Steps:
    """Steps from values (S, block) with the factors of an earlier state.

    Parameters:
        values: initial state.
        data: of the equations.
        factors, solver: see `wheelrail.contact.models.lattice.solver.factors.newton_step`.
        tolerance: of the last step, relative.
        farthest: first step beyond which the state is of no use.
    """
    evaluation = evaluate(values, data)
    none = np.zeros(len(values), dtype=np.bool_)
    if not evaluation.inside:
        return Steps(False, values, values, none, np.inf, np.inf, evaluation, 1)
    step = newton_step(factors, solver, evaluation.residual)
    size, _ = relative_size(values, step)
    if not size < farthest:
        return Steps(False, values, step, none, size, np.inf, evaluation, 1)
    ahead = further_steps(values, step, evaluation, data, factors, solver, tolerance)
    return Steps(*ahead[:-1], ahead.evaluations + 1)


@compiled
def further_steps(
    values: Array,
    step: Array,
    evaluation: Evaluation,
    data: EquationData,
    factors: Factors,
    solver: Lapack,
    tolerance: float,
) -> Steps:
    """Full steps as long as they contract, no strip leaves or grows too much, and the state has not converged.

    Parameters:
        values, step: (S, block), initial state and first step.
        evaluation: at the initial state.
        data, factors, solver, tolerance: see `chords`.
    """
    start, whole = values, data.places.whole
    steps, squares = np.empty((STEPS, *values.shape)), np.empty(STEPS)
    size, before = relative_size(start, step)
    first, rate, k = np.inf, 0.0, 0
    while True:
        leaves = leaving(values, step, size, whole)
        converged = size < tolerance and size * rate < LEFT * tolerance * (1.0 - rate)
        if converged or k == STEPS or leaves.any() or longest(values, step) < 1.0:
            break
        trial = moved(values, step, 1.0, whole)
        ahead = evaluate(trial, data)
        steps[k], squares[k] = step, before * before
        k += 1
        if not ahead.inside:
            break
        following = newton_step(factors, solver, ahead.residual)
        for i in range(1, k):
            following += inner_product(start, following, steps[i - 1]) / squares[i - 1] * steps[i]
        size_after, after = relative_size(start, following)
        rate = after / before
        if k == 1:
            first = rate
        if rate < 1.0:
            values, step, evaluation, size = trial, following, ahead, size_after
        if not rate < CONTRACTION:
            break
        step = following / (1.0 - inner_product(start, following, steps[k - 1]) / squares[k - 1])
        size, before = relative_size(start, step)
    return Steps(converged and not leaves.any(), values, step, leaves, size, first, evaluation, k)
