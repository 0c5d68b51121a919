"""Compiled: iterations until something happens to the strips, and the strips that enter then."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.solver.chords import chords
from wheelrail.contact.models.lattice.solver.factors import Lapack, fit
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
from wheelrail.contact.models.lattice.solver.remaining import Probes, Remaining, nothing_known, search
from wheelrail.contact.models.lattice.system.contact_lines import ContactLines
from wheelrail.contact.models.lattice.system.equations import EquationData
from wheelrail.contact.models.lattice.system.state import moved
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled


class Advance(NamedTuple):
    """Iterations and, where others than the loaded strips may enter, what these leave on them.

    Parameters:
        progress: of the iteration.
        complete: whether the remaining penetration is known; False where it is not asked for or lacks tables.
        rest: remaining penetration of the strips that may enter.
    """

    progress: Progress
    complete: bool
    rest: Remaining


@compiled
def advance(
    values: Array,
    data: EquationData,
    kept: KeptFactors,
    earlier: bool,
    entered: bool,
    limits: Limits,
    solver: Lapack,
    probes: Probes,
    lines: ContactLines,
    barred: Nodes,
) -> Advance:
    """Iterations from values (S, block) until something happens to the strips and, where they converge or others may
    enter, `search` of these.

    Parameters:
        values: initial state.
        data: of the equations.
        kept: factors of an earlier state of the same strips.
        earlier: whether these are values and factors of the solution at another pose: the first steps are taken with
            them, and are no iterations. There is none if the factors are not those of as many unknowns.
        entered, limits, solver: see `iterate`.
        probes, lines, barred: see `search`.
    """
    none, evaluations, goes_on = np.zeros(len(values), dtype=np.bool_), 0, not earlier
    progress = Progress(TOO_LONG, values, none, np.inf, kept, 0, 0, 0)
    cells = len(data.basis.marks) - 1 if data.motion.speed > 0.0 else 0
    if earlier and fit(kept.factors, len(values), cells, values.shape[1]):
        steps = chords(values, data, kept.factors, solver, limits.tolerance, limits.farthest)
        values, evaluations = steps.values, steps.evaluations
        kept = KeptFactors(True, kept.factors, steps.evaluation)
        if steps.converged:
            last = moved(values, steps.step, 1.0, data.places.whole)
            progress = Progress(CONVERGED, last, none, steps.size, kept, 0, 0, evaluations)
        elif steps.leaves.any():
            progress = Progress(LEAVES, values, steps.leaves, steps.size, kept, 0, 0, evaluations)
        elif not steps.size < limits.farthest:
            progress = Progress(TOO_LONG, values, none, steps.size, kept, 0, 0, evaluations)
        else:
            goes_on = True
    if goes_on:
        ahead = iterate(values, data, kept, entered, limits, solver)
        progress = Progress(*ahead[:-1], ahead.evaluations + evaluations)
    if progress.event == CONVERGED or progress.event == ENTRY:
        complete, rest, _ = search(progress.values, data, probes, lines, barred)
        return Advance(progress, complete, rest)
    return Advance(progress, False, nothing_known())
