"""Polach's creep forces of an elliptic patch in closed form.

O. Polach, Vehicle System Dynamics 33 Suppl. (1999) 728-739, with the reduction factors of
Wear 258 (2005) 992-1000, doi:10.1016/j.wear.2004.03.046.
"""

from __future__ import annotations

import numpy as np

from wheelrail.support.compiled import borrowing


@borrowing
def effective(eta: float, phi: float, a: float) -> float:
    """Effective lateral creepage from the lateral creepage eta and the spin phi 1/m on a patch of semi-axis a m."""
    return max(abs(eta), abs(eta + phi * a))


@borrowing
def polach(
    creepages: tuple[float, float, float],
    semi_axes: tuple[float, float],
    bound: float,
    G: float,
    kalker: tuple[float, float, float],
    reduction: tuple[float, float],
) -> tuple[float, float]:
    """Longitudinal and lateral force N on the faster body.

    Parameters:
        creepages: longitudinal xi, lateral eta, and spin phi 1/m.
        semi_axes: along and across, m.
        bound: friction coefficient times load, N.
        G: shear modulus, Pa.
        kalker: coefficients C11, C22, C23.
        reduction: factors k_A and k_S, 1 on dry and clean rails.
    """
    (xi, eta, phi), (a, b), (adhesion, slip) = creepages, semi_axes, reduction
    lateral = effective(eta, phi, a)
    total, plain = np.hypot(xi, lateral), np.hypot(xi, eta)
    if total == 0.0 or bound == 0.0:
        return 0.0, 0.0
    c = np.hypot(kalker[0] * xi, kalker[1] * eta) / plain if plain > 0.0 else 0.0
    gradient = 0.25 * np.pi * G * a * b * c * total / bound
    size = 2.0 / np.pi * bound * (adhesion * gradient / (1.0 + (adhesion * gradient) ** 2) + np.arctan(slip * gradient))
    slender = 1.0 + 6.3 * (1.0 - np.exp(-a / b))
    e = 8.0 / 3.0 * G * b * np.sqrt(a * b) * kalker[2] * lateral / (bound * slender)
    d = (e * e - 1.0) / (e * e + 1.0)
    k = e * (d**3 / 3.0 - d * d / 2.0 + 1.0 / 6.0) - (1.0 - d * d) ** 1.5 / 3.0
    by_spin = 9.0 / 16.0 * a * bound * k * slender
    return -size * xi / total, (by_spin * phi - size * eta) / total
