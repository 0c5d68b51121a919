"""Friction laws: the friction coefficient as a function of slip velocity and pressure; the regularised traction is in
`wheelrail.forms.traction`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from ufl.core.expr import Expr


class FrictionLaw(Protocol):
    """A frozen dataclass of numbers with the friction coefficient in UFL."""

    def coefficient(self, w: Expr, p: Expr, /) -> Expr:
        """Friction coefficient from the slip velocity w m/s and the pressure p Pa, finite and not negative."""

    def __hash__(self) -> int: ...


def _check(law: Any, **units: str) -> None:
    """Raises ValueError unless the named fields, given with their units, are finite and not negative."""
    for name, unit in units.items():
        value = getattr(law, name)
        if not 0 <= value < math.inf:
            raise ValueError(f"{name} = {value}{unit}: must be finite and not negative")


@dataclass(frozen=True)
class Coulomb:
    """Constant friction.

    Parameters:
        mu: coefficient of friction, finite and not negative; 0 omits the tangential problem.

    Raises ValueError.
    """

    mu: float = 0.3

    def __post_init__(self) -> None:
        if not 0 <= self.mu < math.inf:
            raise ValueError(f"friction = {self.mu}: must be finite and not negative")

    def coefficient(self, w: Expr, p: Expr, /) -> Expr:
        import ufl

        return ufl.as_ufl(self.mu)


@dataclass(frozen=True)
class FallingFriction:
    """Friction that decreases exponentially with the slip velocity: mu(w) = mu0 ((1 - A) exp(-B w) + A).

    Parameters:
        mu: mu0, coefficient without slip, finite and not negative.
        share: A, fraction of mu0 that remains at high slip velocity, 0 to 1 (1: Coulomb).
        rate: B, s/m, finite and not negative.

    Polach 2005, doi:10.1016/j.wear.2004.03.046. Raises ValueError.
    """

    mu: float
    share: float
    rate: float

    def __post_init__(self) -> None:
        if not 0 <= self.mu < math.inf:
            raise ValueError(f"friction = {self.mu}: must be finite and not negative")
        if not 0 <= self.share <= 1:
            raise ValueError(f"share = {self.share}: the fraction of friction at high slip must be from 0 to 1")
        _check(self, rate=" s/m")

    @classmethod
    def polach(cls, *, wet: bool = False) -> FallingFriction:
        """Polach's constants for dry or wet rails: mu0 0.55 or 0.30, A 0.40, B 0.60 or 0.20 s/m (table 1, ibid.)."""
        return cls(0.30, 0.40, 0.20) if wet else cls(0.55, 0.40, 0.60)

    def coefficient(self, w: Expr, p: Expr, /) -> Expr:
        import ufl

        return self.mu * ((1 - self.share) * ufl.exp(-self.rate * w) + self.share)


@dataclass(frozen=True)
class Stribeck:
    """Friction that decreases from a static to a kinetic value: mu(w) = mu_k + (mu_s - mu_k) exp(-(w / w_s)^2).

    Parameters:
        static, kinetic: mu_s and mu_k, finite and not negative.
        speed: w_s, m/s, positive and finite.

    Armstrong-Helouvry, Dupont, Canudas de Wit 1994, doi:10.1016/0005-1098(94)90209-7. Raises ValueError.
    """

    static: float
    kinetic: float
    speed: float

    def __post_init__(self) -> None:
        _check(self, static="", kinetic="")
        if not 0 < self.speed < math.inf:
            raise ValueError(f"speed = {self.speed} m/s: must be positive and finite")

    def coefficient(self, w: Expr, p: Expr, /) -> Expr:
        import ufl

        return self.kinetic + (self.static - self.kinetic) * ufl.exp(-((w / self.speed) ** 2))


def scaled(law: FrictionLaw, factor: float) -> FrictionLaw:
    """The law with its coefficient times a factor. Raises ValueError for a law of another class than those here."""
    for kind, names in ((Coulomb, ("mu",)), (FallingFriction, ("mu",)), (Stribeck, ("static", "kinetic"))):
        if type(law) is kind:
            return replace(law, **{name: factor * getattr(law, name) for name in names})
    raise ValueError(f"friction along the track: not with the law {type(law).__name__}")


def parameters(law: Any) -> dict[str, float]:
    """Fields of a law, which must be numbers. Raises TypeError for a law that is no dataclass or has other fields."""
    try:
        values = {item.name: getattr(law, item.name) for item in fields(law)}
    except TypeError:
        raise TypeError(f"a law must be a frozen dataclass, got {law!r}") from None
    if type(law).__hash__ is None:
        raise TypeError(f"{type(law).__name__} must be frozen: @dataclass(frozen=True)")
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise TypeError(f"{type(law).__name__}.{name} = {value!r}: fields of a law must be numbers")
    return {name: float(value) for name, value in values.items()}
