"""Compiled: iterations until something happens to the strips, and the strips that enter then."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.solver.chords import chords
from wheelrail.contact.models.lattice.solver.factors import Factors, Lapack, fit
from wheelrail.contact.models.lattice.solver.iteration import (
    CONVERGED,
    ENTRY,
    LEAVES,
    TOO_LONG,
    KeptFactors,
    Limits,
    Progress,
    iterate,
)
from wheelrail.contact.models.lattice.solver.remaining import Probes, Remaining, search
from wheelrail.contact.models.lattice.system.contact_lines import ContactLines
from wheelrail.contact.models.lattice.system.equations import EquationData, evaluate
from wheelrail.contact.models.lattice.system.state import moved
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled


class Advance(NamedTuple):
    """Iterations and, where others than the loaded strips may enter, what these leave on them.

    Parameters:
        progress: of the iteration.
        complete: whether the remaining penetration is known; False where it is not asked for or lacks tables.
        rest: remaining penetration of the strips that may enter.
        known: (n,) strips whose tables are needed.
    """

    progress: Progress
    complete: bool
    rest: Remaining
    known: Nodes


@compiled
def advance(
    values: Array,
    data: EquationData,
    kept: KeptFactors,
    entered: bool,
    limits: Limits,
    solver: Lapack,
    probes: Probes,
    lines: ContactLines,
    barred: Nodes,
) -> Advance:
    """`iterate` from values (S, block) and, where it converges or others may enter, `search` of these."""
    return _searched(iterate(values, data, kept, entered, limits, solver), data, probes, lines, barred)


@compiled
def warm_start(
    values: Array,
    data: EquationData,
    factors: Factors,
    limits: Limits,
    solver: Lapack,
    probes: Probes,
    lines: ContactLines,
) -> Advance:
    """As `advance`, from the values of an earlier solution, first by steps with its factors: these are no iterations.

    Parameters:
        values: (S, block), of the earlier solution.
        data: of the equations.
        factors: of the earlier solution; there is no step if they are not those of as many unknowns.
        limits: of the iteration; none of its first steps is longer than the farthest.
        solver: LAPACK's functions.
        probes, lines: see `search`.
    """
    none, nobody = np.zeros(len(values), dtype=np.bool_), np.zeros(0, dtype=np.int64)
    if not fit(factors, len(values), len(data.basis.marks) - 1 if data.motion.speed > 0.0 else 0, values.shape[1]):
        kept = KeptFactors(False, factors, evaluate(values, data))
        return _searched(Progress(TOO_LONG, values, none, np.inf, kept, 0, 0, 1), data, probes, lines, nobody)
    steps = chords(values, data, factors, solver, limits.tolerance, limits.farthest)
    kept, counts = KeptFactors(True, factors, steps.evaluation), (0, 0, steps.evaluations)
    if steps.converged:
        last = moved(steps.values, steps.step, 1.0, data.places.whole)
        progress = Progress(CONVERGED, last, none, steps.size, kept, *counts)
    elif steps.leaves.any():
        progress = Progress(LEAVES, steps.values, steps.leaves, steps.size, kept, *counts)
    elif not steps.size < limits.farthest:
        progress = Progress(TOO_LONG, steps.values, none, steps.size, kept, *counts)
    else:
        ahead = iterate(steps.values, data, kept, False, limits, solver)
        progress = Progress(*ahead[:-1], ahead.evaluations + steps.evaluations)
    return _searched(progress, data, probes, lines, nobody)


@compiled
def _searched(progress: Progress, data: EquationData, probes: Probes, lines: ContactLines, barred: Nodes) -> Advance:
    """An iteration, and `search` of the strips that may enter after it."""
    if progress.event == CONVERGED or progress.event == ENTRY:
        return Advance(progress, *search(progress.values, data, probes, lines, barred))
    nobody, none = barred[:0], np.zeros(0)
    return Advance(progress, False, Remaining(False, nobody, none, none, none, none, none), nobody)
