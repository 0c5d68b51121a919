"""Shakedown map: load factor and utilisation of a patch, and the limit of line contact under sliding friction.

The map shows the load factor p0 / k over the utilisation T / N, k the yield stress in shear. Residual stresses can
cancel all stress components but the shear along the surface (Melan); steel therefore shakes down while that is below k
everywhere (K. L. Johnson, Contact Mechanics, 1985, section 9.2). Beyond the branch p0 / k = N / T the surface itself
ratchets.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from wheelrail.support.arrays import Array

AT_SURFACE = 0.5  # utilisation above which the largest shear is at the surface


def load_factor(max_pressure: Array, shear_yield: float) -> Array:
    """Peak pressure over the yield stress in shear.

    Parameters:
        max_pressure: (...) Pa.
        shear_yield: Pa.
    """
    return np.asarray(max_pressure / shear_yield)


def utilisation(normal_force: Array, tangential_force: Array) -> Array:
    """T / N of normal forces (...) N and tangential ones (..., 2) N; zero without load."""
    size = np.hypot(tangential_force[..., 0], tangential_force[..., 1])
    return np.asarray(np.divide(size, normal_force, out=np.zeros_like(size), where=normal_force > 0))


def surface_fatigue_index(utilisation: Array, load_factor: Array) -> Array:
    """FI = T / N - k / p0, positive where the surface ratchets.

    Parameters:
        utilisation: T / N.
        load_factor: p0 / k.

    A. Ekberg, E. Kabo, H. Andersson, Fatigue and Fracture of Engineering Materials and Structures 25 (2002) 899-909,
    DOI 10.1046/j.1460-2695.2002.00535.x.
    """
    return np.asarray(utilisation - 1.0 / load_factor)


@lru_cache(maxsize=256)
def shakedown_limit(friction: float) -> float:
    """Load factor up to which line contact sliding with a friction coefficient shakes down.

    4 without friction, 1 / friction above 0.367. Raises ValueError for negative friction.
    """
    if not friction >= 0.0:
        raise ValueError(f"friction = {friction}: must be zero or positive")
    if friction > AT_SURFACE:
        return 1.0 / friction
    from scipy.optimize import minimize

    x, z = np.meshgrid(np.linspace(-2.0, 2.0, 81), np.linspace(0.0, 1.5, 61))
    coarse = np.abs(surface_shear(x, z, friction))
    i = int(np.argmax(coarse))
    best = minimize(
        lambda at: -float(np.abs(surface_shear(at[0], abs(at[1]), friction))),
        [x.flat[i], max(float(z.flat[i]), 0.02)],
        method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-13},
    )
    return float(1.0 / max(friction, coarse.flat[i], -best.fun))


def surface_shear(x: Array | float, z: Array | float, friction: float) -> Array:
    """Shear stress along the surface over p0 below a Hertz pressure and proportional traction.

    Parameters:
        x, z: position and depth in half-widths.
        friction: traction over pressure, towards +x on the body.

    E. McEwen's closed form (Johnson 1985, eq. 4.49).
    """
    x, z = np.asarray(x, dtype=float), np.asarray(z, dtype=float)
    m, n = _mcewen(x, z)
    squares = m * m + n * n

    def over_squares(value: Array) -> Array:
        return np.divide(value, squares, out=np.zeros_like(squares), where=squares > 0)

    by_pressure = -n * over_squares(m * m - z * z)
    # shear by a traction equals the longitudinal stress by the same pressure
    by_traction = 2.0 * z - m * (1.0 + over_squares(z * z + n * n))
    return np.asarray(by_pressure + friction * by_traction)


def _mcewen(x: Array, z: Array) -> tuple[Array, Array]:
    """E. McEwen's m, n in half-widths, m >= 0 and n with the sign of x (Johnson 1985, eq. 4.49)."""
    part = 1.0 - x * x + z * z
    root = np.sqrt(part * part + 4.0 * x * x * z * z)
    m = np.sqrt(np.maximum(0.5 * (root + part), 0.0))
    return m, np.copysign(np.sqrt(np.maximum(0.5 * (root - part), 0.0)), x)
