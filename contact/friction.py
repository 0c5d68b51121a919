"""The tangential problem: a semi-smooth Newton for exact and regularised Coulomb friction.

The law q = -b s / max(|s|, eps), |q| <= b, of which eps = 0 leaves q undecided at s = 0, is the same as

    q = b y / max(|y|, b rho + eps),   y = rho q - s,

for any rho > 0 [1/Pa]: a projection on the disc of radius b = mu(|s| V) p, smooth where it does not switch. Pressure
follows the tractions, p = P(q), so Newton runs on q alone: F(q) = q - b y / max(|y|, b rho + eps).
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from inspect import signature
from typing import Protocol

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as sla

from contact.convergence import Count, NewtonOptions, NotConverged
from contact.interrupts import look
from contact.laws import Laws
from contact.pose import Array, Mask, Nodes
from meshes.compiled import compiled

RELATIVE = "rtol" if "rtol" in signature(sla.bicgstab).parameters else "tol"  # renamed in SciPy 1.12
TINY = 1e-300
STALLS = 3  # steps without descent that end an attempt
PATIENCE = 8  # steps that halve the misfit, or an attempt ends
FULL = 15  # steps without damping
ROUNDS = 60  # bounds held in turn
NEAR = 0.1  # of the bound: a misfit from which Newton's method is tried again
CHORD = 0.1  # of the misfit: a step with old factors that leaves more is not worth it

NONE, NOTHING = np.empty((0, 0)), np.empty(0)


@dataclass
class Known:
    """What solves with the same compliance leave for each other.

    Sets of points as bytes, with the points inside (k,), ds/dq (2 k, 2 k) with the pressure following, and dp/dq (k, 2
    k); and LU factors of a Jacobian there.
    """

    sets: bytes = b""
    linearised: tuple[Nodes, Array, Array | None] | None = None
    factors: tuple[Array, Nodes] | None = None


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
        self._known = Known() if known is None else known

    @property
    def falls(self) -> bool:
        """Whether friction falls with the slip velocity."""
        return self._laws.falling is not None

    def at(self, q: Array, active: Mask, count: Count, bound: Array | None = None) -> Trial:
        """The trial at q (2, n), with bounds (n,) held if given; active points are only where to start from."""
        p, active = self._pressure.at(q.ravel(), active, count)
        s = self._rigid + self._slip @ q.ravel()
        if self._shift is not None:
            s = s + self._shift @ p
        s = s.reshape(2, -1)
        mu, fall = self._laws.friction_at(np.hypot(s[0], s[1]), self._speed)
        b = mu * p if bound is None else bound
        y, longest, slides, F, norm = misfit(q, s, b, self.rho, self._laws.regularisation)
        return Trial(q, p, active, s, y, mu, fall, b, longest, slides, F, norm, bound is not None)

    def step(self, t: Trial, options: NewtonOptions, count: Count) -> Array:
        """Newton's step (2, n) from a trial."""
        index, slip, slope = self._linearised(t, count)
        known = self._known
        falls = bool(t.fall.any()) and not t.held
        jacobian = derivative(
            index,
            slip,
            NONE if slope is None or t.held else slope,
            t.y,
            t.s,
            t.bound,
            t.longest,
            t.slides,
            self.rho,
            t.mu,
            t.pressure * t.fall if falls else NOTHING,
            self._laws.regularisation,
        )
        right = -t.F[:, index].ravel()
        if options.linear == "bicgstab" and (found := iterated(jacobian, right, options, count)) is not None:
            return _spread(found, index, t.q.shape)
        known.factors = factorised(jacobian)
        return _spread(la.lapack.dgetrs(*known.factors, right)[0], index, t.q.shape)

    def chord(self, t: Trial, count: Count) -> Array | None:
        """The step (2, n) by the factors of an earlier Jacobian, if there are any for the same points."""
        known = self._known
        if known.factors is None or t.held:
            return None
        index, _, _ = self._linearised(t, count)
        if known.factors is None:  # they were those of other points
            return None
        return _spread(la.lapack.dgetrs(*known.factors, -t.F[:, index].ravel())[0], index, t.q.shape)

    def _linearised(self, t: Trial, count: Count) -> tuple[Nodes, Array, Array | None]:
        """Points inside (k,), ds/dq (2 k, 2 k) with the pressure following, and dp/dq (k, 2 k), of those."""
        active, known = t.active, self._known
        inside = active | (t.q[0] != 0) | (t.q[1] != 0) | (t.bound > 0)
        sets = active.tobytes() + inside.tobytes()
        if known.linearised is None or sets != known.sets:
            index = np.flatnonzero(inside)
            both = np.concatenate([index, len(active) + index])
            slip = self._slip if inside.all() else self._slip[np.ix_(both, both)]
            steep, slope = self._pressure.slope(active, count), None
            if steep is not None and self._shift is not None:
                slope = np.zeros((len(index), len(both)))
                slope[active[index]] = steep[:, both]
                slip = slip + self._shift[np.ix_(both, np.flatnonzero(active))] @ slope[active[index]]
            known.sets, known.linearised, known.factors = sets, (index, slip, slope), None
        return known.linearised


