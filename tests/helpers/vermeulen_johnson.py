"""Conical wheels with the saturating creep force of Vermeulen and Johnson, as in Cooperrider's bogie."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from linear_creep import LinearCreep


@dataclass(frozen=True)
class VermeulenJohnson(LinearCreep):
    """Creep forces that saturate at the friction bound; stiff vertical springs."""

    radius: float = 0.4572
    wheel_y: float = 0.716
    conicity: float = 0.05
    load: float = 66.66e3
    vertical: float = 1e10
    lateral: float = 0.0
    modulus: float = 8.08e10 * np.pi * 6.578e-3 * 3.934e-3  # N, G times the area of the ellipse
    across: float = 0.54219
    along: float = 0.60252
    bound: float = 10e3  # N

    def creep_force(self, along: float, across: float) -> tuple[float, float]:
        x, y = along / self.along, across / self.across
        u = self.modulus * float(np.hypot(x, y)) / self.bound
        secant = 1.0 - u / 3 + u**2 / 27 if u < 3.0 else 1.0 / u
        return -self.modulus * secant * x, -self.modulus * secant * y
