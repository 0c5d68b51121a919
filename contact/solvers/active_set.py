"""The normal problem: pressures at the contact points, exactly, for any tangential tractions.

0 <= p, g = N p - d0 - D q >= 0, p g = 0, the penalty's compliance 1/K on the diagonal of N.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.linalg as la

from wheelrail.contact.solvers.options import IterationCount, NotConverged
from wheelrail.support.arrays import Array, Mask

ROUND_OFF = 1e-12
PATIENCE = 5  # steps without progress before points change sides one by one


class CachedFactors:
    """LU factors of a compliance on sets of active points, the last few kept."""

    KEPT = 4

    def __init__(self, compliance: Array) -> None:
        self.compliance = compliance
        self._known: dict[bytes, Any] = {}

    def of(self, active: Mask, count: IterationCount) -> Any:
        key = active.tobytes()
        if key not in self._known:
            count.newton += 1
            if len(self._known) >= self.KEPT:
                del self._known[next(iter(self._known))]
            own = self.compliance
            if not active.all():
                index = np.flatnonzero(active)
                own = own[np.ix_(index, index)]
            # columns carry the points' areas: positive definite up to that scaling, but not symmetric
            self._known[key] = la.lu_factor(own, check_finite=False)
        return self._known[key]


def normal_contact(
    compliance: Array | CachedFactors, overlap: Array, active: Mask, count: IterationCount
) -> tuple[Array, Mask]:
    """Pressure p >= 0 with N p >= d0, p (N p - d0) = 0 by a primal-dual active set, N (n, n) m/Pa holding 1/K.

    Each step is a Newton step of the semi-smooth complementarity. Should the number of offending points not fall for
    some steps, single points change sides until it does, which ends for certain as N is positive definite: block
    principal pivoting, Judice and Pires, doi:10.1016/0305-0548(94)90106-6. Raises NotConverged.
    """
    factors = compliance if isinstance(compliance, CachedFactors) else CachedFactors(compliance)
    n = len(overlap)
    active = active.copy()
    slack = ROUND_OFF * np.abs(overlap).max()
    fewest, patience = n + 1, PATIENCE
    for _ in range(100 * (n + 1)):
        pressure = np.zeros(n)
        index = np.flatnonzero(active)
        if len(index):
            pressure[index] = la.lu_solve(factors.of(active, count), overlap[index], check_finite=False)
        pulls = active & (pressure < -ROUND_OFF * pressure.max(initial=0.0))
        hits = ~active & (factors.compliance[:, index] @ pressure[index] < overlap - slack)
        wrong = pulls | hits
        offending = int(wrong.sum())
        if not offending:
            return np.maximum(pressure, 0.0), active
        if offending < fewest:
            fewest, patience = offending, PATIENCE
        else:
            patience -= 1
        if patience < 0:
            last = int(np.flatnonzero(wrong)[-1])
            wrong = np.zeros(n, dtype=bool)
            wrong[last] = True
        active ^= wrong
    raise NotConverged("the contact area does not settle")


class PrescribedPressure:
    """Pressures that tangential tractions do not change: equal bodies, flat surfaces, or pressures from elsewhere."""

    def __init__(self, pressure: Array) -> None:
        self._pressure, self._active = pressure, pressure > 0

    def at(self, _: Array, __: Mask, ___: IterationCount) -> tuple[Array, Mask]:
        return self._pressure, self._active

    def slope(self, _: Mask, __: IterationCount) -> Array | None:
        return None


class CoupledPressure:
    """Pressures as a function of the tangential tractions q (2 n,): the normal problem is solved for each of them.

    Piecewise linear: N p = d0 + D q on the active points. normal: N (n, n) m/Pa; coupling: D (n, 2 n) m/Pa.
    """

    def __init__(self, normal: CachedFactors, overlap: Array, coupling: Array) -> None:
        self._factors, self._overlap, self._coupling = normal, overlap, coupling

    def at(self, q: Array, active: Mask, count: IterationCount) -> tuple[Array, Mask]:
        """Pressures (n,) and active points, found from a set of active points."""
        return normal_contact(self._factors, self._overlap + self._coupling @ q, active, count)

    def slope(self, active: Mask, count: IterationCount) -> Array:
        """dp/dq (a, 2 n) of the active points, of which a step of Newton's method may leave none."""
        if not active.any():
            return np.zeros((0, self._coupling.shape[1]))
        factor = self._factors.of(active, count)
        return np.asarray(la.lu_solve(factor, self._coupling[active], check_finite=False))
