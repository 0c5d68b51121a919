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
from wheelrail.contact.laws.residual_call import ResidualCode, friction_bounds
from wheelrail.support.arrays import Array
from wheelrail.support.compiled import compiled


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


@compiled
def margins(law: ResidualCode, q: Array, s: Array, p: Array, rho: Array, speed: float) -> Array:
    """Margins (n,) Pa from the tractions to their bounds where cells stick, b rho + eps > |y|; zero under slip.

    Parameters, contiguous:
        law: of friction.
        q: (2, n) Pa, tractions.
        s: (2, n), slips over the speed.
        p: (n,) Pa, pressures, not negative.
        rho: (n,) 1/Pa.
        speed: m/s.
    """
    bound = friction_bounds(law, s, p, speed)
    margin = np.zeros(len(p))
    for i in range(len(p)):
        if np.hypot(rho[i] * q[0, i] - s[0, i], rho[i] * q[1, i] - s[1, i]) < rho[i] * bound[i] + law.regularisation:
            margin[i] = max(bound[i] - np.hypot(q[0, i], q[1, i]), 0.0)
    return margin