def _spread(values: Array, index: Nodes, shape: tuple[int, ...]) -> Array:
    """Values (2 k,) at points of all (2, n)."""
    if len(index) == shape[1]:
        return values.reshape(shape)
    whole = np.zeros(shape)
    whole[:, index] = values.reshape(2, -1)
    return whole


@compiled
def misfit(q: Array, s: Array, b: Array, rho: Array, eps: float) -> tuple[Array, Array, Mask, Array, float]:
    """y, the larger of |y| and b rho + eps, where it is |y|, F and its norm, see `Trial`."""
    n = len(b)
    y, F, longest, slides = np.empty((2, n)), np.empty((2, n)), np.empty(n), np.empty(n, dtype=np.bool_)
    total = 0.0
    for i in range(n):
        y[0, i], y[1, i] = rho[i] * q[0, i] - s[0, i], rho[i] * q[1, i] - s[1, i]
        length, limit = np.sqrt(y[0, i] * y[0, i] + y[1, i] * y[1, i]), b[i] * rho[i] + eps
        slides[i] = length > limit
        longest[i] = max(length, limit, TINY)
        part = b[i] / longest[i]
        F[0, i], F[1, i] = q[0, i] - part * y[0, i], q[1, i] - part * y[1, i]
        total += F[0, i] * F[0, i] + F[1, i] * F[1, i]
    return y, longest, slides, F, np.sqrt(total)


@compiled
def derivative(
    index: Nodes,
    slip: Array,
    slope: Array,
    y: Array,
    s: Array,
    bound: Array,
    longest: Array,
    slides: Mask,
    rho: Array,
    mu: Array,
    falls: Array,
    eps: float,
) -> Array:
    """dF/dq (2 k, 2 k) at the points index (k,): dF = dq - along db - across (rho dq - ds).

    slip (2 k, 2 k) and slope (k, 2 k) are ds/dq and dp/dq, an empty slope none; falls (n,) p dmu/d|s|, empty for none.
    Column by column in memory, as LAPACK wants it.
    """
    k = len(index)
    turned = np.empty((2 * k, 2 * k))
    for i in range(k):
        m = index[i]
        length = max(np.sqrt(y[0, m] * y[0, m] + y[1, m] * y[1, m]), TINY)
        ux, uy = y[0, m] / length, y[1, m] / length
        keep = bound[m] / longest[m]
        if slides[m]:
            along_x, along_y = ux, uy
            xx, xy, yy = keep * (1.0 - ux * ux), -keep * ux * uy, keep * (1.0 - uy * uy)
        else:
            over = eps / (longest[m] * longest[m])
            along_x, along_y = y[0, m] * over, y[1, m] * over
            xx, xy, yy = keep, 0.0, keep
        for c in range(2 * k):
            sx, sy = slip[i, c], slip[k + i, c]
            db = 0.0
            if len(slope):
                db += mu[m] * slope[i, c]
            if len(falls):
                fast = max(np.sqrt(s[0, m] * s[0, m] + s[1, m] * s[1, m]), TINY)
                db += falls[m] * (s[0, m] * sx + s[1, m] * sy) / fast
            turned[c, i] = xx * sx + xy * sy - along_x * db
            turned[c, k + i] = xy * sx + yy * sy - along_y * db
        turned[i, i] += 1.0 - xx * rho[m]
        turned[k + i, i] -= xy * rho[m]
        turned[i, k + i] -= xy * rho[m]
        turned[k + i, k + i] += 1.0 - yy * rho[m]
    return turned.T


