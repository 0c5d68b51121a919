"""Law of friction in the cells of strips.

F is the mean of q - b y / max(|y|, b rho + eps), y = rho q - s, b = mu(|s| V, p) p, over a pressure p that varies
linearly in the cell (`wheelrail.forms.traction.mean_projected`). Slips s are over the rolling speed V. Pressures of a
trial state may be negative: their bound is zero.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from wheelrail.bindings._contact import ResidualCode
from wheelrail.contact.laws.parameters import ContactLaws
from wheelrail.contact.laws.pointwise import FrictionFunctions


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
        """The same for the core."""
        return ResidualCode(self.functions.code, self.functions.parameters, self.regularisation)
