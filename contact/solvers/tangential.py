"""The tangential problem: a semi-smooth Newton for exact and regularised Coulomb friction.

The law q = -b s / max(|s|, eps), |q| <= b, of which eps = 0 leaves q undecided at s = 0, is the same as

    q = b y / max(|y|, b rho + eps),   y = rho q - s,

for any rho > 0 [1/Pa]: a projection on the disc of radius b = mu(|s| V) p, smooth where it does not switch. Pressure
follows the tractions, p = P(q), so Newton runs on q alone: F(q) = q - b y / max(|y|, b rho + eps).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.linalg as la

from wheelrail.contact.laws.coulomb import derivative, residual
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.solvers.linear import factorised, iterated
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions
from wheelrail.support.arrays import Array, Mask, Nodes

NONE, NOTHING = np.empty((0, 0)), np.empty(0)


# k points, their indices (k,), ds/dq (2 k, 2 k) with the pressure following, and dp/dq (k, 2 k), None without coupling
SlipLinearisation = tuple[Nodes, Array, Array | None]


class SolverCache:
    """Linearisation of slip and pressure on one set of points, and LU factors of a Jacobian there, shared by solves
    with the same compliance.
    """

    def __init__(self) -> None:
        self.factors: tuple[Array, Nodes] | None = None
        self._points = b""
        self._linearisation: SlipLinearisation | None = None

    def linearised_for(self, active: Mask, loaded: Mask) -> SlipLinearisation | None:
        """The linearisation stored for these active points (n,) and these that carry or may carry traction (n,), if
        any.
        """
        return self._linearisation if self._points == _key(active, loaded) else None

    def store(self, active: Mask, loaded: Mask, linearisation: SlipLinearisation) -> None:
        """Replaces what is stored for other points; their factors go, too."""
        self._points, self._linearisation, self.factors = _key(active, loaded), linearisation, None


def _key(active: Mask, loaded: Mask) -> bytes:
    return active.tobytes() + loaded.tobytes()


class PressureResponse(Protocol):
    """Pressures as a function of the tangential tractions; see `wheelrail.contact.solvers.active_set`."""

    def at(self, q: Array, active: Mask, count: IterationCount, /) -> tuple[Array, Mask]: ...

    def slope(self, active: Mask, count: IterationCount, /) -> Array | None: ...


@dataclass(frozen=True)
class FrictionState:
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


class FrictionProblem:
    """F(q) and its derivative for n points: slip S (2 n, 2 n) 1/Pa of the tractions and rigid (2 n,); T (2 n, n) 1/Pa,
    slip of the pressure (None: within rigid); speed m/s; cache, shared by solves with the same compliance.
    """

    def __init__(
        self,
        slip: Array,
        rigid: Array,
        shift: Array | None,
        pressure: PressureResponse,
        laws: ContactLaws,
        speed: float,
        cache: SolverCache | None = None,
    ) -> None:
        n = len(rigid) // 2
        own = 0.5 * (np.diag(slip)[:n] + np.diag(slip)[n:])
        self.rho = np.maximum(own, 1e-3 * np.abs(own).max())
        self._slip, self._rigid, self._shift, self._pressure = slip, rigid, shift, pressure
        self._laws, self._speed = laws, speed
        self._cache = SolverCache() if cache is None else cache

    @property
    def falls(self) -> bool:
        """Whether friction falls with the slip velocity."""
        return self._laws.falling is not None

    def at(self, q: Array, active: Mask, count: IterationCount, bound: Array | None = None) -> FrictionState:
        """The trial at q (2, n), with bounds (n,) held if given; active points are only where to start from."""
        p, active = self._pressure.at(q.ravel(), active, count)
        s = self._rigid + self._slip @ q.ravel()
        if self._shift is not None:
            s = s + self._shift @ p
        s = s.reshape(2, -1)
        mu, fall = self._laws.friction_at(np.hypot(s[0], s[1]), self._speed)
        b = mu * p if bound is None else bound
        y, longest, slides, F, norm = residual(q, s, b, self.rho, self._laws.regularisation)
        return FrictionState(q, p, active, s, y, mu, fall, b, longest, slides, F, norm, bound is not None)

    def step(self, t: FrictionState, options: NewtonOptions, count: IterationCount) -> Array:
        """Newton's step (2, n) from a trial."""
        index, slip, slope = self._linearised(t, count)
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
        self._cache.factors = factors = factorised(jacobian)
        return _spread(la.lapack.dgetrs(*factors, right)[0], index, t.q.shape)

    def chord(self, t: FrictionState, count: IterationCount) -> Array | None:
        """The step (2, n) by the factors of an earlier Jacobian, if there are any for the same points."""
        cache = self._cache
        if cache.factors is None or t.held:
            return None
        index, _, _ = self._linearised(t, count)
        if cache.factors is None:  # they were those of other points
            return None
        return _spread(la.lapack.dgetrs(*cache.factors, -t.F[:, index].ravel())[0], index, t.q.shape)

    def _linearised(self, t: FrictionState, count: IterationCount) -> SlipLinearisation:
        """Slip and pressure by the tractions of the points that carry or may carry any, with the pressure following."""
        active = t.active
        loaded = active | (t.q[0] != 0) | (t.q[1] != 0) | (t.bound > 0)
        stored = self._cache.linearised_for(active, loaded)
        if stored is not None:
            return stored
        index = np.flatnonzero(loaded)
        rows = np.concatenate([index, len(active) + index])
        slip = self._slip if loaded.all() else self._slip[np.ix_(rows, rows)]
        steep, slope = self._pressure.slope(active, count), None
        if steep is not None and self._shift is not None:
            slope = np.zeros((len(index), len(rows)))
            slope[active[index]] = steep[:, rows]
            slip = slip + self._shift[np.ix_(rows, np.flatnonzero(active))] @ slope[active[index]]
        self._cache.store(active, loaded, (index, slip, slope))
        return index, slip, slope


def _spread(values: Array, index: Nodes, shape: tuple[int, ...]) -> Array:
    """Values (2 k,) at points of all (2, n)."""
    if len(index) == shape[1]:
        return values.reshape(shape)
    whole = np.zeros(shape)
    whole[:, index] = values.reshape(2, -1)
    return whole
