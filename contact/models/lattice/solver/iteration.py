"""Compiled: iterations of Newton's method on fixed strips, with the factors of an earlier state while these serve."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.solver.chords import CONTRACTION, STEPS
from wheelrail.contact.models.lattice.solver.factors import Factors, Lapack, factorised, newton_step
from wheelrail.contact.models.lattice.solver.renewal import renewed
from wheelrail.contact.models.lattice.system.equations import (
    SLOPES,
    EquationData,
    Evaluation,
    evaluate,
    linearised,
    slopes_of_friction,
)
from wheelrail.contact.models.lattice.system.state import leaving, longest, moved, relative_size
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.compiled import compiled

HALVINGS = 6  # of a step in the line search
NEAR = 0.1  # step below which strips may enter
RENEWED = 0.5  # of a step with renewed factors: largest following one with which they are renewed again
CONVERGED, ENTRY, LEAVES, PAUSED, OUTSIDE, SINGULAR, TOO_LONG, NOT_FINITE = range(8)  # events


class KeptFactors(NamedTuple):
    """Factors of an earlier state, and the evaluation of the present one, if they are valid."""

    valid: bool
    factors: Factors
    evaluation: Evaluation


class Limits(NamedTuple):
    """Limits of the iteration.

    Parameters:
        tolerance: of the last step, relative; it is taken.
        farthest: longest first step, relative.
        iterations: linearisations and renewals at most.
    """

    tolerance: float
    farthest: float
    iterations: int


class Progress(NamedTuple):
    """Where the iteration has stopped.

    Parameters:
        event: CONVERGED; ENTRY: near to the solution of these strips, others may enter; LEAVES: strips leave;
            PAUSED: all iterations are used up; OUTSIDE: beyond the surfaces or the tables; SINGULAR: the Jacobian;
            TOO_LONG: the first step; NOT_FINITE: a step.
        values: (S, block), the state.
        leaves: (S,) strips that leave.
        size: of the last step, relative.
        kept: with which the next iteration from these values begins.
        iterations, linearisations, evaluations: numbers of them.
    """

    event: int
    values: Array
    leaves: Mask
    size: float
    kept: KeptFactors
    iterations: int
    linearisations: int
    evaluations: int


class Moved(NamedTuple):
    """State after some steps with the same factors.

    Parameters:
        inside: whether a step could be evaluated.
        values: (S, block).
        step: (S, block), the next one.
        contracts: whether it is shorter than the last one by `CONTRACTION`.
        evaluation: at the values.
        evaluations: number of them.
    """

    inside: bool
    values: Array
    step: Array
    contracts: bool
    evaluation: Evaluation
    evaluations: int


NONE = np.zeros((0, 0), dtype=np.float32)
NO_FACTORS = KeptFactors(
    False,
    Factors(
        NONE,
        np.zeros(0, dtype=np.int32),
        np.zeros(0),
        np.zeros(0),
        np.zeros((0, 0, 0), dtype=np.float32),
        *(np.zeros((0, 0, SLOPES)),) * 2,
        *(NONE,) * 2,
    ),
    Evaluation(
        False, np.zeros((0, 0)), np.zeros((0, 0, 3)), np.zeros((0, 0)), *(np.zeros((0, 2, 0)),) * 2, np.zeros((0, 0))
    ),
)


@compiled
def iterate(
    values: Array, data: EquationData, kept: KeptFactors, entered: bool, limits: Limits, solver: Lapack
) -> Progress:
    """Iterations from values (S, block) until something happens to the strips.

    Parameters:
        values: initial state.
        data: of the equations.
        kept: from an earlier state of the same strips.
        entered: whether strips that may enter have been looked for since the strips changed.
        limits: of the iteration.
        solver: LAPACK's functions.

    As long as steps with old factors contract, the Jacobian is kept. Where they do not since cells have begun to slip
    or to stick, the factors are renewed for these; otherwise the Jacobian is computed anew.
    """
    none = np.zeros(len(values), dtype=np.bool_)
    keeps, factors, evaluation = kept
    linearisations, evaluations, size = 0, 0, np.inf
    for k in range(limits.iterations):
        exact = True
        if keeps:
            slopes = slopes_of_friction(values, evaluation, data)
            fit, factors = renewed(factors, slopes, data.rho, solver)
            exact = not fit
        event = CONVERGED
        if exact:
            at = linearised(values, data)
            linearisations += 1
            evaluation = at.evaluation
            if evaluation.inside:
                regular, factors = factorised(at, solver)
                if not regular:
                    event = SINGULAR
            else:
                event = OUTSIDE
        leaves = none
        if event == CONVERGED:
            step = newton_step(factors, solver, evaluation.residual)
            size, _ = relative_size(values, step)
            if not np.isfinite(size):
                event = NOT_FINITE
            elif k == 0 and size > limits.farthest:
                event = TOO_LONG
            else:
                leaves = leaving(values, step, size, data.places.whole)
                if leaves.any():
                    event = LEAVES
        if event == CONVERGED:
            before = size
            ahead = _moved(values, step, data, factors, evaluation, limits.tolerance, solver)
            evaluations += ahead.evaluations
            if ahead.inside:
                values, evaluation = ahead.values, ahead.evaluation
                size, _ = relative_size(values, ahead.step)
                keeps = exact or size < RENEWED * before
                if size < limits.tolerance and (exact or ahead.contracts):
                    values = moved(values, ahead.step, 1.0, data.places.whole)
                elif size < NEAR and not entered:
                    event = ENTRY
                else:
                    continue
            else:
                event = OUTSIDE
        after = KeptFactors(keeps, factors, evaluation)
        return Progress(event, values, leaves, size, after, k + 1, linearisations, evaluations)
    after = KeptFactors(keeps, factors, evaluation)
    return Progress(PAUSED, values, none, size, after, limits.iterations, linearisations, evaluations)


@compiled
def _moved(
    values: Array,
    step: Array,
    data: EquationData,
    factors: Factors,
    evaluation: Evaluation,
    tolerance: float,
    solver: Lapack,
) -> Moved:
    """State after a step and further ones with the same factors while they contract.

    Affine-invariant line search: Deuflhard, Newton Methods for Nonlinear Problems, 2011, sec. 3.3.
    """
    evaluations, contracts = 0, False
    for _ in range(STEPS):
        _, before = relative_size(values, step)
        factor = longest(values, step)
        best, after = np.inf, np.inf
        start, direction = values, step
        inside = False
        for _ in range(HALVINGS):
            trial = moved(start, direction, factor, data.places.whole)
            evaluations += 1
            ahead = evaluate(trial, data)
            if not ahead.inside:
                factor *= 0.5
                continue
            following = newton_step(factors, solver, ahead.residual)
            _, after = relative_size(start, following)
            if not inside or after < best:
                inside, best = True, after
                values, step, evaluation = trial, following, ahead
            if after <= (1 - 0.25 * factor) * before:
                break
            factor *= 0.5
        if not inside:
            return Moved(False, values, step, False, evaluation, evaluations)
        size, _ = relative_size(values, step)
        contracts = factor == 1.0 and best < CONTRACTION * before
        if size < tolerance or not contracts or leaving(values, step, size, data.places.whole).any():
            break
    return Moved(True, values, step, contracts, evaluation, evaluations)
