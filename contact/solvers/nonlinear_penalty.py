"""Normal problem with a nonlinear penalty p = P(d): Newton's method for the penetration.

d + N P(d) = d0 + D q at all points, with P(d) = 0 for d <= 0. The penetration is the unknown, as 1/P' may be infinite
at d = 0. By the pressures of the active points the linearised problem is (N + 1/P') p' = d0' + D q'.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as la

from wheelrail.contact.laws.pointwise import PressureFunction
from wheelrail.contact.solvers.options import TINY, IterationCount, NotConverged
from wheelrail.support.arrays import Array, Mask

TOLERANCE = 1e-13  # of the residual relative to the undeformed penetration
STEPS = 60
SHORTEST = 1e-6  # damping of a step


class PenaltyResponse:
    """Response of the pressure to the penetration by a nonlinear penalty; factors belong to the last solution.

    Parameters:
        compliance: N (n, n) m/Pa of the bodies.
        law: P(d).

    Cost: 2 n^3 / 3 per Newton step.
    """

    piecewise_linear = False

    def __init__(self, compliance: Array, law: PressureFunction) -> None:
        self.compliance, self._law = compliance, law
        self._penetration = np.zeros(len(compliance))

    def of(self, active: Mask, count: IterationCount, /) -> Any:
        """LU factors of N + 1/P' at the active points (n,) of the last solution, for `scipy.linalg.lu_solve`."""
        count.newton += 1
        index = np.flatnonzero(active)
        matrix = self.compliance[np.ix_(index, index)].copy()
        slope = self._law(self._penetration[index])[1]
        matrix[np.arange(len(index)), np.arange(len(index))] += 1.0 / np.maximum(slope, TINY)
        return la.lu_factor(matrix, check_finite=False)

    def pressures(self, penetration: Array, active: Mask, count: IterationCount, /) -> tuple[Array, Mask]:
        """Pressures (n,) Pa and active points of undeformed penetrations (n,) m, by damped Newton steps.

        Raises NotConverged.
        """
        scale = max(float(np.linalg.norm(penetration)), TINY)
        d = self._penetration if self._penetration.any() else np.minimum(penetration, 0.1 * np.abs(penetration).max())
        for _ in range(STEPS):
            p, slope = self._law(d)
            F = d - penetration + self.compliance @ p
            norm = float(np.linalg.norm(F))
            if norm <= TOLERANCE * scale:
                self._penetration = d
                return p, p > 0
            count.newton += 1
            step = la.solve(np.eye(len(d)) + self.compliance * slope, -F, check_finite=False)
            damping = 1.0
            while damping > SHORTEST and self._norm(d + damping * step, penetration) > (1 - 1e-4 * damping) * norm:
                damping /= 2
            if damping <= SHORTEST:
                break
            d = d + damping * step
        if norm <= 1e3 * TOLERANCE * scale:  # round-off
            self._penetration = d
            p, _ = self._law(d)
            return p, p > 0
        raise NotConverged(f"normal problem: relative residual {norm / scale:.1e} after {count.newton} Newton steps")

    def residual(self, penetration: Array, pressure: Array, /) -> float:
        """Norm of P(d) - p over that of the pressure, with d = d0 - N p."""
        difference = self._law(penetration - self.compliance @ pressure)[0] - pressure
        return float(np.linalg.norm(difference)) / max(float(np.linalg.norm(pressure)), TINY)

    def _norm(self, d: Array, penetration: Array) -> float:
        return float(np.linalg.norm(d - penetration + self.compliance @ self._law(d)[0]))
