"""Law of friction in the cells of strips.

F is the mean of q - b y / max(|y|, b rho + eps), y = rho q - s, b = mu(|s| V, p) p, over a pressure p that varies
linearly in the cell (`wheelrail.forms.traction.mean_projected`). Slips s are over the rolling speed V. Pressures of a
trial state may be negative: their bound is zero.
"""

from __future__ import annotations

import numpy as np

from wheelrail.bindings._contact import ResidualCode
from wheelrail.contact.laws.parameters import ContactLaws


def residual_code(laws: ContactLaws) -> ResidualCode:
    """The residual F (2, n) Pa and its slopes for the core."""
    if not laws.frictional:
        return ResidualCode(None, np.zeros(0), 0.0)
    functions = laws.pointwise_friction
    return ResidualCode(functions.code, functions.parameters, laws.regularisation)
