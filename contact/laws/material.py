"""Isotropic linear elastic material."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Material:
    """Isotropic linear elastic material.

    Parameters:
        E: Young's modulus, Pa, positive.
        nu: Poisson's ratio, between -1 and 0.5.

    Raises ValueError.
    """

    E: float = 2.1e11
    nu: float = 0.3

    def __post_init__(self) -> None:
        if not self.E > 0:
            raise ValueError(f"E = {self.E} Pa: Young's modulus must be positive")
        if not -1 < self.nu < 0.5:
            raise ValueError(f"nu = {self.nu}: Poisson's ratio must lie between -1 and 0.5")
