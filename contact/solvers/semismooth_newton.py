"""Semi-smooth Newton method for the tangential problem: damped steps, full steps, bounds held in turn."""

from __future__ import annotations

from contextlib import suppress

import numpy as np

from wheelrail.contact.laws.coulomb import TINY
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions, NotConverged
from wheelrail.contact.solvers.tangential import (
    FrictionProblem,
    FrictionState,
)
from wheelrail.support.arrays import Array, Mask
from wheelrail.support.interrupts import check_interrupt

STALLS = 3  # steps without descent that end an attempt
PATIENCE = 8  # steps that halve the misfit, or an attempt ends
FULL = 15  # steps without damping
ROUNDS = 60  # bounds held in turn
NEAR = 0.1  # of the bound: a misfit from which Newton's method is tried again
CHORD = 0.1  # of the misfit: a step with old factors that leaves more is not worth it


def tangential_contact(
    friction: FrictionProblem, q: Array, active: Mask, options: NewtonOptions, count: IterationCount
) -> FrictionState:
    """Tractions with F(q) = 0 from a guess q (2, n).

    Where pressure depends on friction, descent may creep along a kink of |F|, of a point that begins to slip: full
    steps cross it. Newton may also end in a minimum of |F| that is no zero where friction falls steeply and F folds.
    Then bounds are held and tractions found for them in turn, starting at Coulomb's: the more slip the less friction
    and the less friction the more slip, so these bounds fall in order towards the largest that agree with their own
    slip, and Newton takes over once it is near. Where pressure depends on friction, the same is a contraction. Raises
    NotConverged.
    """
    try:
        return newton(friction, friction.at(q, active, count), options, count)
    except NotConverged:
        if not friction.falls:  # else full steps might find another of several answers
            with suppress(NotConverged):
                return undamped(friction, friction.at(q, active, count), options, count)
        t = friction.at(np.zeros_like(q), active, count)
        bound = t.pressure * t.mu.max()
        for k in range(ROUNDS):
            t = newton(friction, friction.at(t.q, t.active, count, bound), options, count)
            t = friction.at(t.q, t.active, count)
            if k == ROUNDS - 1:
                break
            bound = t.bound
            if t.norm > NEAR * float(np.linalg.norm(bound)):
                continue
            with suppress(NotConverged):
                return newton(friction, t, options, count)
        return newton(friction, t, options, count)


def newton(friction: FrictionProblem, t: FrictionState, options: NewtonOptions, count: IterationCount) -> FrictionState:
    """Semi-smooth Newton with Armijo backtracking from a trial; its bound stays held if it is.

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
            chords = False  # sets change: only new factors know of it
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
    """Newton's full steps from a trial, whether |F| falls or not. Raises NotConverged."""
    for _ in range(min(FULL, options.iterations)):
        check_interrupt()
        count.newton += 1
        t = friction.at(t.q + friction.step(t, options, count), t.active, count)
        scale = max(float(np.linalg.norm(t.bound)), TINY)
        count.residual = t.norm / scale
        if t.norm <= options.tolerance * scale:
            return t
    raise NotConverged(f"friction: relative residual {count.residual:.1e} after {FULL} full steps")
