"""Tractions at the contact points from their compliance: exact and regularised laws, pressure and friction together.

Unknowns are the pressures p and tangential tractions q. With the relative compliance known, overlap d and slip s are
linear in them:  d = d0 + D q - N p,  s = c + S q + T p.
Normal:      0 <= p, d <= p / K, p (d - p / K) = 0.  The penalty is a compliance on the diagonal; 1/K may be zero.
Tangential:  |q| <= b, q = -b s / max(|s|, eps), b = mu(|s| V) p.  eps may be zero.
The pressure follows any q exactly (`wheelrail.contact.solvers.active_set`), and Newton runs on q alone
(`wheelrail.contact.solvers.tangential`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.laws.coulomb import TINY
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.solvers.active_set import (
    ROUND_OFF,
    CachedFactors,
    CoupledPressure,
    PrescribedPressure,
    normal_contact,
)
from wheelrail.contact.solvers.options import IterationCount, LinearSolver, NewtonOptions, NotConverged
from wheelrail.contact.solvers.semismooth_newton import tangential_contact
from wheelrail.contact.solvers.tangential import FrictionProblem, SolverCache
from wheelrail.support.arrays import Array, Mask

__all__ = [
    "IterationCount",
    "LinearSolver",
    "NewtonOptions",
    "NotConverged",
    "Tractions",
    "normal_contact",
    "solve_tractions",
]


@dataclass(frozen=True)
class Tractions:
    """pressure (n,) Pa, tangential (n, 2) Pa on the wheel, slip (n, 2) over the rolling speed, active (n,) mask."""

    pressure: Array
    tangential: Array
    slip: Array
    active: Mask


class ContactCompliance:
    """Relative compliance of n points, see `solve_tractions`, and what was made of it in earlier solves."""

    def __init__(self, operator: Array, points: int, laws: ContactLaws) -> None:
        n = points
        normal = operator[-n:, -n:].copy()
        normal[np.arange(n), np.arange(n)] += laws.normal_compliance
        self.normal = CachedFactors(normal)
        # the operator's last columns count -p
        self.slip, self.shift = operator[: 2 * n, : 2 * n], -operator[: 2 * n, 2 * n :]
        coupling = operator[-n:, :-n]  # overlap from tangential tractions
        coupled = coupling.size and np.abs(coupling).max() > ROUND_OFF * np.abs(normal).max()
        self.coupling = coupling if coupled else None
        self.cache = SolverCache()


def solve_tractions(
    operator: Array | ContactCompliance,
    overlap: Array,
    rigid: Array | None,
    *,
    laws: ContactLaws,
    speed: float,
    guess: tuple[Array, Array] | None = None,
    options: NewtonOptions | None = None,
    count: IterationCount,
) -> Tractions:
    """Pressure and traction at n points from their relative compliance.

    operator maps tractions on the wheel (along the local axes, component by component) to slip and overlap: (n, n) for
    normal components only, else (3 n, 3 n) with rows slip 1, slip 2, overlap; or what was made of it before. overlap
    (n,) m undeformed; rigid (2 n,) creepage, None without friction; speed m/s, which only falling friction asks for;
    guess (pressure, tangential (2 n,)). Raises NotConverged.
    """
    options = options or NewtonOptions()
    n = len(overlap)
    body = operator if isinstance(operator, ContactCompliance) else ContactCompliance(operator, n, laws)
    q: Array = np.zeros((2, n)) if guess is None else guess[1].reshape(2, n)
    active = overlap > 0.4 * overlap.max() if guess is None or not (guess[0] > 0).any() else guess[0] > 0
    if rigid is None or not laws.friction:
        pressure, active = normal_contact(body.normal, overlap, active, count)
        count.residual = misfit(body.normal.compliance, overlap, pressure)
        return Tractions(pressure, np.zeros((n, 2)), np.zeros((n, 2)), active)

    raised = overlap
    if body.coupling is not None:
        pressures = CoupledPressure(body.normal, overlap, body.coupling)
        friction = FrictionProblem(body.slip, rigid, body.shift, pressures, laws, speed, body.cache)
        found = tangential_contact(friction, q, active, options, count)
        q, pressure, active = found.q, found.pressure, found.active
        raised = overlap + body.coupling @ q.ravel()
    else:  # the pressure is known beforehand: only the points that carry it are left
        pressure, active = normal_contact(body.normal, overlap, active, count)
        creep = rigid + body.shift @ pressure
        if active.all():
            friction = FrictionProblem(body.slip, creep, None, PrescribedPressure(pressure), laws, speed, body.cache)
            q = tangential_contact(friction, q, active, options, count).q
        else:
            index = np.flatnonzero(active)
            both = np.concatenate([index, n + index])
            friction = FrictionProblem(
                body.slip[np.ix_(both, both)], creep[both], None, PrescribedPressure(pressure[index]), laws, speed
            )
            found = tangential_contact(friction, q[:, index], active[index], options, count)
            q = np.zeros((2, n))
            q[:, index] = found.q
    s = (rigid + body.slip @ q.ravel() + body.shift @ pressure).reshape(2, n)
    count.residual = max(count.residual, misfit(body.normal.compliance, raised, pressure))
    return Tractions(pressure, q.T, s.T, active)


def misfit(compliance: Array, overlap: Array, pressure: Array) -> float:
    """Residual of the normal problem: norm of min(p, g / N_ii) over that of the pressure, g = N p - d the gap."""
    gap = (compliance @ pressure - overlap) / np.diag(compliance)
    return float(np.linalg.norm(np.minimum(pressure, gap))) / max(float(np.linalg.norm(pressure)), TINY)
