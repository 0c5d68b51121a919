"""Numbers of strips and cells of a lattice."""

from __future__ import annotations

from dataclasses import dataclass

LEAST_STRIPS, LEAST_CELLS = 4, 6
APART = 2 / 7  # of a usual patch's width: distance of the strips at which the penetration is estimated first
MOST_APART = 4  # strips


@dataclass(frozen=True)
class LatticeResolution:
    """Strips over the width of a usual patch, and cells along a strip.

    Raises ValueError for fewer than 4 strips, or fewer than 6 cells: as many as there are moments of the gap.
    """

    strips: int = 12
    cells: int = 14

    def __post_init__(self) -> None:
        if self.strips < LEAST_STRIPS or self.cells < LEAST_CELLS:
            least = f"{LEAST_STRIPS} and {LEAST_CELLS}"
            raise ValueError(f"strips and cells must be at least {least}, got {self.strips} and {self.cells}")

    def coarsened(self) -> LatticeResolution:
        """Half as many strips and cells, or the least numbers."""
        return LatticeResolution(max(self.strips // 2, LEAST_STRIPS), max(self.cells // 2, LEAST_CELLS))


def strips_apart(strips: int) -> int:
    """Distance, in strips, between the first estimates of penetration; strips: over a usual patch."""
    return min(max(round(APART * strips), 1), MOST_APART)
