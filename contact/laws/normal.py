"""Normal laws: the pressure as a function of the penetration."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from ufl.core.expr import Expr


class NormalLaw(Protocol):
    """A frozen dataclass of numbers with the pressure in UFL."""

    def pressure(self, d: Expr, /) -> Expr:
        """Pressure Pa from the penetration d m, zero for d <= 0 and increasing for d > 0."""

    def __hash__(self) -> int: ...


@dataclass(frozen=True)
class Penalty:
    """Linear penalty pressure p = K max(d, 0), eq. (4); K = inf is exact unilateral contact, 0 <= p, d <= 0, p d = 0.

    Parameters:
        stiffness: K, N/m3, positive.

    Raises ValueError.
    """

    stiffness: float = math.inf

    def __post_init__(self) -> None:
        if not self.stiffness > 0:
            raise ValueError(f"stiffness = {self.stiffness} N/m3: the penalty must be positive")

    def pressure(self, d: Expr, /) -> Expr:
        from wheelrail.forms.traction import larger

        return self.stiffness * larger(d, 0.0)

    @property
    def compliance(self) -> float:
        """1/K [m3/N], zero for exact contact; added to the diagonal of the bodies' compliance."""
        return 1.0 / self.stiffness


@dataclass(frozen=True)
class PowerPenalty:
    """Penalty pressure p = K max(d, 0)^m, for instance of asperities in contact.

    Parameters:
        stiffness: K, N/m2/m^m, positive and finite.
        exponent: m, at least 1: a smaller power has an infinite slope at d = 0.

    Raises ValueError.
    """

    stiffness: float
    exponent: float

    def __post_init__(self) -> None:
        if not 0 < self.stiffness < math.inf:
            raise ValueError(f"stiffness = {self.stiffness} N/m2/m^m: must be positive and finite")
        if not 1 <= self.exponent < math.inf:
            raise ValueError(f"exponent = {self.exponent}: must be at least 1 and finite")

    def pressure(self, d: Expr, /) -> Expr:
        from wheelrail.forms.traction import larger

        return self.stiffness * larger(d, 0.0) ** self.exponent
