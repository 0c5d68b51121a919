"""Tangential problem: semi-smooth Newton equations of exact and regularised Coulomb friction.

The law q = -b s / max(|s|, eps), |q| <= b, which for eps = 0 leaves q undetermined at s = 0, is equivalent to

    q = b y / max(|y|, b rho + eps),   y = rho q - s,

for any rho > 0 [1/Pa]: a projection on the disc of radius b = mu(|s| V, p) p, smooth away from the switch. The pressure
is a function of the tractions, p = P(q), so Newton runs on q alone: F(q) = q - b y / max(|y|, b rho + eps), whose
pointwise slopes are those of the law in UFL (`wheelrail.contact.laws.pointwise`).
"""

from __future__ import annotations

from dataclasses import dataclass
from inspect import signature
from typing import Protocol

import numpy as np
import scipy.linalg as la
import scipy.sparse.linalg as sla

from wheelrail.contact.laws.linearised_friction import assembled
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.solvers.options import IterationCount, NewtonOptions
from wheelrail.support.arrays import Array, Mask, Nodes

NONE = np.empty((0, 0))


# indices (k,) of k points, total derivative ds/dq (2 k, 2 k), and dp/dq (k, 2 k), None without coupling
SlipLinearisation = tuple[Nodes, Array, Array | None]


RELATIVE = "rtol" if "rtol" in signature(sla.bicgstab).parameters else "tol"  # renamed in SciPy 1.12


def iterated(matrix: Array, right: Array, options: NewtonOptions, count: IterationCount) -> Array | None:
    """Solution of Newton's linear system by BiCGStab to the forcing term, eqs. (17) and (18); None if not converged."""
    steps = 0

    def counted(_: Array) -> None:
        nonlocal steps
        steps += 1

    solution, info = sla.bicgstab(matrix, right, **{RELATIVE: options.forcing}, atol=0.0, maxiter=200, callback=counted)
    count.linear += steps
    return np.asarray(solution) if info == 0 else None


def factorised(matrix: Array) -> tuple[Array, Nodes]:
    """LU factors of a small matrix without SciPy's checks, which cost as much as the factorisation.

    Raises LinAlgError for a singular matrix.
    """
    lu, pivots, info = la.lapack.dgetrf(matrix, overwrite_a=1)
    if info:
        raise np.linalg.LinAlgError(f"the Jacobian of the friction problem is singular (LAPACK's dgetrf: {info})")
    return lu, pivots


class SolverCache:
    """Linearisation of slip and pressure on one set of points, and LU factors, for one compliance matrix."""

    def __init__(self) -> None:
        self.factors: tuple[Array, Nodes] | None = None
        self._points = b""
        self._linearisation: SlipLinearisation | None = None

    def linearised_for(self, active: Mask, loaded: Mask) -> SlipLinearisation | None:
        """Linearisation for given active points (n,) and points that may carry traction (n,), or None."""
        return self._linearisation if self._points == _key(active, loaded) else None

    def store(self, active: Mask, loaded: Mask, linearisation: SlipLinearisation) -> None:
        """Replaces the stored linearisation and discards the factors."""
        self._points, self._linearisation, self.factors = _key(active, loaded), linearisation, None


def _key(active: Mask, loaded: Mask) -> bytes:
    return active.tobytes() + loaded.tobytes()


class PressureResponse(Protocol):
    """Pressures as a function of the tangential tractions, see `wheelrail.contact.solvers.active_set`."""

    def at(self, q: Array, active: Mask, count: IterationCount, /) -> tuple[Array, Mask]: ...

    def slope(self, active: Mask, count: IterationCount, /) -> Array | None: ...

    piecewise_linear: bool  # whether the slope depends on the active points only


@dataclass(frozen=True)
class FrictionState:
    """State of the tangential problem at given tractions.

    Parameters:
        q: (2, n) Pa, tangential tractions.
        pressure: (n,) Pa.
        active: (n,) mask.
        s: (2, n), slip over the rolling speed.
        bound: b (n,) Pa.
        F, norm: residual (2, n) Pa and its norm.
        held: whether the bound is fixed.
    """

    q: Array
    pressure: Array
    active: Mask
    s: Array
    bound: Array
    F: Array
    norm: float
    held: bool


