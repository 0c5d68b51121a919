"""Values of a torque or force over time or distance, piecewise linear."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class LoadTable:
    """A torque or force, linear between points, constant before the first and after the last one.

    Parameters:
        points: (n, 2), n >= 1: time s, or distance m, strictly increasing, and torque N m or force N.
        by_distance: the first numbers are distances that the vehicle has run, not times.

    Raises ValueError for other points.
    """

    points: tuple[tuple[float, float], ...]
    by_distance: bool = False

    def __post_init__(self) -> None:
        table = np.array(self.points, dtype=float) if all(len(p) == 2 for p in self.points) else np.empty(0)
        if table.shape[:1] < (1,) or not np.isfinite(table).all():
            raise ValueError("must be a finite number, or points, each a pair of finite numbers")
        if (np.diff(table[:, 0]) <= 0.0).any():
            raise ValueError("must have points with strictly increasing times or distances")

    @classmethod
    def of(cls, value: float | LoadTable) -> LoadTable:
        """The table, or that of a constant value."""
        return value if isinstance(value, LoadTable) else cls(((0.0, float(value)),))

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times s at which the slope changes; none of a constant, or over distance."""
        return () if self.by_distance or len(self.points) == 1 else tuple(at for at, _ in self.points)

    @property
    def least(self) -> float:
        """Smallest value."""
        return min(value for _, value in self.points)

    def at(self, time: float, distance: float) -> float:
        """Value at a time s and a distance m that the vehicle has run."""
        abscissae, values = zip(*self.points, strict=True)
        return float(np.interp(distance if self.by_distance else time, abscissae, values))
