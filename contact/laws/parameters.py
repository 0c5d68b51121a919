"""Materials and contact laws as data."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class FallingFriction:
    """Friction that falls with the slip velocity w = |s| V: mu(w) = mu0 ((1 - A) exp(-B w) + A), Polach 2005,
    doi:10.1016/j.wear.2004.03.046.

    share A of mu0 is left at high slip (1: Coulomb); rate B [s/m]. Raises ValueError for impossible values.
    """

    share: float
    rate: float

    def __post_init__(self) -> None:
        if not 0 <= self.share <= 1:
            raise ValueError(f"the share of friction that is left at high slip must be from 0 to 1, got {self.share}")
        if not (self.rate >= 0 and math.isfinite(self.rate)):
            raise ValueError(f"the rate at which friction falls must be finite and not negative, got {self.rate} s/m")


@dataclass(frozen=True)
class ContactLaws:
    """Contact laws: no penetration and Coulomb's friction, each of which may be softened as in eqs. (4) and (6).

    stiffness_per_area K [N/m3] of the penalty pressure (inf: no penetration at all); friction mu (0 skips all
    tangential work); regularisation eps, the creepage below which friction is viscous (0: Coulomb's law itself);
    falling, how mu falls with the slip velocity (None: it does not). Raises ValueError for impossible values.
    """

    stiffness_per_area: float = math.inf
    friction: float = 0.3
    regularisation: float = 0.0
    falling: FallingFriction | None = None

    def __post_init__(self) -> None:
        if not self.stiffness_per_area > 0:
            raise ValueError(f"the penalty stiffness must be positive, got {self.stiffness_per_area} N/m3")
        if not (self.friction >= 0 and math.isfinite(self.friction)):
            raise ValueError(f"the friction coefficient must be finite and not negative, got {self.friction}")
        if not (self.regularisation >= 0 and math.isfinite(self.regularisation)):
            raise ValueError(f"the regularising creepage must be finite and not negative, got {self.regularisation}")

    @classmethod
    def penalty(cls, friction: float = 0.3) -> ContactLaws:
        """Penalty and regularisation with the paper's constants, 1e15 N/m3 and 1e-5."""
        return cls(1e15, friction, 1e-5)

    @property
    def normal_compliance(self) -> float:
        """1/K [m3/N], zero for the exact law: the penalty is a compliance on the diagonal."""
        return 1.0 / self.stiffness_per_area

    def friction_at(self, slip: Array, speed: float) -> tuple[Array, Array]:
        """mu (n,) and d mu / d|s| (n,) at slips |s| (n,) over the rolling speed [m/s]."""
        if self.falling is None:
            return np.full(slip.shape, self.friction), np.zeros(slip.shape)
        A, B = self.falling.share, self.falling.rate * speed
        part = self.friction * (1 - A) * np.exp(-B * slip)
        return self.friction * A + part, -B * part
