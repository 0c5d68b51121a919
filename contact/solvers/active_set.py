"""Normal problem: exact pressures at the contact points for given tangential tractions.

0 <= p, g = N p - d0 - D q >= 0, p g = 0, the penalty's compliance 1/K on the diagonal of N.
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import scipy.linalg as la

from wheelrail.contact.solvers.options import TINY, IterationCount, NotConverged
from wheelrail.support.arrays import Array, Mask

ROUND_OFF = 1e-12
PATIENCE = 5  # steps without progress before single points are exchanged


class CachedFactors:
    """Response of the pressure to the penetration by exact contact or a linear penalty.

    Parameters:
        compliance: N (n, n) m/Pa with 1/K on the diagonal.

    LU factors on the last `STORED` sets of active points are cached.
    """

    STORED = 4
    piecewise_linear = True

    def __init__(self, compliance: Array) -> None:
        self.compliance = compliance
        self._factors_of: dict[bytes, Any] = {}

    def of(self, active: Mask, count: IterationCount) -> Any:
        """Factors of the rows and columns of the active points (n,), for `scipy.linalg.lu_solve`."""
        key = active.tobytes()
        if key not in self._factors_of:
            count.newton += 1
            if len(self._factors_of) >= self.STORED:
                del self._factors_of[next(iter(self._factors_of))]
            matrix = self.compliance
            if not active.all():
                index = np.flatnonzero(active)
                matrix = matrix[np.ix_(index, index)]
            # columns are scaled by the points' areas: positive definite up to that scaling, but not symmetric
            self._factors_of[key] = la.lu_factor(matrix, check_finite=False)
        return self._factors_of[key]

    def pressures(self, penetration: Array, active: Mask, count: IterationCount) -> tuple[Array, Mask]:
        """Pressures (n,) Pa and active points of penetrations (n,) m, see `normal_contact`."""
        return normal_contact(self, penetration, active, count)

    def residual(self, penetration: Array, pressure: Array) -> float:
        """Norm of min(p, g / N_ii) over that of the pressure, with the gap g = N p - d."""
        gap = (self.compliance @ pressure - penetration) / np.diag(self.compliance)
        return float(np.linalg.norm(np.minimum(pressure, gap))) / max(float(np.linalg.norm(pressure)), TINY)


def normal_contact(
    compliance: Array | CachedFactors, penetration: Array, active: Mask, count: IterationCount
) -> tuple[Array, Mask]:
    """Pressures p >= 0 with N p >= d0, p (N p - d0) = 0 by a primal-dual active set, and the active points.

    Parameters:
        compliance: N (n, n) m/Pa with 1/K on the diagonal, or its cached factors.
        penetration: d0 (n,) m.
        active: (n,) initial guess of the active points.
        count: of iterations, updated.

    Each step is a Newton step of the semi-smooth complementarity. If the number of violating points does not decrease
    for `PATIENCE` steps, single points are exchanged until it does, which terminates as N is positive definite: block
    principal pivoting, Judice and Pires, doi:10.1016/0305-0548(94)90106-6. Raises NotConverged.
    """
    factors = compliance if isinstance(compliance, CachedFactors) else CachedFactors(compliance)
    n = len(penetration)
    active = active.copy()
    slack = ROUND_OFF * np.abs(penetration).max()
    fewest, patience = n + 1, PATIENCE
    for _ in range(100 * (n + 1)):
        pressure = np.zeros(n)
        index = np.flatnonzero(active)
        if len(index):
            pressure[index] = la.lu_solve(factors.of(active, count), penetration[index], check_finite=False)
        tensile = active & (pressure < -ROUND_OFF * pressure.max(initial=0.0))
        penetrating = ~active & (factors.compliance[:, index] @ pressure[index] < penetration - slack)
        violating = tensile | penetrating
        violations = int(violating.sum())
        if not violations:
            return np.maximum(pressure, 0.0), active
        if violations < fewest:
            fewest, patience = violations, PATIENCE
        else:
            patience -= 1
        if patience < 0:
            last = int(np.flatnonzero(violating)[-1])
            violating = np.zeros(n, dtype=bool)
            violating[last] = True
        active ^= violating
    raise NotConverged("the active set of contact points did not converge")


class NormalResponse(Protocol):
    """Pressures by penetrations: `CachedFactors`, or `wheelrail.contact.solvers.nonlinear_penalty.PenaltyResponse`."""

    compliance: Array
    piecewise_linear: bool  # whether the factors depend on the active points only

    def of(self, active: Mask, count: IterationCount, /) -> Any: ...

    def pressures(self, penetration: Array, active: Mask, count: IterationCount, /) -> tuple[Array, Mask]: ...

    def residual(self, penetration: Array, pressure: Array, /) -> float: ...


class PrescribedPressure:
    """Pressures independent of the tangential tractions: equal bodies, flat surfaces, or given pressures (n,) Pa."""

    piecewise_linear = True

    def __init__(self, pressure: Array) -> None:
        self._pressure, self._active = pressure, pressure > 0

    def at(self, _: Array, __: Mask, ___: IterationCount) -> tuple[Array, Mask]:
        return self._pressure, self._active

    def slope(self, _: Mask, __: IterationCount) -> Array | None:
        return None


class CoupledPressure:
    """Pressures as a function of the tangential tractions q (2 n,) by solving the normal problem.

    Parameters:
        normal: response to the penetration; for a linear law N p = d0 + D q on the active points.
        penetration: d0 (n,) m.
        coupling: D (n, 2 n) m/Pa.
    """

    def __init__(self, normal: NormalResponse, penetration: Array, coupling: Array) -> None:
        self._normal, self._penetration, self._coupling = normal, penetration, coupling
        self.piecewise_linear = normal.piecewise_linear

    def at(self, q: Array, active: Mask, count: IterationCount) -> tuple[Array, Mask]:
        """Pressures (n,) and active points (n,) at q (2 n,), with active as the initial guess."""
        return self._normal.pressures(self._penetration + self._coupling @ q, active, count)

    def slope(self, active: Mask, count: IterationCount) -> Array:
        """dp/dq (a, 2 n) of the a active points; a may be zero after a Newton step."""
        if not active.any():
            return np.zeros((0, self._coupling.shape[1]))
        factor = self._normal.of(active, count)
        return np.asarray(la.lu_solve(factor, self._coupling[active], check_finite=False))
