"""The law of friction on fixed sides of it, to first order: own q' + by_slip s' = by_pressure p' + by_speed V'.

It is F' = 0 of `contact.friction` for the tractions found: a point that sticks has s' = 0, one that slides keeps
|q| = b = mu(|s| V) p and turns q with its slip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact.friction import TINY, misfit
from contact.laws import Laws
from contact.pose import Array, Mask


@dataclass(frozen=True, eq=False)
class LawSlope:
    """Factors at a points: own and by_slip (2, 2, a), by_pressure and by_speed (2, a); slides (a,)."""

    own: Array
    by_slip: Array
    by_pressure: Array
    by_speed: Array
    slides: Mask

    @classmethod
    def at(cls, rho: Array, p: Array, q: Array, s: Array, *, laws: Laws, speed: float) -> LawSlope:
        """Around pressures (a,), tractions and slips (2, a); rho (a,) 1/Pa as in `contact.friction`, any will do."""
        size = np.hypot(*s)
        mu, fall = laws.friction_at(size, speed)
        b, eps = mu * p, laws.regularisation
        y, longest, slides, _, _ = misfit(np.ascontiguousarray(q), np.ascontiguousarray(s), b, rho, eps)
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
