"""One curve at one speed, and what it asks of a vehicle whatever its springs."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import asin, copysign, cos, isfinite, sin, sqrt, tan

from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track


@dataclass(frozen=True)
class ConstantCurve:
    """A level curve without end at a speed m/s; curvature 1/m, positive to the left; cant m, positive raises the outer
    rail (the right one without curvature) over a base m. Raises ValueError for what cannot be.
    """

    speed: float
    curvature: float
    cant: float = 0.0
    base: float = 1.5

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not isfinite(value) or (item.name in ("speed", "base") and value <= 0.0):
                allowed = "positive and finite" if item.name in ("speed", "base") else "finite"
                raise ValueError(f"Curve.{item.name} = {value}: must be {allowed}")
        if not abs(self.cant) < self.base:
            raise ValueError(f"Curve.cant = {self.cant}: must be less than the base of {self.base} m")

    @property
    def track(self) -> Track:
        lift = self.cant * copysign(1.0, self.curvature)
        return Track(PiecewiseFunction.constant(self.curvature), PiecewiseFunction.constant(lift), base=self.base)

    @property
    def angle(self) -> float:
        """Inclination of the plane of the rails, rad, positive towards the centre of the curve."""
        return asin(self.cant / self.base)

    def unbalanced(self, gravity: float = 9.81) -> float:
        """Lateral acceleration that cant leaves, m/s2 in the plane of the rails, positive to the outside."""
        return self.speed**2 * abs(self.curvature) * cos(self.angle) - gravity * sin(self.angle)

    def deficiency(self, gravity: float = 9.81) -> float:
        """Cant that is missing for no lateral force, m, as usual: base V^2 / (g R) less the cant."""
        return self.base * self.speed**2 * abs(self.curvature) / gravity - self.cant

    def balance_speed(self, gravity: float = 9.81) -> float:
        """Speed without lateral force, m/s. Raises ValueError without curvature or cant."""
        if self.curvature == 0.0 or self.cant <= 0.0:
            raise ValueError("a speed of balance needs curvature and positive cant")
        return sqrt(gravity * tan(self.angle) / abs(self.curvature))
