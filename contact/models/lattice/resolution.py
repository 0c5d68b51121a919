"""Numbers of strips and cells of a lattice."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LatticeResolution:
    """Strips over the width of a usual patch, and cells along a strip. Raises ValueError for fewer than 4."""

    strips: int = 16
    cells: int = 10

    def __post_init__(self) -> None:
        if min(self.strips, self.cells) < 4:
            raise ValueError(f"strips and cells must be at least 4, got {self.strips} and {self.cells}")

    def coarsened(self) -> LatticeResolution:
        """Half as many strips and cells, at least 4 of each."""
        return LatticeResolution(max(self.strips // 2, 4), max(self.cells // 2, 4))
