"""Newton's method on all unknowns of the contact on a lattice, and strips that enter and leave."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from wheelrail.bindings._contact import (
    CONVERGED,
    LEAVES,
    NOT_FINITE,
    OUTSIDE,
    PAUSED,
    SINGULAR,
    TOO_LONG,
    Advance,
    Factors,
    KeptFactors,
    Limits,
    Progress,
    advance,
)
from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG as TOO_FAR
from wheelrail.contact.models.lattice.solver.entry import UNCERTAIN, entered, entering, overlaps, probes_of
from wheelrail.contact.models.lattice.solver.factors import NO_FACTORS, lapack
from wheelrail.contact.models.lattice.solver.factors import SINGULAR as SINGULAR_JACOBIAN
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState
from wheelrail.contact.solvers.options import IterationCount, NotConverged
from wheelrail.support.arrays import Mask
from wheelrail.support.interrupts import check_interrupt

log = logging.getLogger(__name__)

EXCHANGES = 3  # times that a strip may leave before it must stay out, for the time being
UNINTERRUPTED = 1e9  # multiplications of factorisations without a look at Ctrl-C: 0.1 s
RELEASES = 2  # times that such strips may enter again
FAILURES = {
    SINGULAR: SINGULAR_JACOBIAN,
    TOO_LONG: "the first step is too long",
    NOT_FINITE: "the step of the contact is not finite",
}


@dataclass(eq=False)
class LatticeSolution:
    """Converged state, and factors of a Jacobian near to it, with which the solution at the next pose begins."""

    state: LatticeState
    factors: Factors


class LatticeNewton:
    """Iteration from a state to the solution of a problem.

    Parameters:
        problem: equations.
        tolerance: of the last step relative to the largest pressure amplitude and half length.
        count: of iterations, updated: linearisations, and evaluations of the residual as linear iterations.
    """

    def __init__(self, problem: LatticeProblem, tolerance: float, count: IterationCount) -> None:
        self.problem, self.tolerance, self.count = problem, tolerance, count
        self._left: dict[int, int] = {}
        self._releases = 0

    def solve(
        self, state: LatticeState, iterations: int, farthest: float = np.inf, first: Advance | None = None
    ) -> LatticeSolution:
        """Solution from a state.

        Parameters:
            state: strips and unknowns.
            iterations: linearisations at most.
            farthest: longest first step, relative.
            first: iterations from this state that have been made already.

        Raises NotConverged, also if the first step exceeds farthest, and OutsideSurface.
        """
        entered, done, kept = False, 0, NO_FACTORS  # whether strips have entered since they last changed; iterations
        while True:
            if first is None:
                first = self._advanced(state, kept, entered, Limits(self.tolerance, farthest, iterations - done))
            ahead, at, first = first, self._counted(first.progress), None
            farthest = np.inf if at.iterations else farthest
            done += at.iterations
            state, kept = LatticeState(state.strips, at.values), at.kept
            log.debug("iteration %d: step %.1e, %d strips", done, at.size, len(state.strips))
            if at.event == LEAVES:
                state, kept, entered = self._without(state, at.leaves, at.iterations > 0), NO_FACTORS, False
            elif at.event != PAUSED:
                grown = self._entered(state, ahead)
                if grown is None and at.event == CONVERGED:
                    grown = self._released(state)
                    if grown is None:
                        self.count.residual = at.size
                        return LatticeSolution(state, kept.factors)
                entered = grown is None
                if grown is not None:
                    state, kept = grown, NO_FACTORS

    def from_earlier(self, earlier: LatticeSolution, iterations: int, farthest: float) -> LatticeSolution:
        """Solution from that of another pose on the same strips.

        Parameters:
            earlier: solution.
            iterations, farthest: see `solve`.

        Raises NotConverged, also if the first step exceeds farthest, and OutsideSurface.
        """
        kept, limits = NO_FACTORS._replace(factors=earlier.factors), Limits(self.tolerance, farthest, iterations)
        return self.solve(earlier.state, iterations, farthest, self._advanced(earlier.state, kept, False, limits, True))

    def _advanced(
        self, state: LatticeState, kept: KeptFactors, entered: bool, limits: Limits, earlier: bool = False
    ) -> Advance:
        """Some iterations, as many as take no long time without a look at Ctrl-C. Raises NotConverged."""
        check_interrupt()
        if not limits.iterations:
            raise NotConverged(f"Newton's method did not converge ({len(state.strips)} strips)")
        problem, some = self.problem, min(limits.iterations, max(1, int(UNINTERRUPTED / state.values.size**3)))
        data, probes, barred = problem.of(state.strips), probes_of(problem), np.array(sorted(self._barred), dtype=int)
        at = state.values, data, kept, earlier, entered, limits._replace(iterations=some), lapack()
        return advance(*at, probes, problem.lines, barred)

    def _counted(self, at: Progress) -> Progress:
        """Iterations, counted. Raises NotConverged and OutsideSurface where they failed."""
        self.count.newton += at.linearisations
        self.count.linear += at.evaluations
        if at.event == OUTSIDE:
            raise OutsideSurface(TOO_FAR)
        if at.event in FAILURES:
            raise NotConverged(f"{FAILURES[at.event]} (last step {at.size:.1e})")
        return at

    def _without(self, state: LatticeState, leaves: Mask, counts: bool) -> LatticeState:
        """The state without strips (S,) that leave, which may count. Raises NotConverged if none remains."""
        if leaves.all():
            raise NotConverged("no strip remains loaded")
        for strip in state.strips[leaves].tolist() if counts else ():
            self._left[strip] = self._left.get(strip, 0) + 1
        log.debug("strips %s leave", state.strips[leaves])
        return state.at(~leaves)

    def _released(self, state: LatticeState) -> LatticeState | None:
        """The state with strips that enter although they had left too often; None without any.

        Raises NotConverged when that has happened before: a solution must not depend on what was tried.
        """
        if not self._barred:
            return None
        new = entering(self.problem, state, set(), UNCERTAIN)
        if new is None:
            return None
        self._left.clear()
        self._releases += 1
        if self._releases > RELEASES:
            raise NotConverged("strips of the contact come and go")
        log.debug("strips %s enter again", new.strips)
        return state.joined(new)

    @property
    def _barred(self) -> set[int]:
        """Strips that have left too often."""
        return {strip for strip, times in self._left.items() if times >= EXCHANGES}

    def _entered(self, state: LatticeState, at: Advance) -> LatticeState | None:
        """The state with strips that enter; None without any."""
        if at.complete:
            new = entered(self.problem, state, overlaps(self.problem, at.rest))
        else:
            new = entering(self.problem, state, self._barred)
        if new is None:
            return None
        log.debug("strips %s enter", new.strips)
        return state.joined(new)
