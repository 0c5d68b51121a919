"""Newton's method on all unknowns of the contact on a lattice, and strips that enter and leave."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from wheelrail.contact.kinematics.contact_points import OutsideSurface
from wheelrail.contact.models.lattice.influence.strip_operators import TOO_LONG
from wheelrail.contact.models.lattice.solver.chords import CONTRACTION, STEPS
from wheelrail.contact.models.lattice.solver.entry import UNCERTAIN, entering
from wheelrail.contact.models.lattice.solver.factors import Factors
from wheelrail.contact.models.lattice.solver.renewal import renewed
from wheelrail.contact.models.lattice.system.equations import Evaluation
from wheelrail.contact.models.lattice.system.problem import LatticeProblem
from wheelrail.contact.models.lattice.system.state import LatticeState, leaving, longest, relative_size
from wheelrail.contact.solvers.options import IterationCount, NotConverged
from wheelrail.support.arrays import Array
from wheelrail.support.interrupts import check_interrupt

log = logging.getLogger(__name__)

HALVINGS = 6  # of a step in the line search
NEAR = 0.1  # step below which strips may enter
EXCHANGES = 3  # times that a strip may leave before it must stay out, for the time being
RENEWED = 0.5  # of a step with renewed factors: largest following one with which they are renewed again
RELEASES = 2  # times that such strips may enter again


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

    As long as steps with old factors contract, the Jacobian is kept. Where they do not since cells have begun to slip
    or to stick, the factors are renewed for these; otherwise the Jacobian is computed anew.
    """

    def __init__(self, problem: LatticeProblem, tolerance: float, count: IterationCount) -> None:
        self.problem, self.tolerance, self.count = problem, tolerance, count
        self._left: dict[int, int] = {}
        self._releases = 0

    def solve(
        self,
        state: LatticeState,
        iterations: int,
        farthest: float = np.inf,
        kept: tuple[Factors, Evaluation] | None = None,
    ) -> LatticeSolution:
        """Solution from a state.

        Parameters:
            state: strips and unknowns.
            iterations: linearisations at most.
            farthest: longest first step, relative.
            kept: factors of an earlier state of the same strips, and the evaluation of this one with their rho.

        Raises NotConverged, also if the first step exceeds farthest, and OutsideSurface.
        """
        checked = False  # for strips that enter, since the last change of the set
        for iteration in range(iterations):
            check_interrupt()
            factors, evaluation, exact = self._linearised(state, kept)
            step = factors.step(evaluation.residual)
            size, _ = relative_size(state.values, step)
            if not np.isfinite(size):
                raise NotConverged("the step of the contact is not finite")
            if iteration == 0 and size > farthest:
                raise NotConverged(f"the first step, {size:.1e}, is too long")
            log.debug("iteration %d: step %.1e, %d strips", iteration, size, len(state.strips))
            remains = ~leaving(state.values, step, size)
            if not remains.all():
                if not remains.any():
                    raise NotConverged("no strip remains loaded")
                for strip in state.strips[~remains]:
                    self._left[int(strip)] = self._left.get(int(strip), 0) + 1
                log.debug("strips %s leave", state.strips[~remains])
                state, checked, kept = state.at(remains), False, None
                continue
            before = size
            state, step, contracts, evaluation = self._moved(state, step, factors, evaluation)
            size, _ = relative_size(state.values, step)
            kept = (factors, evaluation) if exact or size < RENEWED * before else None
            converged = size < self.tolerance and (exact or contracts)
            if converged:
                state = state.moved(step, 1.0)
            if converged or (size < NEAR and not checked):
                grown = self._entered(state)
                if grown is not None:
                    state, checked, kept = grown, False, None
                elif converged:
                    grown = self._released(state)
                    if grown is None:
                        self.count.residual = size
                        return LatticeSolution(state, factors)
                    state, checked, kept = grown, False, None
                else:
                    checked = True
        raise NotConverged(f"Newton's method did not converge in {iterations} iterations (last step {size:.1e})")

    def _linearised(
        self, state: LatticeState, kept: tuple[Factors, Evaluation] | None
    ) -> tuple[Factors, Evaluation, bool]:
        """Factors at a state, its evaluation, and whether they are those of its Jacobian; otherwise only the friction
        of the cells is that of the state.
        """
        if kept is not None:
            factors, evaluation = kept
            slopes = self.problem.friction_slopes(state, evaluation, factors.rho)
            present = renewed(factors, slopes, self.problem.basis.mean)
            if present is not None:
                return present, evaluation, False
        linearisation = self.problem.linearise(state)
        self.count.newton += 1
        return Factors.of(linearisation), linearisation.evaluation, True

    def _moved(
        self, state: LatticeState, step: Array, factors: Factors, evaluation: Evaluation
    ) -> tuple[LatticeState, Array, bool, Evaluation]:
        """State after a step and further ones with the same factors while they contract; the next one, whether it
        contracts, and the evaluation. Raises OutsideSurface.

        Affine-invariant line search: Deuflhard, Newton Methods for Nonlinear Problems, 2011, sec. 3.3.
        """
        for _ in range(STEPS):
            _, before = relative_size(state.values, step)
            factor = longest(state.values, step)
            best: tuple[float, LatticeState, Array, Evaluation] | None = None
            for _ in range(HALVINGS):
                trial = state.moved(step, factor)
                self.count.linear += 1
                try:
                    evaluation = self.problem.evaluate(trial, factors.rho)
                except OutsideSurface:
                    factor *= 0.5
                    continue
                following = factors.step(evaluation.residual)
                _, after = relative_size(state.values, following)
                if best is None or after < best[0]:
                    best = after, trial, following, evaluation
                if after <= (1 - 0.25 * factor) * before:
                    break
                factor *= 0.5
            if best is None:
                raise OutsideSurface(TOO_LONG)
            after, state, step, evaluation = best
            size, _ = relative_size(state.values, step)
            contracts = factor == 1.0 and after < CONTRACTION * before
            if size < self.tolerance or not contracts:
                break
            if leaving(state.values, step, size).any():
                break
        return state, step, contracts, evaluation

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

    def _entered(self, state: LatticeState) -> LatticeState | None:
        """The state with strips that enter; None without any."""
        new = entering(self.problem, state, self._barred)
        if new is None:
            return None
        log.debug("strips %s enter", new.strips)
        return state.joined(new)
