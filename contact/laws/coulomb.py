"""Linearised law of friction at fixed stick and slip: own q' + by_slip s' = by_pressure p' + by_speed V'.

It is F' = 0 of `wheelrail.contact.solvers.tangential` at a solution: s' = 0 where a point sticks; where it slides,
|q| = b = mu(|s| V) p and q rotates with its slip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.support.arrays import Array, Mask, Nodes
from wheelrail.support.compiled import compiled


@dataclass(frozen=True, eq=False)
class LinearisedFriction:
    """Coefficients at a points: own and by_slip (2, 2, a), by_pressure and by_speed (2, a); slides (a,) mask."""

    own: Array
    by_slip: Array
    by_pressure: Array
    by_speed: Array
    slides: Mask

    @classmethod
    def at(cls, rho: Array, p: Array, q: Array, s: Array, *, laws: ContactLaws, speed: float) -> LinearisedFriction:
        """Linearisation at a solution.

        Parameters:
            rho: (a,) 1/Pa as in `wheelrail.contact.solvers.tangential`, arbitrary positive values.
            p: (a,) Pa, pressures.
            q, s: (2, a), tractions Pa and slips over the rolling speed.
            laws: of the interface.
            speed: m/s.
        """
        size = np.hypot(*s)
        mu, fall = laws.friction_at(size, speed)
        b, eps = mu * p, laws.regularisation
        y, longest, slides, _, _ = residual(np.ascontiguousarray(q), np.ascontiguousarray(s), b, rho, eps)
        u = y / np.maximum(np.hypot(*y), TINY)
        along = np.where(slides, u, y * eps / longest**2)
        across = b / longest * (np.eye(2)[..., None] - slides * u[:, None] * u)
        drop = p * fall * s / np.maximum(size, TINY)  # of the bound, as slip grows
        return cls(
            own=np.eye(2)[..., None] - across * rho,
            by_slip=across - along[:, None] * drop,
            by_pressure=along * mu,
            by_speed=along * (p * fall * size / speed if speed else 0.0),
            slides=slides,
        )

    def slip(self, change: Array) -> Array:
        """by_slip times changes (2 a, m) of the slip."""
        product, a = np.empty_like(change), len(change) // 2
        for rows, (first, second) in zip((slice(a), slice(a, None)), self.by_slip, strict=True):
            np.multiply(first[:, None], change[:a], out=product[rows])
            product[rows] += second[:, None] * change[a:]
        return product

    def pressure(self, change: Array) -> Array:
        """by_pressure times changes (a, m) of the pressure."""
        return np.asarray((self.by_pressure[..., None] * change).reshape(-1, change.shape[1]))


TINY = 1e-300


@compiled
def residual(q: Array, s: Array, b: Array, rho: Array, eps: float) -> tuple[Array, Array, Mask, Array, float]:
    """y (2, n), max(|y|, b rho + eps), where it is |y|, F (2, n) and its norm; see `FrictionState`.

    Parameters:
        q, s: (2, n), tractions Pa and slips.
        b: (n,) Pa, friction bounds.
        rho: (n,) 1/Pa.
        eps: regularising creepage.
    """
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
    """dF/dq (2 k, 2 k) at the points index (k,): dF = dq - along db - across (rho dq - ds); column-major for LAPACK.

    Parameters:
        index: (k,) of the n points.
        slip: ds/dq (2 k, 2 k) 1/Pa.
        slope: dp/dq (k, 2 k), empty without coupling.
        y, s, bound, longest, slides, mu: as in `FrictionState`.
        rho: (n,) 1/Pa.
        falls: (n,) p dmu/d|s|, empty for constant friction.
        eps: regularising creepage.
    """
    k = len(index)
    transposed = np.empty((2 * k, 2 * k))
    for i in range(k):
        m = index[i]
        length = max(np.sqrt(y[0, m] * y[0, m] + y[1, m] * y[1, m]), TINY)
        ux, uy = y[0, m] / length, y[1, m] / length
        part = bound[m] / longest[m]
        if slides[m]:
            along_x, along_y = ux, uy
            xx, xy, yy = part * (1.0 - ux * ux), -part * ux * uy, part * (1.0 - uy * uy)
        else:
            over = eps / (longest[m] * longest[m])
            along_x, along_y = y[0, m] * over, y[1, m] * over
            xx, xy, yy = part, 0.0, part
        for c in range(2 * k):
            sx, sy = slip[i, c], slip[k + i, c]
            db = 0.0
            if len(slope):
                db += mu[m] * slope[i, c]
            if len(falls):
                size = max(np.sqrt(s[0, m] * s[0, m] + s[1, m] * s[1, m]), TINY)
                db += falls[m] * (s[0, m] * sx + s[1, m] * sy) / size
            transposed[c, i] = xx * sx + xy * sy - along_x * db
            transposed[c, k + i] = xy * sx + yy * sy - along_y * db
        transposed[i, i] += 1.0 - xx * rho[m]
        transposed[k + i, i] -= xy * rho[m]
        transposed[i, k + i] -= xy * rho[m]
        transposed[k + i, k + i] += 1.0 - yy * rho[m]
    return transposed.T
