"""Compiled: Newton's method with the factors of an earlier state, for poses near to it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.solver.factors import Factors, Lapack, newton_step
from wheelrail.contact.models.lattice.system.equations import EquationData, Evaluation, evaluate
from wheelrail.contact.models.lattice.system.state import leaving, longest, moved, relative_size
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import compiled

STEPS = 8  # with the same factors
CONTRACTION = 0.3  # of a step, for another one with the same factors


class ChordState(NamedTuple):
    """Outcome of steps with old factors.

    Parameters:
        converged: whether the last step is below the tolerance.
        values: (S, block), the state.
        leaves: (S,) strips that leave by the next step.
        size: of the next step, relative; infinite where none could be evaluated.
        evaluations: of the residual.
        evaluation: at the values, or at those before the last step.
    """

    converged: bool
    values: Array
    leaves: Mask
    size: float
    evaluations: int
    evaluation: Evaluation


@compiled
def chords(
    values: Array, data: EquationData, factors: Factors, solver: Lapack, tolerance: float, farthest: float
) -> ChordState:
    """Steps from values (S, block) as long as they contract and no strip leaves.

    Parameters:
        values: initial state.
        data: of the equations.
        factors, solver: see `wheelrail.contact.models.lattice.solver.factors.newton_step`.
        tolerance: of the last step, relative; it is taken.
        farthest: first step beyond which the state is of no use.
    """
    none = np.zeros(len(values), dtype=np.bool_)
    evaluation = evaluate(values, data)
    if not evaluation.inside:
        return ChordState(False, values, none, np.inf, 1, evaluation)
    step = newton_step(factors, solver, evaluation.residual)
    size, before = relative_size(values, step)
    if not size < farthest:
        return ChordState(False, values, none, size, 1, evaluation)
    for k in range(STEPS):
        leaves = leaving(values, step, size, data.places.whole)
        if longest(values, step) < 1.0 or leaves.any():
            return ChordState(False, values, leaves, size, k + 1, evaluation)
        trial = moved(values, step, 1.0, data.places.whole)
        if size < tolerance:
            return ChordState(True, trial, none, size, k + 1, evaluation)
        ahead = evaluate(trial, data)
        if not ahead.inside:
            return ChordState(False, values, none, size, k + 2, evaluation)
        step = newton_step(factors, solver, ahead.residual)
        size, after = relative_size(trial, step)
        if after < before:
            values, evaluation = trial, ahead
        if not after < CONTRACTION * before:
            return ChordState(False, values, none, size, k + 2, evaluation)
        before = after
    return ChordState(False, values, none, size, STEPS + 1, evaluation)
