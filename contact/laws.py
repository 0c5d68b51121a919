"""Materials and contact laws as data."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Steel:
    """Isotropic elastic material: Young's modulus [Pa] and Poisson's ratio. Raises ValueError for impossible values."""

    E: float = 2.1e11
    nu: float = 0.3

    def __post_init__(self) -> None:
        if not self.E > 0:
            raise ValueError(f"Young's modulus must be positive, got {self.E} Pa")
        if not -1 < self.nu < 0.5:
            raise ValueError(f"Poisson's ratio must lie between -1 and 0.5, got {self.nu}")


@dataclass(frozen=True)
class Laws:
    """Contact laws of the paper, eqs. (4) and (6).

    stiffness_per_area K [N/m3] of the penalty pressure (inf: no penetration at all); friction mu (0 skips all
    tangential work); regularisation eps, the creepage below which friction is viscous (0: Coulomb's law itself).
    Raises ValueError for impossible values.
    """

    stiffness_per_area: float = 1e15
    friction: float = 0.3
    regularisation: float = 1e-5

    def __post_init__(self) -> None:
        if not self.stiffness_per_area > 0:
            raise ValueError(f"the penalty stiffness must be positive, got {self.stiffness_per_area} N/m3")
        if not (self.friction >= 0 and math.isfinite(self.friction)):
            raise ValueError(f"the friction coefficient must be finite and not negative, got {self.friction}")
        if not (self.regularisation >= 0 and math.isfinite(self.regularisation)):
            raise ValueError(f"the regularising creepage must be finite and not negative, got {self.regularisation}")

    @property
    def normal_compliance(self) -> float:
        """1/K [m3/N], zero for the exact law: the penalty is a compliance on the diagonal."""
        return 1.0 / self.stiffness_per_area
