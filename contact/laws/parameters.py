"""Contact laws as data."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class FallingFriction:
    """Friction that falls with the slip velocity w = |s| V: mu(w) = mu0 ((1 - A) exp(-B w) + A).

    Parameters:
        share: A, fraction of mu0 that remains at high slip, 0 to 1 (1: Coulomb).
        rate: B, s/m, not negative.

    Polach 2005, doi:10.1016/j.wear.2004.03.046. Raises ValueError.
    """

    share: float
    rate: float

    def __post_init__(self) -> None:
        if not 0 <= self.share <= 1:
            raise ValueError(f"share = {self.share}: the fraction of friction at high slip must be from 0 to 1")
        if not (self.rate >= 0 and math.isfinite(self.rate)):
            raise ValueError(f"rate = {self.rate} s/m: must be finite and not negative")


@dataclass(frozen=True)
class ContactLaws:
    """Contact laws: exact unilateral contact and Coulomb friction, or regularised as in eqs. (4) and (6).

    Parameters:
        stiffness_per_area: K of the penalty pressure, N/m3; inf is the exact law without penetration.
        friction: coefficient mu; 0 omits the tangential problem.
        regularisation: creepage eps below which friction is viscous; 0 is Coulomb's law.
        falling: decrease of mu with the slip velocity; None is constant friction.

    Raises ValueError.
    """

    stiffness_per_area: float = math.inf
    friction: float = 0.3
    regularisation: float = 0.0
    falling: FallingFriction | None = None

    def __post_init__(self) -> None:
        if not self.stiffness_per_area > 0:
            raise ValueError(f"stiffness_per_area = {self.stiffness_per_area} N/m3: must be positive")
        if not (self.friction >= 0 and math.isfinite(self.friction)):
            raise ValueError(f"friction = {self.friction}: must be finite and not negative")
        if not (self.regularisation >= 0 and math.isfinite(self.regularisation)):
            raise ValueError(f"regularisation = {self.regularisation}: must be finite and not negative")

    @classmethod
    def penalty(cls, friction: float = 0.3) -> ContactLaws:
        """Penalty and regularisation of eqs. (4) and (6) with the constants 1e15 N/m3 and 1e-5."""
        return cls(1e15, friction, 1e-5)

    @property
    def normal_compliance(self) -> float:
        """1/K [m3/N], zero for the exact law; added to the diagonal of the compliance."""
        return 1.0 / self.stiffness_per_area

    def friction_at(self, slip: Array, speed: float) -> tuple[Array, Array]:
        """Friction coefficient mu (n,) and d mu / d|s| (n,) at slips |s| (n,) over the rolling speed [m/s]."""
        if self.falling is None:
            return np.full(slip.shape, self.friction), np.zeros(slip.shape)
        A, B = self.falling.share, self.falling.rate * speed
        part = self.friction * (1 - A) * np.exp(-B * slip)
        return self.friction * A + part, -B * part
