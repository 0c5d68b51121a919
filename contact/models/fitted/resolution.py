"""Numbers of strips and cells of a patch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MOST = 4  # times the strips of a circular patch


@dataclass(frozen=True)
class Resolution:
    """Numbers of strips over a patch's width and of cells along a strip. Raises ValueError for fewer than 4."""

    strips: int = 12
    cells: int = 16

    def __post_init__(self) -> None:
        if min(self.strips, self.cells) < 4:
            raise ValueError(f"strips and cells must be at least 4, got {self.strips} and {self.cells}")

    def strips_over(self, width: float, length: float) -> int:
        """Strips of a patch of a width and length, m: more when it is wider than long, to resolve adjacent maxima."""
        wanted = 0.75 * self.strips * width / max(length, 1e-12)
        return int(np.ceil(min(max(self.strips, wanted), MOST * self.strips)))

    def coarsened(self) -> Resolution:
        """Half as many strips and cells, at least 4 of each."""
        return Resolution(max(self.strips // 2, 4), max(self.cells // 2, 4))
