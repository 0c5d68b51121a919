"""Linearised law of friction at fixed stick and slip: own q' + by_slip s' = by_pressure p' + by_speed V'.

It is F' = 0 of `wheelrail.contact.solvers.tangential` at a solution: s' = 0 where a point sticks; where it slides,
|q| = b = mu(|s| V, p) p and q rotates with its slip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.bindings._contact import assembled_columns
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.support.arrays import Array, Mask


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
        q, s, p, rho = (np.ascontiguousarray(part) for part in (q, s, p, rho))
        eps = laws.regularisation
        slopes = laws.pointwise_friction.slopes(np.arange(len(p)), q, s, p, rho, speed, eps).T
        bound = laws.friction_bound(p, np.hypot(*s), speed)
        return cls(
            own=slopes[:4].reshape(2, 2, -1),
            by_slip=slopes[4:8].reshape(2, 2, -1),
            by_pressure=-slopes[8:10],
            by_speed=-slopes[10:],
            slides=np.hypot(*(rho * q - s)) > bound * rho + eps,
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


def assembled(slopes: Array, slip: Array, slope: Array) -> Array:
    """dF/dq (2 k, 2 k) of k points, in the order of columns for LAPACK.

    Parameters:
        slopes: (k, 12), of `wheelrail.contact.laws.pointwise.FrictionFunctions`.
        slip: ds/dq (2 k, 2 k) 1/Pa.
        slope: dp/dq (k, 2 k), empty without coupling.
    """
    return np.asarray(assembled_columns(slopes, np.ascontiguousarray(slip), np.ascontiguousarray(slope)).T)
