"""Sphere pressed on a plane, then displaced tangentially (Cattaneo 1938, Mindlin 1949; Johnson, 1985, ch. 7.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class Cattaneo:
    """Tangential contact of similar bodies; the small transverse traction is neglected.

    Parameters:
        radius: m, of the patch.
        stick: m, radius of the stick zone.
        peak: pressure, Pa.
        friction: coefficient.
        G: shear modulus of both bodies, Pa.
        nu: Poisson's ratio of both bodies.

    Neglecting the transverse traction makes slip directions slightly inaccurate. Raises ValueError unless
    0 <= stick <= radius.
    """

    radius: float
    stick: float
    peak: float
    friction: float
    G: float
    nu: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.stick <= self.radius:
            raise ValueError(f"stick = {self.stick} m: must be from 0 to radius = {self.radius} m")

    @property
    def normal_force(self) -> float:
        """2/3 pi peak radius^2, N."""
        return 2.0 / 3.0 * np.pi * self.peak * self.radius**2

    @property
    def force(self) -> float:
        """Tangential force N: friction F_n (1 - (stick / radius)^3), eq. (7.38)."""
        return self.friction * self.normal_force * (1.0 - (self.stick / self.radius) ** 3)

    @property
    def shift(self) -> float:
        """Relative tangential displacement m: 3 friction F_n (2 - nu) / (8 G a) (1 - (stick / a)^2).

        From eqs. (7.38) and (7.42) with G / (2 - nu) of two similar bodies in series.
        """
        full = 3.0 * self.friction * self.normal_force * (2.0 - self.nu) / (8.0 * self.G * self.radius)
        return full * (1.0 - (self.stick / self.radius) ** 2)

    def traction(self, r: Array) -> Array:
        """Magnitude of the traction [Pa] at the distance r [m] from the centre, eq. (7.36)."""
        stick_part = self.stick / self.radius * _semicircle(r / max(self.stick, 1e-12 * self.radius))
        return self.friction * self.peak * (_semicircle(r / self.radius) - stick_part)


def cattaneo(
    radius: float, peak: float, *, friction: float, G: float, nu: float, force: float | None = None, shift: float = 0.0
) -> Cattaneo:
    """Cattaneo's contact under a tangential force or displacement.

    Parameters:
        radius: m, of the patch.
        peak: pressure, Pa.
        friction: coefficient.
        G: shear modulus, Pa.
        nu: Poisson's ratio.
        force: tangential force over friction times normal force, 0 to 1; None: the displacement is prescribed.
        shift: tangential displacement, m.

    Raises ValueError for a force beyond the friction limit.
    """
    if force is not None:
        if not 0.0 <= force <= 1.0:
            raise ValueError(f"force = {force}: a share of friction times normal force, must be from 0 to 1")
        return Cattaneo(radius, radius * (1.0 - force) ** (1.0 / 3.0), peak, friction, G, nu)
    sliding = Cattaneo(radius, 0.0, peak, friction, G, nu)
    return Cattaneo(radius, radius * np.sqrt(max(1.0 - shift / sliding.shift, 0.0)), peak, friction, G, nu)


def _semicircle(t: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(1.0 - t * t, 0.0)))
