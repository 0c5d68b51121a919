"""Carter's rolling cylinder in two dimensions, closed form (Carter 1926; Johnson, Contact Mechanics, 1985, ch. 8.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wheelrail.support.arrays import Array


@dataclass(frozen=True)
class Carter:
    """Steady rolling along +x of alike bodies, the leading edge at x = +half_width.

    half_width m of the contact, stick m half-width of the part that sticks (it touches the leading edge), peak
    pressure Pa, friction; sign of the force on the rolling body. Raises ValueError unless 0 <= stick <= half_width.
    """

    half_width: float
    stick: float
    peak: float
    friction: float
    sign: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.stick <= self.half_width:
            raise ValueError(f"the stick zone cannot be {self.stick} m of {self.half_width} m")

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
        """Traction [Pa] on the rolling body at x [m], eq. (8.30): a full slip less what the stick zone takes back."""
        back = self.stick / self.half_width * _semicircle((x - self.centre) / max(self.stick, 1e-12 * self.half_width))
        return self.sign * self.friction * (self.pressure(x) - self.peak * back)


def carter(half_width: float, peak: float, *, friction: float, creepage: float, radius: float) -> Carter:
    """The contact at a creepage: velocity of the rolling body relative to the ground over the rolling speed.

    radius [m] is the relative radius R of the cylinder. The stick zone is 1 - |creepage| R / (friction half_width) of
    the contact, nothing when all of it slips.
    """
    stick = half_width - abs(creepage) * radius / friction
    return Carter(half_width, max(stick, 0.0), peak, friction, -float(np.sign(creepage)))


def _semicircle(t: Array) -> Array:
    return np.asarray(np.sqrt(np.maximum(1.0 - t * t, 0.0)))
