"""A sphere pressed on a plane, then pushed sideways (Cattaneo 1938, Mindlin 1949; Johnson, 1985, ch. 7.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class Cattaneo:
    """Alike bodies; the small traction across the push is neglected, which leaves slip directions slightly wrong.

    radius m of the patch, stick m radius of the part that sticks, peak pressure Pa, friction, shear modulus G Pa and
    Poisson's ratio nu of both bodies. Raises ValueError unless 0 <= stick <= radius.
    """

    radius: float
    stick: float
    peak: float
    friction: float
    G: float
    nu: float

    def __post_init__(self) -> None:
        if not 0.0 <= self.stick <= self.radius:
            raise ValueError(f"the stick zone cannot be {self.stick} m of {self.radius} m")

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
        """Rigid displacement m of one body over the other: 3 friction F_n (2 - nu) / (8 G a) (1 - (stick / a)^2),
        from eqs. (7.38) and (7.42) with G / (2 - nu) of two alike bodies in series."""
        full = 3.0 * self.friction * self.normal_force * (2.0 - self.nu) / (8.0 * self.G * self.radius)
        return full * (1.0 - (self.stick / self.radius) ** 2)

    def traction(self, r: Array) -> Array:
        """Magnitude of the traction [Pa] at the distance r [m] from the centre, eq. (7.36)."""
        back = self.stick / self.radius * _semicircle(r / max(self.stick, 1e-12 * self.radius))
        return self.friction * self.peak * (_semicircle(r / self.radius) - back)


def cattaneo(
    radius: float, peak: float, *, friction: float, G: float, nu: float, force: float | None = None, shift: float = 0.0
) -> Cattaneo:
    """The contact under a tangential force as a share of friction times normal force, or after a shift [m].

    Raises ValueError for a force that slides.
    """
    if force is not None:
        if not 0.0 <= force <= 1.0:
            raise ValueError(f"the force must be a share of what friction can hold, got {force}")
        return Cattaneo(radius, radius * (1.0 - force) ** (1.0 / 3.0), peak, friction, G, nu)
    sliding = Cattaneo(radius, 0.0, peak, friction, G, nu)
    return Cattaneo(radius, radius * np.sqrt(max(1.0 - shift / sliding.shift, 0.0)), peak, friction, G, nu)


def _semicircle(t: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(1.0 - t * t, 0.0)))
