"""The tangential problem: a semi-smooth Newton for exact and regularised Coulomb friction.

The law q = -b s / max(|s|, eps), |q| <= b, of which eps = 0 leaves q undecided at s = 0, is the same as

    q = b y / max(|y|, b rho + eps),   y = rho q - s,

for any rho > 0 [1/Pa]: a projection on the disc of radius b = mu(|s| V) p, smooth where it does not switch. Pressure
follows the tractions, p = P(q), so Newton runs on q alone: F(q) = q - b y / max(|y|, b rho + eps).
"""

from __future__ import annotations

from dataclasses import dataclass
from inspect import signature
from typing import Protocol

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as sla

from contact.convergence import Count, NewtonOptions, NotConverged
from contact.laws import Laws
from contact.pose import Array, Mask, Nodes

RELATIVE = "rtol" if "rtol" in signature(sla.bicgstab).parameters else "tol"  # renamed in SciPy 1.12
TINY = 1e-300
STALLS = 3  # steps without descent that end an attempt
ROUNDS = 60  # bounds held in turn

# sets of points, by their bytes -> points inside (k,), ds/dq (2 k, 2 k) with the pressure following, dp/dq (k, 2 k)
Known = dict[bytes, tuple[Nodes, Array, Array | None]]


class Pressure(Protocol):
    """Pressures as a function of the tangential tractions; see `contact.pressure`."""

    def at(self, q: Array, active: Mask, count: Count, /) -> tuple[Array, Mask]: ...

    def slope(self, active: Mask, count: Count, /) -> Array | None: ...


@dataclass(frozen=True)
class Trial:
    """Everything at tractions q (2, n): pressure (n,), active points, slip s (2, n), y (2, n), friction mu (n,) and its
    slope by |s|, bound b (n,), the larger of |y| and b rho + eps (n,), where |y| is (n,), F (2, n) and its norm,
    and whether the bound is held.
    """

    q: Array
    pressure: Array
    active: Mask
    s: Array
    y: Array
    mu: Array
    fall: Array
    bound: Array
    longest: Array
    slides: Mask
    F: Array
    norm: float
    held: bool


