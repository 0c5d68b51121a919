"""Ranges of the variables of a table."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

LARGEST_CREEPAGE = 20.0  # over that which saturates; beyond it only the direction of slip matters


@dataclass(frozen=True)
class TableRange:
    """Ranges, smallest and largest, of the variables of a table.

    Parameters:
        y: lateral position of the tread of a left-hand wheel from its nominal one, m.
        roll, yaw: rad.
        load: vertical load without friction, N; below the smallest it is proportional to depth^(3/2).

    Raises ValueError for a range that is empty or not finite, and loads that are not positive.
    """

    y: tuple[float, float] = (-7e-3, 7e-3)
    roll: tuple[float, float] = (-5e-3, 5e-3)
    yaw: tuple[float, float] = (-5e-3, 5e-3)
    load: tuple[float, float] = (10e3, 200e3)

    def __post_init__(self) -> None:
        for name, (low, high) in asdict(self).items():
            if not (np.isfinite([low, high]).all() and low < high):
                raise ValueError(f"{name} = {low:g}, {high:g}: must be two increasing numbers")
        if not self.load[0] > 0.0:
            raise ValueError(f"load = {self.load[0]:g}, {self.load[1]:g}: must be greater than 0 N")

    @property
    def levels(self) -> tuple[float, float]:
        """Smallest and largest (load / N)^(2/3)."""
        return self.load[0] ** (2.0 / 3.0), self.load[1] ** (2.0 / 3.0)

    @property
    def creepages(self) -> tuple[float, float]:
        """Smallest and largest asinh(creepage / scale)."""
        largest = float(np.arcsinh(LARGEST_CREEPAGE))
        return -largest, largest
