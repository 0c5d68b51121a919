"""Hertz's force of a contact of two half-spaces by its depth, for real and complex numbers: differentiable."""

from __future__ import annotations

import numpy as np

from wheelrail.support.arrays import Array

MEANS = 6  # steps of the arithmetic and geometric mean
ROUNDEST = 0.999  # largest ratio of curvatures that is told from 1
STEPS, CLOSE = 20, 1e-8  # of Newton's method; the last one is quadratic in one of that size
SPRING_STEPS = 12


def point_contact(
    depth: Array, low: Array, high: Array, *, modulus: float, stiffness: float
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Normal force N, and semi-axes m and peak pressure Pa, of a contact in series with a linear spring.

    Parameters:
        depth: (...) m, penetration of the undeformed bodies.
        low, high: (...) principal relative curvatures, 1/m, low <= high.
        modulus: E*, Pa.
        stiffness: of the spring, N/m; inf: none.

    Semi-axes a and k a, with complete elliptic integrals K, E of the parameter 1 - k^2 (Johnson, Contact Mechanics,
    1985, section 4.2): low / high = k^2 (K - E) / (E - k^2 K), and depth = a^2 k^2 (low + high) K / (2 E).
    """
    ratio = np.where((low / high).real < ROUNDEST, low / high, ROUNDEST)
    u = 0.64 * np.log(ratio)  # logarithm of k
    for _ in range(STEPS):
        k = np.exp(u)
        K, E = elliptic_integrals(k)
        m = 1.0 - k * k
        dK, dE = -(E - k * k * K) / (m * k), -k * (E - K) / m  # by k
        value = np.log(k * k * (K - E) / (E - k * k * K)) - np.log(ratio)
        slope = 2.0 + k * ((dK - dE) / (K - E) - (dE - 2.0 * k * K - k * k * dK) / (E - k * k * K))
        u = u - value / slope
        if np.abs(value).max() < CLOSE:
            break
    k = np.exp(u)
    K, E = elliptic_integrals(k)
    total = 0.5 * (low + high)
    factor = (2.0 * np.pi / 3.0) * modulus * np.sqrt(E / (K**3 * total)) / k
    root, spring = np.sqrt(depth), factor / stiffness
    for _ in range(SPRING_STEPS if np.isfinite(stiffness) else 0):  # root^2 of the contact, the rest of the spring
        root = root - (spring * root**3 + root * root - depth) / (3.0 * spring * root * root + 2.0 * root)
    a, force = root * np.sqrt(E / (k * k * total * K)), factor * root**3
    return force, (a, k * a, 1.5 * force / (np.pi * k * a * a))


def elliptic_integrals(k: Array) -> tuple[Array, Array]:
    """Complete elliptic integrals K, E of the parameter 1 - k^2, by arithmetic and geometric means."""
    a, b, power = np.ones_like(k), k, 0.5
    total = power * (1.0 - k * k)
    for _ in range(MEANS):
        a, b, c = 0.5 * (a + b), np.sqrt(a * b), 0.5 * (a - b)
        power *= 2.0
        total = total + power * c * c
    K = 0.5 * np.pi / a
    return K, K * (1.0 - total)
