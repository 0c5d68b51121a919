"""Force of a stop that comes into play after a gap."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bumpstop:
    """Odd, piecewise linear force over deflection, without a bound: the last slope goes on.

    deflection m and force N, both rising from zero, at least two points; height m above top of rail.
    Raises ValueError for a table that does not rise from (0, 0).
    """

    deflection: tuple[float, ...]
    force: tuple[float, ...]
    height: float

    def __post_init__(self) -> None:
        d, f = np.asarray(self.deflection), np.asarray(self.force)
        if d.shape != f.shape or d.ndim != 1 or len(d) < 2:
            raise ValueError("bumpstop: deflection and force are two lists of one length, two points or more")
        if d[0] != 0.0 or f[0] != 0.0 or (np.diff(d) <= 0.0).any() or (np.diff(f) < 0.0).any():
            raise ValueError("bumpstop: deflection rises strictly and force does not fall, both from zero")

    def __call__(self, deflection: float | Array) -> Array:
        """Force [N] with the sign of the deflection [m], of any shape."""
        d, f, size = self.deflection, self.force, np.abs(deflection)
        beyond = np.maximum(size - d[-1], 0.0) * (f[-1] - f[-2]) / (d[-1] - d[-2])
        return np.asarray(np.copysign(np.interp(size, d, f) + beyond, deflection))

    def scaled(self, factor: float) -> Bumpstop:
        return replace(self, force=tuple(factor * f for f in self.force))
