"""Carter's rolling cylinder in two dimensions, closed form (Carter 1926; Johnson, Contact Mechanics, 1985, ch. 8.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class Carter:
    """Steady rolling along +x of similar bodies, the leading edge at x = +half_width.

    Parameters:
        half_width: m, of the contact.
        stick: m, half-width of the stick zone, which includes the leading edge.
        peak: pressure, Pa.
        friction: coefficient.
        sign: of the force on the rolling body.

    Raises ValueError unless 0 <= stick <= half_width.
    """

    half_width: float
    stick: float
    peak: float
    friction: float
    sign: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.stick <= self.half_width:
            raise ValueError(f"stick = {self.stick} m: must be from 0 to half_width = {self.half_width} m")

    @property
    def centre(self) -> float:
        """Middle of the stick zone, m."""
        return self.half_width - self.stick

    @property
    def force(self) -> float:
        """Creep force over friction times normal force: 1 - (stick / half_width)^2."""
        return self.sign * (1.0 - (self.stick / self.half_width) ** 2)

    def pressure(self, x: Array) -> Array:
        """Pressure [Pa] at x [m]."""
        return self.peak * _semicircle(x / self.half_width)

    def traction(self, x: Array) -> Array:
        """Traction [Pa] on the rolling body at x [m], eq. (8.30): full slip minus the stick zone's part."""
        stick_part = (
            self.stick / self.half_width * _semicircle((x - self.centre) / max(self.stick, 1e-12 * self.half_width))
        )
        return self.sign * self.friction * (self.pressure(x) - self.peak * stick_part)


def carter(half_width: float, peak: float, *, friction: float, creepage: float, radius: float) -> Carter:
    """Carter's contact at a creepage.

    Parameters:
        half_width: m, of the contact.
        peak: pressure, Pa.
        friction: coefficient.
        creepage: velocity of the rolling body relative to the ground over the rolling speed.
        radius: relative radius R of the cylinder, m.

    The stick zone is 1 - |creepage| R / (friction half_width) of the contact, zero in full slip.
    """
    stick = half_width - abs(creepage) * radius / friction
    return Carter(half_width, max(stick, 0.0), peak, friction, -float(np.sign(creepage)))


def _semicircle(t: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(1.0 - t * t, 0.0)))