class FrictionProblem:
    """F(q) and its derivative at n points.

    Parameters:
        slip: S (2 n, 2 n) 1/Pa, slip by the tractions.
        rigid: (2 n,), rigid slip over the rolling speed.
        shift: T (2 n, n) 1/Pa, slip by the pressure; None if contained in rigid.
        pressure: as a function of the tractions.
        laws: of the interface.
        speed: m/s; slip velocities are zero without it.
        cache: shared by solves with the same compliance.
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
        diagonal = 0.5 * (np.diag(slip)[:n] + np.diag(slip)[n:])
        self.rho = np.maximum(diagonal, 1e-3 * np.abs(diagonal).max())
        self._slip, self._rigid, self._shift, self._pressure = slip, rigid, shift, pressure
        self._law, self._eps, self._speed = laws.pointwise_friction, laws.regularisation, speed
        self._cache = SolverCache() if cache is None else cache

    @property
    def depends_on_speed(self) -> bool:
        """Whether friction depends on the slip velocity."""
        return self._law.depends_on_speed

    def bound_at_rest(self, pressure: Array) -> Array:
        """Friction bound (n,) Pa without slip, of pressures (n,) Pa."""
        return self._law.coefficient(np.zeros(len(pressure)), pressure) * pressure

    def at(self, q: Array, active: Mask, count: IterationCount, bound: Array | None = None) -> FrictionState:
        """State at tractions q.

        Parameters:
            q: (2, n) Pa.
            active: (n,) initial guess of the active points.
            count: of iterations, updated.
            bound: (n,) Pa, fixed friction bounds; None computes them.
        """
        p, active = self._pressure.at(q.ravel(), active, count)
        s = self._rigid + self._slip @ q.ravel()
        if self._shift is not None:
            s = s + self._shift @ p
        s = s.reshape(2, -1)
        q = np.ascontiguousarray(q)
        if bound is None:
            b, F, norm = self._law.residual(q, s, p, self.rho, self._speed, self._eps)
            return FrictionState(q, p, active, s, b, F, norm, held=False)
        F, norm = self._law.bounded_residual(q, s, bound, self.rho, self._eps)
        return FrictionState(q, p, active, s, bound, F, norm, held=True)

    def step(self, t: FrictionState, options: NewtonOptions, count: IterationCount) -> Array:
        """Newton step (2, n) Pa from a state."""
        index, slip, slope = self._linearised(t, count)
        if t.held:
            slopes = self._law.bounded_slopes(index, t.q, t.s, t.bound, self.rho, self._eps)
        else:
            slopes = self._law.slopes(index, t.q, t.s, t.pressure, self.rho, self._speed, self._eps)
        jacobian = assembled(slopes, slip, NONE if slope is None or t.held else slope)
        right = -t.F[:, index].ravel()
        if options.linear == "bicgstab" and (solution := iterated(jacobian, right, options, count)) is not None:
            return _scatter(solution, index, t.q.shape)
        self._cache.factors = factors = factorised(jacobian)
        return _scatter(la.lapack.dgetrs(*factors, right)[0], index, t.q.shape)

    def chord(self, t: FrictionState, count: IterationCount) -> Array | None:
        """Step (2, n) Pa with the factors of an earlier Jacobian; None if there are none for the same points."""
        cache = self._cache
        if cache.factors is None or t.held or not self._pressure.piecewise_linear:
            return None
        index, _, _ = self._linearised(t, count)
        if cache.factors is None:  # they belonged to other points
            return None
        return _scatter(la.lapack.dgetrs(*cache.factors, -t.F[:, index].ravel())[0], index, t.q.shape)

    def _linearised(self, t: FrictionState, count: IterationCount) -> SlipLinearisation:
        """Derivatives of slip and pressure by the tractions of the points that carry or may carry any."""
        active = t.active
        loaded = active | (t.q[0] != 0) | (t.q[1] != 0) | (t.bound > 0)
        stored = self._cache.linearised_for(active, loaded)
        if stored is not None and self._pressure.piecewise_linear:
            return stored
        index = np.flatnonzero(loaded)
        rows = np.concatenate([index, len(active) + index])
        slip = self._slip if loaded.all() else self._slip[np.ix_(rows, rows)]
        gradient, slope = self._pressure.slope(active, count), None
        if gradient is not None and self._shift is not None:
            slope = np.zeros((len(index), len(rows)))
            slope[active[index]] = gradient[:, rows]
            slip = slip + self._shift[np.ix_(rows, np.flatnonzero(active))] @ slope[active[index]]
        self._cache.store(active, loaded, (index, slip, slope))
        return index, slip, slope


def _scatter(values: Array, index: Nodes, shape: tuple[int, ...]) -> Array:
    """Values (2 k,) at the points index (k,), scattered into an array (2, n)."""
    if len(index) == shape[1]:
        return values.reshape(shape)
    whole = np.zeros(shape)
    whole[:, index] = values.reshape(2, -1)
    return whole
