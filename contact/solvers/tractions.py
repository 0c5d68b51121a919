"""Tractions at the contact points from their compliance, eq. (15): exact and regularised laws, with friction.

Unknowns are the pressures p and tangential tractions q. Penetration d and slip s are linear in them by the relative
compliance:  d = d0 + D q - N p,  s = c + S q + T p.
Normal:      0 <= p, d <= p / K, p (d - p / K) = 0.  The penalty is a compliance on the diagonal; 1/K may be zero.
             Nonlinear penalties p = P(d): `wheelrail.contact.solvers.nonlinear_penalty`.
Tangential:  |q| <= b, q = -b s / max(|s|, eps), b = mu(|s| V, p) p.  eps may be zero.
The pressure is solved exactly for any q (`wheelrail.contact.solvers.active_set`), and Newton runs on q alone
(`wheelrail.contact.solvers.tangential`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.solvers.active_set import (
    ROUND_OFF,
    CachedFactors,
    CoupledPressure,
    NormalResponse,
    PrescribedPressure,
)
from wheelrail.contact.solvers.nonlinear_penalty import PenaltyResponse
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions
from wheelrail.contact.solvers.semismooth_newton import tangential_contact
from wheelrail.contact.solvers.tangential import FrictionProblem, SolverCache
from wheelrail.support.arrays import Array, Mask


@dataclass(frozen=True)
class Tractions:
    """Solution of the contact problem at n points.

    Parameters:
        pressure: (n,) Pa.
        tangential: (n, 2) Pa on the wheel, longitudinal and lateral.
        slip: (n, 2), over the rolling speed.
        active: (n,) mask.
    """

    pressure: Array
    tangential: Array
    slip: Array
    active: Mask


class ContactCompliance:
    """Relative compliance of n points with the factors cached by earlier solves.

    Parameters:
        operator: (n, n) or (3 n, 3 n), see `solve_tractions`.
        points: n.
        laws: of the interface; the compliance of a linear penalty is added to the diagonal.
    """

    normal: NormalResponse

    def __init__(self, operator: Array, points: int, laws: ContactLaws) -> None:
        n = points
        normal = operator[-n:, -n:].copy()
        if laws.normal_compliance is None:
            self.normal = PenaltyResponse(normal, laws.pointwise_pressure)
        else:
            normal[np.arange(n), np.arange(n)] += laws.normal_compliance
            self.normal = CachedFactors(normal)
        # the operator's last columns act on -p
        self.slip, self.shift = operator[: 2 * n, : 2 * n], -operator[: 2 * n, 2 * n :]
        coupling = operator[-n:, :-n]  # penetration by tangential tractions
        coupled = coupling.size and np.abs(coupling).max() > ROUND_OFF * np.abs(normal).max()
        self.coupling = coupling if coupled else None
        self.cache = SolverCache()


def solve_tractions(
    operator: Array | ContactCompliance,
    penetration: Array,
    rigid: Array | None,
    *,
    laws: ContactLaws,
    speed: float,
    guess: tuple[Array, Array] | None = None,
    options: NewtonOptions | None = None,
    count: IterationCount,
) -> Tractions:
    """Pressure and traction at n points from their relative compliance.

    Parameters:
        operator: from tractions on the wheel (along the local axes, component by component) to slip and penetration:
            (n, n) for normal components only, else (3 n, 3 n) with rows slip 1, slip 2, penetration; or a
            `ContactCompliance`.
        penetration: (n,) m, undeformed.
        rigid: (2 n,), creepage, longitudinal then lateral; None without friction.
        laws: of the interface.
        speed: m/s, needed for friction that depends on the slip velocity.
        guess: pressure (n,) and tangential traction (2 n,) Pa.
        options: of Newton's method.
        count: of iterations, updated.

    Raises NotConverged.
    """
    options = options or NewtonOptions()
    n = len(penetration)
    body = operator if isinstance(operator, ContactCompliance) else ContactCompliance(operator, n, laws)
    q: Array = np.zeros((2, n)) if guess is None else guess[1].reshape(2, n)
    active = penetration > 0.4 * penetration.max() if guess is None or not (guess[0] > 0).any() else guess[0] > 0
    if rigid is None or not laws.frictional:
        pressure, active = body.normal.pressures(penetration, active, count)
        count.residual = body.normal.residual(penetration, pressure)
        return Tractions(pressure, np.zeros((n, 2)), np.zeros((n, 2)), active)

    total_penetration = penetration
    if body.coupling is not None:
        pressures = CoupledPressure(body.normal, penetration, body.coupling)
        friction = FrictionProblem(body.slip, rigid, body.shift, pressures, laws, speed, body.cache)
        state = tangential_contact(friction, q, active, options, count)
        q, pressure, active = state.q, state.pressure, state.active
        total_penetration = penetration + body.coupling @ q.ravel()
    else:  # the pressure does not depend on friction: only points that carry it remain
        pressure, active = body.normal.pressures(penetration, active, count)
        creep = rigid + body.shift @ pressure
        if active.all():
            friction = FrictionProblem(body.slip, creep, None, PrescribedPressure(pressure), laws, speed, body.cache)
            q = tangential_contact(friction, q, active, options, count).q
        else:
            index = np.flatnonzero(active)
            rows = np.concatenate([index, n + index])
            friction = FrictionProblem(
                body.slip[np.ix_(rows, rows)], creep[rows], None, PrescribedPressure(pressure[index]), laws, speed
            )
            state = tangential_contact(friction, q[:, index], active[index], options, count)
            q = np.zeros((2, n))
            q[:, index] = state.q
    s = (rigid + body.slip @ q.ravel() + body.shift @ pressure).reshape(2, n)
    count.residual = max(count.residual, body.normal.residual(total_penetration, pressure))
    return Tractions(pressure, q.T, s.T, active)