def tangential_contact(friction: Friction, q: Array, active: Mask, options: NewtonOptions, count: Count) -> Trial:
    """Tractions with F(q) = 0 from a guess q (2, n).

    Where pressure depends on friction, descent may creep along a kink of |F|, of a point that begins to slip: full
    steps cross it. Newton may also end in a minimum of |F| that is no zero where friction falls steeply and F folds.
    Then bounds are held and tractions found for them in turn, starting at Coulomb's: the more slip the less friction
    and the less friction the more slip, so these bounds fall in order towards the largest that agree with their own
    slip, and Newton takes over once it is near. Where pressure depends on friction, the same is a contraction. Raises
    NotConverged.
    """
    try:
        return newton(friction, friction.at(q, active, count), options, count)
    except NotConverged:
        if not friction.falls:  # else full steps might find another of several answers
            with suppress(NotConverged):
                return undamped(friction, friction.at(q, active, count), options, count)
        t = friction.at(np.zeros_like(q), active, count)
        bound = t.pressure * t.mu.max()
        for k in range(ROUNDS):
            t = newton(friction, friction.at(t.q, t.active, count, bound), options, count)
            t = friction.at(t.q, t.active, count)
            if k == ROUNDS - 1:
                break
            bound = t.bound
            if t.norm > NEAR * float(np.linalg.norm(bound)):
                continue
            with suppress(NotConverged):
                return newton(friction, t, options, count)
        return newton(friction, t, options, count)


def newton(friction: Friction, t: Trial, options: NewtonOptions, count: Count) -> Trial:
    """Semi-smooth Newton with Armijo backtracking from a trial; its bound stays held if it is.

    Raises NotConverged.
    """
    stalls, chords, norms = 0, options.linear == "lu", list[float]()
    for k in range(options.iterations):
        look()
        scale = max(float(np.linalg.norm(t.bound)), TINY)
        count.residual = t.norm / scale
        norms.append(t.norm)
        if k >= PATIENCE and t.norm > 0.5 * norms[k - PATIENCE]:
            break
        if t.norm <= options.tolerance * scale:
            return t
        if stalls == STALLS:
            break
        step = friction.chord(t, count) if chords else None
        if step is not None:
            trial = friction.at(t.q + step, t.active, count)
            if trial.norm <= CHORD * t.norm:
                t = trial
                continue
            chords = False  # sets change: only new factors know of it
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


def undamped(friction: Friction, t: Trial, options: NewtonOptions, count: Count) -> Trial:
    """Newton's full steps from a trial, whether |F| falls or not. Raises NotConverged."""
    for _ in range(min(FULL, options.iterations)):
        look()
        count.newton += 1
        t = friction.at(t.q + friction.step(t, options, count), t.active, count)
        scale = max(float(np.linalg.norm(t.bound)), TINY)
        count.residual = t.norm / scale
        if t.norm <= options.tolerance * scale:
            return t
    raise NotConverged(f"friction: relative residual {count.residual:.1e} after {FULL} full steps")


def iterated(matrix: Array, right: Array, options: NewtonOptions, count: Count) -> Array | None:
    """Solution of Newton's linear system by BiCGStab to the forcing term, eqs. (17) and (18); None if it does not get
    there.
    """
    steps = 0

    def tick(_: Array) -> None:
        nonlocal steps
        steps += 1

    solution, info = sla.bicgstab(matrix, right, **{RELATIVE: options.forcing}, atol=0.0, maxiter=200, callback=tick)
    count.linear += steps
    return np.asarray(solution) if info == 0 else None


def factorised(matrix: Array) -> tuple[Array, Nodes]:
    """LU factors, without the checks that cost as much as the factors of a small matrix. Raises LinAlgError."""
    lu, pivots, info = la.lapack.dgetrf(matrix, overwrite_a=1)
    if info:
        raise np.linalg.LinAlgError(f"the Jacobian of friction is singular (LAPACK's dgetrf: {info})")
    return lu, pivots
