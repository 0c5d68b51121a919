"""Semi-smooth Newton method for the tangential problem: damped, undamped, and with iterated friction bounds."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from wheelrail.contact.solvers.options import TINY, IterationCount, NewtonOptions, NotConverged
from wheelrail.contact.solvers.tangential import (
    FrictionProblem,
    FrictionState,
)
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.interrupts import check_interrupt

STALLS = 3  # steps without descent that end the iteration
PATIENCE = 8  # steps within which the residual must halve
FULL = 15  # steps without damping
BOUND_ITERATIONS = 60  # of the fixed-point iteration of the friction bounds
NEAR = 0.1  # of the bound: residual below which Newton's method is tried again
CHORD = 0.1  # largest reduction of the residual at which a step with old factors is accepted


def tangential_contact(
    friction: FrictionProblem, q: Array, active: Mask, options: NewtonOptions, count: IterationCount
) -> FrictionState:
    """Tractions with F(q) = 0.

    Parameters:
        friction: F and its derivative.
        q: (2, n) Pa, initial guess.
        active: (n,) initial guess of the active points.
        options: tolerances.
        count: of iterations, updated.

    Where pressure depends on friction, damped steps may converge slowly along a kink of |F| of a point that begins to
    slip: full steps cross it. Where friction falls steeply, F folds and Newton may end in a local minimum of |F| that
    is no zero. Then the tractions are solved for fixed bounds and the bounds updated, starting with Coulomb's: more
    slip means less friction and less friction more slip, so that the bounds decrease monotonically to the largest that
    agree with their own slip; Newton takes over near it. Where pressure depends on friction, the same iteration is a
    contraction. Raises NotConverged.
    """
    try:
        return newton(friction, friction.at(q, active, count), options, count)
    except NotConverged:
        if not friction.depends_on_speed:  # full steps could converge to another of several solutions
            with suppress(NotConverged):
                return undamped(friction, friction.at(q, active, count), options, count)
        t = friction.at(np.zeros_like(q), active, count)
        bound = friction.bound_at_rest(t.pressure)
        for k in range(BOUND_ITERATIONS):
            t = newton(friction, friction.at(t.q, t.active, count, bound), options, count)
            t = friction.at(t.q, t.active, count)
            if k == BOUND_ITERATIONS - 1:
                break
            bound = t.bound
            if t.norm > NEAR * float(np.linalg.norm(bound)):
                continue
            with suppress(NotConverged):
                return newton(friction, t, options, count)
        return newton(friction, t, options, count)


def newton(friction: FrictionProblem, t: FrictionState, options: NewtonOptions, count: IterationCount) -> FrictionState:
    """Semi-smooth Newton with Armijo backtracking from a state; its bound stays fixed if held.

    Raises NotConverged.
    """
    stalls, chords, norms = 0, options.linear == "lu", list[float]()
    for k in range(options.iterations):
        check_interrupt()
        scale = max(float(np.linalg.norm(t.bound)), TINY)
        count.residual = t.norm / scale
        norms.append(t.norm)
        if k >= PATIENCE and t.norm > 0.5 * norms[k - PATIENCE]:
            break
        if t.norm <= options.tolerance * scale:
            return t
        if stalls == STALLS:
            break
        step = friction.chord(t, count) if chords else None
        if step is not None:
            trial = friction.at(t.q + step, t.active, count)
            if trial.norm <= CHORD * t.norm:
                t = trial
                continue
            chords = False  # the sets of sticking and sliding points change: new factors are needed
        count.newton += 1
        step, damping = friction.step(t, options, count), 1.0
        while True:
            trial = friction.at(t.q + damping * step, t.active, count, t.bound if t.held else None)
            if trial.norm <= (1 - 1e-4 * damping) * t.norm:
                break
            if damping < 1e-3:
                stalls += 1
                break
            damping /= 2
        t = trial
    raise NotConverged(f"friction: relative residual {count.residual:.1e} after {count.newton} Newton steps")


def undamped(
    friction: FrictionProblem, t: FrictionState, options: NewtonOptions, count: IterationCount
) -> FrictionState:
    """Full Newton steps from a state, without descent of |F|. Raises NotConverged."""
    for _ in range(min(FULL, options.iterations)):
        check_interrupt()
        count.newton += 1
        t = friction.at(t.q + friction.step(t, options, count), t.active, count)
        scale = max(float(np.linalg.norm(t.bound)), TINY)
        count.residual = t.norm / scale
        if t.norm <= options.tolerance * scale:
            return t
    raise NotConverged(f"friction: relative residual {count.residual:.1e} after {FULL} full steps")
