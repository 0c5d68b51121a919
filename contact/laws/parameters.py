"""Contact laws of an interface."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from wheelrail.contact.laws.friction import Coulomb, FrictionLaw, scaled
from wheelrail.contact.laws.normal import NormalLaw, Penalty
from wheelrail.contact.laws.pointwise import FrictionFunctions, PressureFunction, friction_functions, pressure_function
from wheelrail.support.arrays import Array


@dataclass(frozen=True, init=False)
class ContactLaws:
    """Contact laws: exact unilateral contact and Coulomb friction, or regularised as in eqs. (4) and (6).

    Parameters:
        normal: normal law, or K of the linear penalty, N/m3; inf is the exact law without penetration.
        friction: friction law, or the coefficient of Coulomb's; 0 omits the tangential problem.
        regularisation: creepage eps below which friction is viscous, finite and not negative; 0 is exact friction.

    Raises ValueError.
    """

    normal: NormalLaw
    friction: FrictionLaw
    regularisation: float

    def __init__(
        self, normal: NormalLaw | float = math.inf, friction: FrictionLaw | float = 0.3, regularisation: float = 0.0
    ) -> None:
        if not 0 <= regularisation < math.inf:
            raise ValueError(f"regularisation = {regularisation}: must be finite and not negative")
        object.__setattr__(
            self, "normal", Penalty(float(normal)) if isinstance(normal, int | float | np.number) else normal
        )
        object.__setattr__(
            self, "friction", Coulomb(float(friction)) if isinstance(friction, int | float | np.number) else friction
        )
        object.__setattr__(self, "regularisation", float(regularisation))

    @classmethod
    def penalty(cls, friction: FrictionLaw | float = 0.3) -> ContactLaws:
        """Penalty K = 1e15 N/m3, the paper's lower bound, and eps = 1e-5, this program's choice: the paper has none."""
        return cls(1e15, friction, 1e-5)

    def rubbing(self, factor: float) -> ContactLaws:
        """Laws with the coefficient of friction times a factor. Raises ValueError as `scaled`."""
        return ContactLaws(self.normal, scaled(self.friction, factor), self.regularisation)

    @property
    def frictional(self) -> bool:
        """Whether there is a tangential problem."""
        return self.friction != Coulomb(0.0)

    @property
    def depend_on_slip(self) -> bool:
        """Whether the friction bound, or regularised friction below the bound, depends on the slip."""
        return self.regularisation > 0 or self.pointwise_friction.depends_on_speed

    @property
    def exact_normal(self) -> bool:
        """Whether the normal law is exact unilateral contact, without penetration."""
        return self.normal == Penalty()

    @property
    def normal_compliance(self) -> float | None:
        """1/K [m3/N] of a linear penalty, zero for the exact law; None for other normal laws."""
        return self.normal.compliance if isinstance(self.normal, Penalty) else None

    @property
    def pointwise_friction(self) -> FrictionFunctions:
        """Compiled functions of the friction law."""
        return friction_functions(self.friction)

    @property
    def pointwise_pressure(self) -> PressureFunction:
        """Compiled functions of a normal law that is not exact."""
        return pressure_function(self.normal)

    def friction_bound(self, pressure: Array, slip: Array, speed: float) -> Array:
        """Bound mu(|s| V, p) p (n,) Pa of the tangential traction.

        Parameters:
            pressure: (n,) Pa.
            slip: |s| (n,), over the rolling speed.
            speed: V, m/s.

        Zero without friction.
        """
        if not self.frictional:
            return np.zeros(len(pressure))
        return self.pointwise_friction.coefficient(slip * speed, pressure) * pressure

    def penetration_at(self, pressure: float) -> float:
        """Penetration m at which the normal law has a pressure Pa."""
        if self.normal_compliance is not None:
            return self.normal_compliance * pressure
        from scipy.optimize import brentq

        function, deepest = self.pointwise_pressure, 1e-9
        while function(np.array([deepest]))[0][0] < pressure:
            deepest *= 2.0
            if deepest > 1.0:
                raise ValueError(f"{self.normal} does not reach {pressure:g} Pa within a penetration of 1 m")
        return float(brentq(lambda d: function(np.array([d]))[0][0] - pressure, 0.0, deepest))
