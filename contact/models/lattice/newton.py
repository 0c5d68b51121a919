"""Newton's method on all unknowns of the contact on a lattice, and strips that enter and leave."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from wheelrail.contact.models.lattice.basis import MODES, MOMENTS
from wheelrail.contact.models.lattice.entry import entering
from wheelrail.contact.models.lattice.problem import Evaluation, LatticeProblem
from wheelrail.contact.models.lattice.state import LatticeState
from wheelrail.contact.solvers.options import IterationCount, NotConverged
from wheelrail.support.arrays import Array, Mask

log = logging.getLogger(__name__)

STRESS, LENGTH, GAP = 1e9, 1e-3, 1e-6  # Pa, m, m: scales of the unknowns and of the moments
ITERATIONS = 60
HALVINGS = 6  # of a step in the line search
NEAR = 0.1  # step below which strips may enter
LONGEST = 3.0  # largest relative growth of a squared half length in one step
EXCHANGES = 3  # times that a strip may leave before it must stay out


@dataclass(frozen=True)
class LatticeSolution:
    """Converged state with its evaluation, the Jacobian (n, n) one step before, rho (S, M) of the friction residual, and
    the size of that step.
    """

    state: LatticeState
    evaluation: Evaluation
    jacobian: Array
    rho: Array
    step: float


class LatticeNewton:
    """Iteration from a state to the solution of a problem.

    Parameters:
        problem: equations.
        tolerance: of the last step relative to the largest pressure amplitude and half length.
        count: of iterations, updated.
    """

    def __init__(self, problem: LatticeProblem, tolerance: float, count: IterationCount) -> None:
        self.problem, self.tolerance, self.count = problem, tolerance, count
        self._left: dict[int, int] = {}

    def solve(self, state: LatticeState, farthest: float = np.inf) -> LatticeSolution | None:
        """Solution from a state; None if the first step exceeds farthest or no strip remains loaded.

        Raises NotConverged, OutsideSurface.
        """
        for iteration in range(ITERATIONS):
            evaluation, jacobian, rho = self.problem.linearise(state)
            self.count.newton += 1
            factors = la.lu_factor(_scaled(jacobian, state), check_finite=False)
            step = _solved(factors, -evaluation.residual)
            size = _size(step, state)
            if not np.isfinite(size):
                raise NotConverged("the Jacobian of the contact is singular")
            if iteration == 0 and size > farthest:
                return None
            log.debug("iteration %d: step %.1e, %d strips", iteration, size, len(state.strips))
            if size < self.tolerance:
                grown = self._entered(state)
                if grown is None:
                    self.count.residual = size
                    state = state.moved(step, 1.0)
                    return LatticeSolution(state, self.problem.evaluate(state, rho), jacobian, rho, size)
                state = grown
                continue
            remains = self._remain(state, step)
            if not remains.all():
                if not remains.any():
                    return None
                for strip in state.strips[~remains]:
                    self._left[int(strip)] = self._left.get(int(strip), 0) + 1
                log.debug("strips %s leave", state.strips[~remains])
                state = state.at(remains)
                continue
            state, factor = self._searched(state, step, rho, factors)
            if factor == 1.0 and size < NEAR:
                state = self._entered(state) or state
        raise NotConverged(f"Newton's method did not converge in {ITERATIONS} iterations (last step {size:.1e})")

    def _remain(self, state: LatticeState, step: Array) -> Mask:
        """Strips (S,) that stay loaded: those whose load and length remain positive after a full step."""
        half, change = state.half, 0.5 * (step[:, -1] - step[:, -2])
        amplitude = state.modes[:, 0] + step[:, -2 - MODES]
        load = state.modes[:, 0] * half + step[:, -2 - MODES] * half + state.modes[:, 0] * change
        small = half < 0.3 * half.max()
        squared = half**2 + 2 * half * change
        return ~((load <= 0) & ((squared <= 0) | (amplitude <= 0)) & (small | (amplitude <= 0)))

    def _entered(self, state: LatticeState) -> LatticeState | None:
        """The state with strips that enter; None without any."""
        barred = {strip for strip, times in self._left.items() if times >= EXCHANGES}
        new = entering(self.problem, state, barred)
        if new is None:
            return None
        log.debug("strips %s enter", new.strips)
        return state.joined(new)

    def _searched(
        self, state: LatticeState, step: Array, rho: Array, factors: tuple[Array, Array]
    ) -> tuple[LatticeState, float]:
        """State after the largest fraction of a step that reduces the next simplified step, and the fraction.

        Affine-invariant line search: Deuflhard, Newton Methods for Nonlinear Problems, 2011, sec. 3.3.
        """
        before = _norm(step, state)
        factor = self._longest(state, step)
        best: tuple[float, LatticeState, float] | None = None
        for _ in range(HALVINGS):
            trial = state.moved(step, factor)
            evaluation = self.problem.evaluate(trial, rho)
            after = _norm(_solved(factors, -evaluation.residual), state)
            if best is None or after < best[0]:
                best = after, trial, factor
            if after <= (1 - 0.25 * factor) * before:
                break
            factor *= 0.5
        assert best is not None
        return best[1], best[2]

    @staticmethod
    def _longest(state: LatticeState, step: Array) -> float:
        """Largest fraction of a step at which no strip moves by more than its length or grows too much."""
        half, change = state.half, 0.5 * (step[:, -1] - step[:, -2])
        growth = 2 * np.abs(change) / half / LONGEST
        away = np.abs(step[:, -2:].mean(axis=1)) / half.max()
        growth = np.where(half > 0.3 * half.max(), growth, 0.0)
        return float(min(1.0, 1 / max(growth.max(), away.max(), 1e-300)))


def _scaled(jacobian: Array, state: LatticeState) -> Array:
    """Jacobian with rows and columns in units of `STRESS`, `LENGTH` and `GAP`."""
    S, block = state.values.shape
    rows = np.tile(np.r_[np.full(block - MOMENTS, 1 / STRESS), np.full(MOMENTS, 1 / GAP)], S)
    columns = np.tile(np.r_[np.full(block - 2, STRESS), np.full(2, LENGTH)], S)
    return np.asarray(jacobian * rows[:, None] * columns)


def solve_scaled(jacobian: Array, state: LatticeState, right: Array) -> Array:
    """Solutions (n, k) for right-hand sides (n, k)."""
    S, block = state.values.shape
    factors = la.lu_factor(_scaled(jacobian, state), check_finite=False)
    rows = np.tile(np.r_[np.full(block - MOMENTS, 1 / STRESS), np.full(MOMENTS, 1 / GAP)], S)
    columns = np.tile(np.r_[np.full(block - 2, STRESS), np.full(2, LENGTH)], S)
    return np.asarray(columns[:, None] * la.lu_solve(factors, rows[:, None] * right, check_finite=False))


def _solved(factors: tuple[Array, Array], right: Array) -> Array:
    """Step (S, block) from the factors of the scaled Jacobian and a right-hand side (S, block)."""
    scaled = right.copy()
    scaled[:, :-MOMENTS] /= STRESS
    scaled[:, -MOMENTS:] /= GAP
    step = la.lu_solve(factors, scaled.ravel(), check_finite=False).reshape(right.shape)
    step[:, :-2] *= STRESS
    step[:, -2:] *= LENGTH
    return np.asarray(step)


def _relative(step: Array, state: LatticeState) -> Array:
    """Step over the largest pressure amplitude and half length."""
    relative = step / max(float(np.abs(state.modes[:, 0]).max()), 1e-6 * STRESS)
    relative[:, -2:] = step[:, -2:] / state.half.max()
    return np.asarray(relative)


def _size(step: Array, state: LatticeState) -> float:
    """Largest relative step."""
    return float(np.abs(_relative(step, state)).max())


def _norm(step: Array, state: LatticeState) -> float:
    """Euclidean norm of the relative step."""
    return float(np.linalg.norm(_relative(step, state)))
