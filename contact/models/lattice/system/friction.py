"""Law of friction in the cells of strips: residual and its slopes, from the compiled functions of the law in UFL.

F is the mean of q - b y / max(|y|, b rho + eps), y = rho q - s, b = mu(|s| V, p) p, over a pressure p that varies
linearly in the cell (`wheelrail.forms.traction.mean_projected`). Slips s are over the rolling speed V. Pressures of a
trial state may be negative: their bound is zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.laws.pointwise import FrictionFunctions
from wheelrail.contact.laws.residual_call import ResidualCode
from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class CellFriction:
    """Friction law of the cells of S strips with M cells each.

    Parameters:
        functions: of the law.
        regularisation: creepage eps.
    """

    functions: FrictionFunctions
    regularisation: float

    @classmethod
    def of(cls, laws: ContactLaws) -> CellFriction:
        return cls(laws.pointwise_friction, laws.regularisation)

    @cached_property
    def code(self) -> ResidualCode:
        """The residual F (2, n) Pa and its slopes for compiled code."""
        return ResidualCode.of(self.functions, self.regularisation)

    def margins(self, tractions: Array, slip: Array, pressure: Array, rho: Array, speed: float) -> Array:
        """Margins (S, M) Pa from the tractions to their bounds where cells stick, b rho + eps > |y|; zero under slip.

        Parameters:
            tractions: (S, 2, M) Pa.
            slip: (S, 2, M), over the speed.
            pressure: (S, M) Pa.
            rho: (M,) 1/Pa.
            speed: m/s.
        """
        q, s, p = tractions.transpose(1, 0, 2), slip.transpose(1, 0, 2), np.maximum(pressure, 0.0)
        bound = (self.functions.coefficient(np.hypot(*s).ravel() * speed, p.ravel()) * p.ravel()).reshape(p.shape)
        sticks = np.hypot(*(rho * q - s)) < rho * bound + self.regularisation
        return np.where(sticks, np.maximum(bound - np.hypot(*q), 0.0), 0.0)