class Friction:
    """F(q) and its derivative for n points: slip S (2 n, 2 n) 1/Pa of the tractions and rigid (2 n,); T (2 n, n) 1/Pa,
    slip of the pressure (None: within rigid); speed m/s; known, what solves with the same compliance found before.
    """

    def __init__(
        self,
        slip: Array,
        rigid: Array,
        shift: Array | None,
        pressure: Pressure,
        laws: Laws,
        speed: float,
        known: Known | None = None,
    ) -> None:
        n = len(rigid) // 2
        own = 0.5 * (np.diag(slip)[:n] + np.diag(slip)[n:])
        self.rho = np.maximum(own, 1e-3 * np.abs(own).max())
        self._slip, self._rigid, self._shift, self._pressure = slip, rigid, shift, pressure
        self._laws, self._speed = laws, speed
        self._known: Known = {} if known is None else known

    def at(self, q: Array, active: Mask, count: Count, bound: Array | None = None) -> Trial:
        """The trial at q (2, n), with bounds (n,) held if given; active points are only where to start from."""
        p, active = self._pressure.at(q.ravel(), active, count)
        s = self._rigid + self._slip @ q.ravel()
        if self._shift is not None:
            s = s + self._shift @ p
        s = s.reshape(2, -1)
        mu, fall = self._laws.friction_at(np.hypot(*s), self._speed)
        b, y = mu * p if bound is None else bound, self.rho * q - s
        length, limit = np.hypot(*y), b * self.rho + self._laws.regularisation
        longest = np.maximum(length, limit)
        F = q - b / np.maximum(longest, TINY) * y
        return Trial(
            q, p, active, s, y, mu, fall, b, longest, length > limit, F, float(np.linalg.norm(F)), bound is not None
        )

    def step(self, t: Trial, options: NewtonOptions, count: Count) -> Array:
        """Newton's step (2, n) from a trial."""
        n = len(t.bound)
        inside = t.active | (t.q != 0).any(axis=0) | (t.bound > 0)
        index, slip, slope = self._linearised(t.active, inside, count)
        k = len(index)
        b, y, s, longest, slides = t.bound[index], t.y[:, index], t.s[:, index], t.longest[index], t.slides[index]
        longest = np.maximum(longest, TINY)
        u = y / np.maximum(np.hypot(*y), TINY)
        # dF = dq - along db - across (rho dq - ds)
        along = np.where(slides, u, y * self._laws.regularisation / longest**2)
        keep = b / longest
        turn = np.where(slides, keep, 0.0)
        across = np.array(
            [[keep - turn * u[0] ** 2, -turn * u[0] * u[1]], [-turn * u[0] * u[1], keep - turn * u[1] ** 2]]
        )
        db = None if slope is None or t.held else t.mu[index, None] * slope
        if t.fall.any() and not t.held:
            direction = (t.pressure * t.fall)[index] * s / np.maximum(np.hypot(*s), TINY)
            fall = direction[0][:, None] * slip[:k] + direction[1][:, None] * slip[k:]
            db = fall if db is None else db + fall
        jacobian = np.empty((2 * k, 2 * k))
        diagonal = np.arange(k)
        for i, rows in enumerate((slice(0, k), slice(k, 2 * k))):
            block = jacobian[rows]
            np.multiply(across[i, 0][:, None], slip[:k], out=block)
            block += across[i, 1][:, None] * slip[k:]
            if db is not None:
                block -= along[i][:, None] * db
            for j in range(2):
                block[diagonal, j * k + diagonal] += (i == j) - across[i, j] * self.rho[index]
        found = linear_solve(jacobian, -t.F[:, index].ravel(), options, count)
        whole = np.zeros((2, n))
        whole[:, index] = found.reshape(2, k)
        return whole

    def _linearised(self, active: Mask, inside: Mask, count: Count) -> tuple[Nodes, Array, Array | None]:
        """Points inside (k,), ds/dq (2 k, 2 k) with the pressure following, and dp/dq (k, 2 k), of those."""
        key = active.tobytes() + inside.tobytes()
        if key not in self._known:
            index = np.flatnonzero(inside)
            both = np.concatenate([index, len(active) + index])
            slip = self._slip if inside.all() else self._slip[np.ix_(both, both)]
            steep, slope = self._pressure.slope(active, count), None
            if steep is not None and self._shift is not None:
                slope = np.zeros((len(index), len(both)))
                slope[active[index]] = steep[:, both]
                slip = slip + self._shift[np.ix_(both, np.flatnonzero(active))] @ slope[active[index]]
            self._known.clear()
            self._known[key] = index, slip, slope
        return self._known[key]


def tangential_contact(friction: Friction, q: Array, active: Mask, options: NewtonOptions, count: Count) -> Trial:
    """Tractions with F(q) = 0 from a guess q (2, n).

    Newton may end in a minimum of |F| that is no zero where friction falls steeply and F folds. Then bounds are held
    and tractions found for them in turn, starting at Coulomb's: the more slip the less friction and the less friction
    the more slip, so these bounds fall in order towards the largest that agree with their own slip, and Newton takes
    over once it is near. Where pressure depends on friction, the same is a contraction. Raises NotConverged.
    """
    try:
        return newton(friction, friction.at(q, active, count), options, count)
    except NotConverged:
        t = friction.at(np.zeros_like(q), active, count)
        bound = t.pressure * t.mu.max()
        for k in range(ROUNDS):
            t = newton(friction, friction.at(t.q, t.active, count, bound), options, count)
            t = friction.at(t.q, t.active, count)
            if k == ROUNDS - 1:
                break
            bound = t.bound
            try:
                return newton(friction, t, options, count)
            except NotConverged:
                continue
        return newton(friction, t, options, count)


def newton(friction: Friction, t: Trial, options: NewtonOptions, count: Count) -> Trial:
    """Semi-smooth Newton with Armijo backtracking from a trial; its bound stays held if it is.

    Raises NotConverged.
    """
    stalls = 0
    for _ in range(options.iterations):
        scale = max(float(np.linalg.norm(t.bound)), TINY)
        count.residual = t.norm / scale
        if t.norm <= options.tolerance * scale:
            return t
        if stalls == STALLS:
            break
        count.newton += 1
        step, damping = friction.step(t, options, count), 1.0
        while True:
            trial = friction.at(t.q + damping * step, t.active, count, t.bound if t.held else None)
            if trial.norm <= (1 - 1e-4 * damping) * t.norm:
                break
            if damping < 1e-3:
                stalls += 1
                break
            damping /= 2
        t = trial
    raise NotConverged(f"friction: relative residual {count.residual:.1e} after {count.newton} Newton steps")


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
