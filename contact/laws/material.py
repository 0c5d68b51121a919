"""Isotropic linear elastic material."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Material:
    """Isotropic elastic material: Young's modulus [Pa] and Poisson's ratio. Raises ValueError for impossible values."""

    E: float = 2.1e11
    nu: float = 0.3

    def __post_init__(self) -> None:
        if not self.E > 0:
            raise ValueError(f"Young's modulus must be positive, got {self.E} Pa")
        if not -1 < self.nu < 0.5:
            raise ValueError(f"Poisson's ratio must lie between -1 and 0.5, got {self.nu}")
