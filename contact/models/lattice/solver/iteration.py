"""Compiled: iterations of Newton's method on fixed strips, with the factors of an earlier state while these serve."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.solver.chords import Steps, further_steps
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
from wheelrail.support.compiled import inlined

HALVINGS = 6  # of a step in the line search
DECREASE = 0.25  # of the following step, of that of the linearised equations
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


@inlined
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
            ahead = _searched(values, step, data, factors, evaluation, limits.tolerance, solver)
            evaluations += ahead.evaluations
            if np.isfinite(ahead.first) or ahead.converged:
                values, evaluation, size, leaves = ahead.values, ahead.evaluation, ahead.size, ahead.leaves
                keeps = exact or size < RENEWED * before
                if ahead.converged:
                    values = moved(values, ahead.step, 1.0, data.places.whole)
                elif leaves.any():
                    event = LEAVES
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


@inlined
def _searched(
    values: Array,
    step: Array,
    data: EquationData,
    factors: Factors,
    evaluation: Evaluation,
    tolerance: float,
    solver: Lapack,
) -> Steps:
    """State after a step, which is shortened where the following one is not shorter, and further full ones.

    Affine-invariant line search: Deuflhard, Newton Methods for Nonlinear Problems, 2011, sec. 3.3.
    """
    ahead = further_steps(values, step, evaluation, data, factors, solver, tolerance)
    if ahead.converged or ahead.first <= 1.0 - DECREASE:
        return ahead
    evaluations = ahead.evaluations
    best = ahead if ahead.first < 1.0 else Steps(*ahead[:5], np.inf, *ahead[6:])
    _, before = relative_size(values, step)
    factor = longest(values, step)
    if factor == 1.0:
        factor = 0.5
    for _ in range(HALVINGS):
        trial = moved(values, step, factor, data.places.whole)
        evaluations += 1
        there = evaluate(trial, data)
        if there.inside:
            following = newton_step(factors, solver, there.residual)
            size, after = relative_size(values, following)
            if not after / before > best.first:
                best = Steps(False, trial, following, ahead.leaves, size, after / before, there, 0)
            if after <= (1.0 - DECREASE * factor) * before:
                break
        factor *= 0.5
    return Steps(*best[:-1], evaluations)
