"""Hertz's contact of two elastic bodies with elliptic patch, closed form (Johnson, Contact Mechanics, 1985, ch. 4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class Hertz:
    """Hertzian contact.

    Parameters:
        semi_axes: m, along x and along y.
        peak: pressure, Pa.
        approach: m.
        force: N.
    """

    semi_axes: tuple[float, float]
    peak: float
    approach: float
    force: float

    def pressure(self, x: Array, y: Array) -> Array:
        """Pressure [Pa] at x, y [m]."""
        r = (x / self.semi_axes[0]) ** 2 + (y / self.semi_axes[1]) ** 2
        return np.asarray(self.peak * np.sqrt(np.maximum(1 - r, 0)))


def modulus(steel: tuple[float, float], other: tuple[float, float]) -> float:
    """Contact modulus E* [Pa] of two materials (E [Pa], nu): 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2."""
    return 1 / sum((1 - nu * nu) / E for E, nu in (steel, other))


def hertz(A: float, B: float, E_star: float, *, force: float | None = None, approach: float | None = None) -> Hertz:
    """Hertzian contact of the gap A x^2 + B y^2 under a force or an approach.

    Parameters:
        A, B: 1/m, positive.
        E_star: contact modulus, Pa.
        force: N.
        approach: m; exactly one of force and approach is given.

    Raises ValueError.
    """
    if not (A > 0 and B > 0):
        raise ValueError(f"A = {A} 1/m, B = {B} 1/m: both must be positive")
    if (force is None) == (approach is None):
        raise ValueError("exactly one of force and approach must be given")
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


def axis_stress(z: Array, *, radius: float, peak: float, nu: float) -> tuple[Array, Array]:
    """Radial (equal to circumferential) and axial stress [Pa] below the centre of a circular patch, tension positive.

    Parameters:
        z: depth, m.
        radius: of the patch, m.
        peak: pressure, Pa.
        nu: Poisson's ratio.
    """
    t = np.asarray(z, dtype=float) / radius
    arc = np.arctan2(1.0, t)  # arctan(radius / z), accurate at the surface as well
    axial = -peak / (1.0 + t * t)
    radial = -peak * (1.0 + nu) * (1.0 - t * arc) + 0.5 * peak / (1.0 + t * t)
    return np.asarray(radial), np.asarray(axial)


def von_mises(z: Array, *, radius: float, peak: float, nu: float) -> Array:
    """Von Mises stress [Pa] on the axis: |radial - axial|, as two principal stresses are equal.

    Parameters as for `axis_stress`.
    """
    radial, axial = axis_stress(z, radius=radius, peak=peak, nu=nu)
    return np.asarray(np.abs(radial - axial))


def worst(*, radius: float, peak: float, nu: float) -> tuple[float, float]:
    """Depth [m] and value [Pa] of the largest von Mises stress on the axis: 0.48 radius and 0.62 peak for nu = 0.3.

    Parameters as for `axis_stress`.
    """
    low, high = 0.0, 2.0 * radius
    for _ in range(4):  # each pass narrows the bracket 500 times
        z = np.linspace(low, high, 1001, dtype=np.float64)
        best = int(np.argmax(von_mises(z, radius=radius, peak=peak, nu=nu)))
        low, high = z[max(best - 1, 0)], z[min(best + 1, 1000)]
    depth = 0.5 * (low + high)
    return float(depth), float(von_mises(np.array(depth), radius=radius, peak=peak, nu=nu))
