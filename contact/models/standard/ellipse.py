"""Hertz's ellipse in compiled code, and the elliptic integrals for it and for strips of pressure."""

from __future__ import annotations

import numpy as np

from wheelrail.support.compiled import borrowing


@borrowing
def complete(k: float) -> tuple[float, float]:
    """Complete elliptic integrals K and D = (K - E) / (1 - k^2) of the complementary modulus k, 0 < k <= 1, by the
    arithmetic-geometric mean, without cancellation at k = 1.
    """
    a, g, m = 1.0, k, (1.0 - k) * (1.0 + k)
    total, weight = 0.5, 1.0
    for _ in range(40):
        c = 0.5 * (a - g)
        if c <= 1e-17 * a:
            break
        total += weight * c * c / m
        a, g, weight = 0.5 * (a + g), np.sqrt(a * g), 2.0 * weight
    K = 0.5 * np.pi / a
    return K, K * total


@borrowing
def axis_ratio(curvatures: float) -> float:
    """Semi-axes short / long of the patch from the coefficients A / B <= 1 of the gap A x^2 + B y^2 (Johnson 1985,
    eq. 4.26): secant steps on a nearly straight line between logarithms.
    """
    if curvatures >= 1.0:
        return 1.0
    target = np.log(max(curvatures, 1e-12))
    u0 = 0.0
    f0 = -target
    u1 = 0.66 * target
    for _ in range(30):
        k = np.exp(u1)
        K, D = complete(k)
        f1 = 2.0 * u1 + np.log(D / (K - D)) - target
        if abs(f1) < 1e-14 or u1 == u0 or f1 == f0:
            break
        u0, f0, u1 = u1, f1, min(u1 - f1 * (u1 - u0) / (f1 - f0), -1e-16)
    return float(np.exp(u1))


@borrowing
def ellipse(A: float, B: float, approach: float, E_star: float) -> tuple[float, float, float]:
    """Semi-axes a, b m along x and y and peak pressure Pa.

    Parameters:
        A, B: coefficients of the gap A x^2 + B y^2, 1/m.
        approach: m.
        E_star: Pa.
    """
    k = axis_ratio(min(A, B) / max(A, B))
    K, D = complete(k)
    E = K - (1.0 - k * k) * D
    long = np.sqrt(approach * E / (k * k * (A + B) * K))
    peak = (A + B) * long * k * E_star / E
    return (long, k * long, peak) if A <= B else (k * long, long, peak)


@borrowing
def strip_potential(half: float, away: float) -> float:
    """Potential of a strip's pressure at a lateral distance away m: the integral m over x of
    sqrt(half^2 - x^2) / sqrt(x^2 + away^2).
    """
    if half <= 0.0:
        return 0.0
    reach = np.sqrt(half * half + away * away)
    _, D = complete(max(away / reach, 1e-12))
    return float(2.0 * (half / reach) * half * D)
