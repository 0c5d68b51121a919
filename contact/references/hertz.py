"""Hertz's contact of two elastic bodies with elliptic patch, closed form (Johnson, Contact Mechanics, 1985, ch. 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Hertz:
    """semi_axes m (along x, along y), peak pressure Pa, approach m, force N."""

    semi_axes: tuple[float, float]
    peak: float
    approach: float
    force: float

    def pressure(self, x: Array, y: Array) -> Array:
        """Pressure [Pa] at x, y [m]."""
        r = (x / self.semi_axes[0]) ** 2 + (y / self.semi_axes[1]) ** 2
        return np.asarray(self.peak * np.sqrt(np.maximum(1 - r, 0)))


def modulus(steel: tuple[float, float], other: tuple[float, float]) -> float:
    """E* [Pa] of two materials (E [Pa], nu): 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2."""
    return 1 / sum((1 - nu * nu) / E for E, nu in (steel, other))


def hertz(A: float, B: float, E_star: float, *, force: float | None = None, approach: float | None = None) -> Hertz:
    """Contact of the gap A x^2 + B y^2 [1/m] under a force [N] or an approach [m]; exactly one is given.

    Raises ValueError unless A and B are positive and one load is given.
    """
    if not (A > 0 and B > 0):
        raise ValueError(f"the gap must open in both directions, got curvatures {A} and {B} 1/m")
    if (force is None) == (approach is None):
        raise ValueError("give either the force or the approach")
    low, high = min(A, B), max(A, B)  # the long semi-axis lies where the gap opens slowly

    def ratio(k: float) -> float:  # A / B as a function of k = short / long semi-axis
        m = 1 - k * k
        return float(k * k * (ellipk(m) - ellipe(m)) / (ellipe(m) - k * k * ellipk(m))) if m > 1e-12 else 1.0

    k = (
        1.0
        if high / low - 1 < 1e-9
        else brentq(lambda k: ratio(k) - low / high, 1e-6, 1 - 1e-6, xtol=1e-15, rtol=1e-14)
    )
    m = 1 - k * k
    K, E = ellipk(m), ellipe(m)
    # With long semi-axis a: A + B = p0 / (a k E*) E(m), approach = p0 a k K(m) / E*, F = 2/3 pi p0 a^2 k
    if force is not None:
        a = (3 * force * E / (2 * np.pi * k * k * (A + B) * E_star)) ** (1 / 3)
    else:
        assert approach is not None
        a = np.sqrt(approach * E / (k * k * (A + B) * K))
    peak = (A + B) * a * k * E_star / E
    # exact split of (A + B): low belongs to the long axis
    axes = (a, a * k) if A <= B else (a * k, a)
    return Hertz(
        (float(axes[0]), float(axes[1])),
        float(peak),
        float(peak * a * k * K / E_star),
        float(2 / 3 * np.pi * peak * a * a * k),
    )
