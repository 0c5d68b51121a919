"""Tractions at the contact points from their compliance: one semi-smooth Newton for exact and regularised laws.

Unknowns are the pressures p and tangential tractions q. With the relative compliance known, overlap d and slip s are
linear in them:  d = d0 + D q - N p,  s = c + S q + T p.
Normal:      0 <= p, d <= p / K, p (d - p / K) = 0.  The penalty is a compliance on the diagonal; 1/K may be zero.
Tangential:  q = Proj(q - rho (s + eps q / (mu p))), |q| <= mu p.  The regularised Coulomb law (6); eps may be zero.
On a set of active points p is linear in q, so Newton runs on q alone and the pressure follows exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from inspect import signature
from typing import Literal

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as sla
from numpy.typing import NDArray

from contact.pose import Array

LinearSolver = Literal["lu", "bicgstab"]
Mask = NDArray[np.bool_]


ROUND_OFF = 1e-12
RELATIVE = "rtol" if "rtol" in signature(sla.bicgstab).parameters else "tol"  # renamed in SciPy 1.12
PATIENCE = 5  # steps without progress before points change sides one by one


class NotConverged(RuntimeError):
    """The tractions could not be found."""


@dataclass(frozen=True)
class NewtonOptions:
    """tolerance: residual over the norm of the friction bounds; forcing: relative residual of BiCGStab, eq. (18)."""

    tolerance: float = 1e-9
    iterations: int = 60
    linear: LinearSolver = "lu"
    forcing: float = 0.01


@dataclass
class Count:
    """Newton and linear iterations, last relative residual."""

    newton: int = 0
    linear: int = 0
    residual: float = 0.0


def normal_contact(compliance: Array, overlap: Array, active: Mask, count: Count) -> tuple[Array, Mask]:
    """Pressure p >= 0 with N p >= d0, p (N p - d0) = 0 by a primal-dual active set, N (n, n) m/Pa holding 1/K.

    Each step is a Newton step of the semi-smooth complementarity. Should the number of offending points not fall for
    some steps, single points change sides until it does, which ends for certain as N is positive definite: block
    principal pivoting, Judice and Pires, doi:10.1016/0305-0548(94)90106-6. Raises NotConverged.
    """
    n = len(overlap)
    active = active.copy()
    slack = ROUND_OFF * overlap.max()
    fewest, patience = n + 1, PATIENCE
    for _ in range(100 * (n + 1)):
        count.newton += 1
        pressure = np.zeros(n)
        index = np.flatnonzero(active)
        if len(index):
            # columns carry the points' areas: positive definite up to that scaling, but not symmetric
            pressure[index] = la.solve(compliance[np.ix_(index, index)], overlap[index], check_finite=False)
        pulls = active & (pressure < -ROUND_OFF * pressure.max(initial=0.0))
        hits = ~active & (compliance[:, index] @ pressure[index] < overlap - slack)
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


def tangential_contact(
    slip: Array,
    rigid: Array,
    bound: Array,
    bound_slope: Array | None,
    eps: float,
    q: Array,
    options: NewtonOptions,
    count: Count,
) -> Array:
    """Tractions q (2 n,) with |q| <= b and q = Proj_b(q - rho (s + eps q / b)), s = rigid + slip q.

    bound b (n,) Pa may depend on q: b + bound_slope q (n, 2 n). Semi-smooth Newton with Armijo backtracking.
    Raises NotConverged.
    """
    n = len(bound)
    own = 0.5 * (np.diag(slip)[:n] + np.diag(slip)[n:])
    own = np.maximum(own, 1e-3 * np.abs(own).max())
    scale = max(float(np.linalg.norm(bound)), 1e-300)

    def project(q: Array) -> tuple[Array, Array, Array, Array, Array, Array]:
        b = bound if bound_slope is None else np.maximum(bound + bound_slope @ q, 0.0)
        viscous = eps / (b * own + eps) if eps > 0 else np.zeros(n)  # rho eps / b
        rho = np.where(b * own + eps > 0, b / np.maximum(b * own + eps, 1e-300), 0.0) if eps > 0 else 1 / own
        s = rigid + slip @ q
        z = np.tile(1 - viscous, 2) * q - np.tile(rho, 2) * s
        length = np.hypot(z[:n], z[n:])
        slides = length > b
        factor = np.where(slides, b / np.where(slides, length, 1.0), 1.0)
        return b, viscous, rho, z, factor, q - np.tile(factor, 2) * z

    b, viscous, rho, z, factor, residual = project(q)
    for _ in range(options.iterations):
        norm = float(np.linalg.norm(residual))
        count.residual = norm / scale
        if norm <= options.tolerance * scale:
            return q
        count.newton += 1
        # dz = diag(1 - viscous) dq - rho S dq + (viscous q / b) db, viscous and rho taken at the present bound
        dz = -np.tile(rho, 2)[:, None] * slip
        dz[np.arange(2 * n), np.arange(2 * n)] += np.tile(1 - viscous, 2)
        if bound_slope is not None:
            ratio = np.where(b > 0, viscous / np.maximum(b, 1e-300), 0.0)
            dz += np.vstack([(ratio * q[:n])[:, None] * bound_slope, (ratio * q[n:])[:, None] * bound_slope])
        length = np.maximum(np.hypot(z[:n], z[n:]), 1e-300)
        slides = factor < 1
        ux, uy = z[:n] / length, z[n:] / length
        turn = np.where(slides, factor, 0.0)
        pxx, pyy, pxy = factor - turn * ux * ux, factor - turn * uy * uy, -turn * ux * uy
        jacobian = -np.vstack(
            [pxx[:, None] * dz[:n] + pxy[:, None] * dz[n:], pxy[:, None] * dz[:n] + pyy[:, None] * dz[n:]]
        )
        if bound_slope is not None:
            jacobian -= np.vstack(
                [np.where(slides, ux, 0.0)[:, None] * bound_slope, np.where(slides, uy, 0.0)[:, None] * bound_slope]
            )
        jacobian[np.arange(2 * n), np.arange(2 * n)] += 1.0
        direction = linear_solve(jacobian, residual, options, count)
        damping = 1.0
        while True:
            trial = project(q - damping * direction)
            if np.linalg.norm(trial[-1]) <= (1 - 1e-4 * damping) * norm or damping < 1e-3:
                break
            damping /= 2
        q = q - damping * direction
        b, viscous, rho, z, factor, residual = trial
    raise NotConverged(f"friction: relative residual {count.residual:.1e} after {options.iterations} Newton steps")


def linear_solve(matrix: Array, right: Array, options: NewtonOptions, count: Count) -> Array:
    """Newton's linear system by LU, or by BiCGStab to the forcing term, eqs. (17) and (18)."""
    if options.linear == "lu":
        return np.asarray(la.solve(matrix, right, check_finite=False))
    steps = 0

    def tick(_: Array) -> None:
        nonlocal steps
        steps += 1

    solution, info = sla.bicgstab(matrix, right, **{RELATIVE: options.forcing}, atol=0.0, maxiter=200, callback=tick)
    count.linear += steps
    return np.asarray(solution) if info == 0 else np.asarray(la.solve(matrix, right, check_finite=False))


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
    normal_compliance: float,
    friction: float,
    regularisation: float,
    guess: tuple[Array, Array] | None = None,
    options: NewtonOptions | None = None,
    count: Count,
) -> Tractions:
    """Pressure and traction at n points from their relative compliance.

    operator maps tractions on the wheel (along the local axes, component by component) to slip and overlap: (n, n) for
    normal components only, else (3 n, 3 n) with rows slip 1, slip 2, overlap. overlap (n,) m undeformed; rigid (2 n,)
    creepage, None without friction; guess (pressure, tangential (2 n,)). Raises NotConverged.
    """
    options = options or NewtonOptions()
    n = len(overlap)
    normal = operator[-n:, -n:].copy()
    normal[np.arange(n), np.arange(n)] += normal_compliance
    q = np.zeros(2 * n) if guess is None else guess[1]
    active = overlap > 0.4 * overlap.max() if guess is None or not (guess[0] > 0).any() else guess[0] > 0
    if rigid is None or not friction:
        pressure, active = normal_contact(normal, overlap, active, count)
        return Tractions(pressure, np.zeros((n, 2)), np.zeros((n, 2)), active)

    coupling = operator[-n:, :-n]  # overlap from tangential tractions
    coupled = bool(np.abs(coupling).max() > 1e-12 * np.abs(normal).max())
    for _ in range(30):
        pressure, active = normal_contact(normal, overlap + coupling @ q if coupled else overlap, active, count)
        index = np.flatnonzero(active)
        both = np.concatenate([index, n + index])
        # pressure on the active set: p = base + slope q
        base, slope = pressure[index], None
        slip, shift = operator[np.ix_(both, both)], operator[np.ix_(both, 2 * n + index)]
        creep = rigid[both]
        if coupled:
            solved = la.solve(
                normal[np.ix_(index, index)],
                np.column_stack([overlap[index], coupling[np.ix_(index, both)]]),
            )
            base, slope = solved[:, 0], solved[:, 1:]
            slip = slip - shift @ slope
        creep = creep - shift @ base
        found = tangential_contact(
            slip,
            creep,
            friction * base,
            None if slope is None else friction * slope,
            regularisation,
            q[both],
            options,
            count,
        )
        q = np.zeros(2 * n)
        q[both] = found
        if slope is None:
            break
        pressure = np.zeros(n)
        pressure[index] = base + slope @ found
        gap = overlap + coupling @ q - normal[:, index] @ pressure[index]
        pulls = active & (pressure < -ROUND_OFF * pressure.max(initial=0.0))
        hits = ~active & (gap > ROUND_OFF * overlap.max())
        if not (pulls | hits).any():
            pressure = np.maximum(pressure, 0.0)
            break
        active = active ^ (pulls | hits)
    else:
        raise NotConverged("the contact area does not settle with friction")
    s = rigid + operator[: 2 * n, : 2 * n] @ q - operator[: 2 * n, 2 * n :] @ pressure
    return Tractions(pressure, q.reshape(2, n).T, s.reshape(2, n).T, active)
