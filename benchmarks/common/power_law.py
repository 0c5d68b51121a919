"""Power laws fitted to measured costs, and their crossovers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

FEWEST = 3  # sizes that a fit needs


@dataclass(frozen=True)
class Power:
    """cost = factor size^exponent, fitted over a number of sizes from low to high; worst: largest deviation of the
    logarithm.
    """

    exponent: float
    factor: float
    low: float
    high: float
    count: int
    worst: float

    def __str__(self) -> str:
        return f"{self.exponent:.2f} ({self.low:.3g} to {self.high:.3g}, {self.count} sizes)"


def power(sizes: Sequence[float], costs: Sequence[float]) -> Power | None:
    """Least squares of logarithms over the asymptotic part: the sizes above the geometric middle of all, at least
    three.

    None for fewer sizes. Raises ValueError for values that are not positive.
    """
    n, t = np.array(sizes, dtype=float), np.array(costs, dtype=float)
    if len(n) and not (np.isfinite(n * t).all() and n.min() > 0 and t.min() > 0):
        raise ValueError(f"sizes and costs must be positive, got {sizes} and {costs}")
    order = np.argsort(n)
    n, t = n[order], t[order]
    if len(n) < FEWEST or n[0] == n[-1]:
        return None
    first = min(int(np.searchsorted(n, np.sqrt(n[0] * n[-1]))), len(n) - FEWEST)
    x, y = np.log(n[first:]), np.log(t[first:])
    exponent, constant = np.polyfit(x, y, 1)
    worst = float(np.abs(y - exponent * x - constant).max())
    return Power(float(exponent), float(np.exp(constant)), float(n[first]), float(n[-1]), len(x), worst)


def crossover(sizes: Sequence[float], costs: Sequence[float], other_costs: Sequence[float]) -> str:
    """Size from which the second cost is lower, by linear interpolation of logarithms, in words."""
    x, ratio = np.log(np.array(sizes, dtype=float)), np.log(np.array(other_costs, dtype=float) / np.array(costs))
    if not len(x):
        return "not measured"
    more_expensive = np.flatnonzero(ratio > 0)
    if not len(more_expensive):
        return f"below {sizes[0]:.0f}"
    k = int(more_expensive[-1])
    if k == len(x) - 1:
        return f"above {sizes[-1]:.0f} ({np.exp(ratio[-1]):.2g} times as much there)"
    part = ratio[k] / (ratio[k] - ratio[k + 1])
    return f"{np.exp(x[k] + part * (x[k + 1] - x[k])):.0f}"
