"""Compiled: solution from that of another pose, where its factors serve until the end."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from wheelrail.contact.models.lattice.solver.chords import Steps, chords
from wheelrail.contact.models.lattice.solver.factors import Factors, Lapack, fit
from wheelrail.contact.models.lattice.solver.remaining import Probes, Remaining, search
from wheelrail.contact.models.lattice.system.contact_lines import ContactLines
from wheelrail.contact.models.lattice.system.equations import EquationData, evaluate
from wheelrail.contact.models.lattice.system.state import moved
from wheelrail.support.arrays import Array, Nodes
from wheelrail.support.compiled import compiled


class WarmStart(NamedTuple):
    """Steps with the factors of an earlier solution and, where they converge, what follows.

    Parameters:
        steps: as far as they go; where they converge, the last one is taken.
        complete: whether there are tables for all strips that may enter; False where the steps do not converge.
        rest: remaining penetration of these strips.
        known: (n,) strips whose tables are needed.
    """

    steps: Steps
    complete: bool
    rest: Remaining
    known: Nodes


@compiled
def warm_start(
    values: Array,
    data: EquationData,
    factors: Factors,
    solver: Lapack,
    tolerance: float,
    farthest: float,
    probes: Probes,
    lines: ContactLines,
) -> WarmStart:
    """`chords` from values (S, block) and, where they converge, `search` of the strips that enter.

    There is no step if the factors are not those of as many unknowns.

    Parameters:
        values, data, factors, solver, tolerance, farthest: see `chords`.
        probes, lines: see `search`.
    """
    nobody, none = np.zeros(0, dtype=np.int64), np.zeros(0)
    if fit(factors, len(values), len(data.basis.marks) - 1 if data.motion.speed > 0.0 else 0, values.shape[1]):
        steps = chords(values, data, factors, solver, tolerance, farthest)
    else:
        stay = np.zeros(len(values), dtype=np.bool_)
        steps = Steps(False, values, values, stay, np.inf, np.inf, evaluate(values, data), 1)
    if not steps.converged:
        return WarmStart(steps, False, Remaining(False, nobody, none, none, none, none, none), nobody)
    values = moved(steps.values, steps.step, 1.0, data.places.whole)
    complete, rest, known = search(values, data, probes, lines, nobody)
    taken = Steps(True, values, *steps[2:])
    return WarmStart(taken, complete, rest, known)
