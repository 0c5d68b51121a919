"""Tractions at the contact points from their compliance: exact and regularised laws, pressure and friction together.

Unknowns are the pressures p and tangential tractions q. With the relative compliance known, overlap d and slip s are
linear in them:  d = d0 + D q - N p,  s = c + S q + T p.
Normal:      0 <= p, d <= p / K, p (d - p / K) = 0.  The penalty is a compliance on the diagonal; 1/K may be zero.
Tangential:  |q| <= b, q = -b s / max(|s|, eps), b = mu(|s| V) p.  eps may be zero.
The pressure follows any q exactly (`contact.pressure`), and Newton runs on q alone (`contact.friction`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.convergence import Count, LinearSolver, NewtonOptions, NotConverged
from contact.friction import TINY, Friction, tangential_contact
from contact.laws import Laws
from contact.pose import Array, Mask
from contact.pressure import ROUND_OFF, Coupled, Given, normal_contact

__all__ = ["Count", "LinearSolver", "NewtonOptions", "NotConverged", "Tractions", "normal_contact", "solve_tractions"]


@dataclass(frozen=True)
class Tractions:
    """pressure (n,) Pa, tangential (n, 2) Pa on the wheel, slip (n, 2) over the rolling speed, active (n,) mask."""

    pressure: Array
    tangential: Array
    slip: Array
    active: Mask


def solve_tractions(
    operator: Array,
    overlap: Array,
    rigid: Array | None,
    *,
    laws: Laws,
    speed: float,
    guess: tuple[Array, Array] | None = None,
    options: NewtonOptions | None = None,
    count: Count,
) -> Tractions:
    """Pressure and traction at n points from their relative compliance.

    operator maps tractions on the wheel (along the local axes, component by component) to slip and overlap: (n, n) for
    normal components only, else (3 n, 3 n) with rows slip 1, slip 2, overlap. overlap (n,) m undeformed; rigid (2 n,)
    creepage, None without friction; speed m/s, which only falling friction asks for; guess (pressure, tangential
    (2 n,)). Raises NotConverged.
    """
    options = options or NewtonOptions()
    n = len(overlap)
    normal = operator[-n:, -n:].copy()
    normal[np.arange(n), np.arange(n)] += laws.normal_compliance
    q = np.zeros((2, n)) if guess is None else guess[1].reshape(2, n)
    active = overlap > 0.4 * overlap.max() if guess is None or not (guess[0] > 0).any() else guess[0] > 0
    if rigid is None or not laws.friction:
        pressure, active = normal_contact(normal, overlap, active, count)
        count.residual = misfit(normal, overlap, pressure)
        return Tractions(pressure, np.zeros((n, 2)), np.zeros((n, 2)), active)

    coupling = operator[-n:, :-n]  # overlap from tangential tractions
    slip, shift = operator[: 2 * n, : 2 * n], -operator[: 2 * n, 2 * n :]  # the operator's last columns count -p
    if np.abs(coupling).max() > ROUND_OFF * np.abs(normal).max():
        found = tangential_contact(
            Friction(slip, rigid, shift, Coupled(normal, overlap, coupling), laws, speed), q, active, options, count
        )
        q, pressure, active = found.q, found.pressure, found.active
    else:  # the pressure is known beforehand: only the points that carry it are left
        pressure, active = normal_contact(normal, overlap, active, count)
        index = np.flatnonzero(active)
        both = np.concatenate([index, n + index])
        creep = rigid[both] + shift[np.ix_(both, index)] @ pressure[index]
        friction = Friction(slip[np.ix_(both, both)], creep, None, Given(pressure[index]), laws, speed)
        found = tangential_contact(friction, q[:, index], active[index], options, count)
        q = np.zeros((2, n))
        q[:, index] = found.q
    s = (rigid + slip @ q.ravel() + shift @ pressure).reshape(2, n)
    count.residual = max(count.residual, misfit(normal, overlap + coupling @ q.ravel(), pressure))
    return Tractions(pressure, q.T, s.T, active)


def misfit(compliance: Array, overlap: Array, pressure: Array) -> float:
    """Residual of the normal problem: norm of min(p, g / N_ii) over that of the pressure, g = N p - d the gap."""
    gap = (compliance @ pressure - overlap) / np.diag(compliance)
    return float(np.linalg.norm(np.minimum(pressure, gap))) / max(float(np.linalg.norm(pressure)), TINY)
