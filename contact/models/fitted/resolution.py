"""How finely a patch is divided into strips and cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MOST = 4  # times as many strips as a round patch has


@dataclass(frozen=True)
class Resolution:
    """Strips over a patch's width, and cells along a strip. Raises ValueError for fewer than 4 of either."""

    strips: int = 12
    cells: int = 16

    def __post_init__(self) -> None:
        if min(self.strips, self.cells) < 4:
            raise ValueError(f"a patch needs at least 4 strips of 4 cells, got {self.strips} of {self.cells}")

    def strips_over(self, width: float, length: float) -> int:
        """Strips of a patch: more when it is wider than long, so that humps side by side are seen, up to a limit."""
        wanted = 0.75 * self.strips * width / max(length, 1e-12)
        return int(np.ceil(min(max(self.strips, wanted), MOST * self.strips)))

    def halved(self) -> Resolution:
        """Half as fine."""
        return Resolution(max(self.strips // 2, 4), max(self.cells // 2, 4))
