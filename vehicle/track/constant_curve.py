"""Curve of constant radius and cant at constant speed: cant deficiency."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import asin, copysign, cos, isfinite, sin

from wheelrail.vehicle.track.piecewise import PiecewiseFunction
from wheelrail.vehicle.track.track import Track


@dataclass(frozen=True)
class ConstantCurve:
    """An infinitely long level curve.

    Parameters:
        speed: m/s.
        curvature: 1/m, positive to the left.
        cant: m, positive raises the outer rail (the right one without curvature).
        base: m, lateral distance over which the cant is measured.
        widening: of the gauge, m.
        friction: factor on the coefficient of friction.

    Raises ValueError for values out of bounds.
    """

    speed: float
    curvature: float
    cant: float = 0.0
    base: float = 1.5
    widening: float = 0.0
    friction: float = 1.0

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not isfinite(value) or (item.name in ("speed", "base") and value <= 0.0):
                allowed = "positive and finite" if item.name in ("speed", "base") else "finite"
                raise ValueError(f"ConstantCurve.{item.name} = {value}: must be {allowed}")
        if not abs(self.cant) < self.base:
            raise ValueError(f"ConstantCurve.cant = {self.cant}: must be less than base = {self.base} m")

    @property
    def track(self) -> Track:
        values = self.curvature, self.cant * copysign(1.0, self.curvature), self.widening, self.friction
        curvature, superelevation, widening, friction = map(PiecewiseFunction.constant, values)
        return Track(curvature, superelevation, base=self.base, widening=widening, friction=friction)

    @property
    def angle(self) -> float:
        """Inclination of the plane of the rails, rad, positive towards the centre of the curve."""
        return asin(self.cant / self.base)

    def unbalanced(self, gravity: float = 9.81) -> float:
        """Unbalanced lateral acceleration in the plane of the rails, m/s2, positive to the outside."""
        return self.speed**2 * abs(self.curvature) * cos(self.angle) - gravity * sin(self.angle)

    def deficiency(self, gravity: float = 9.81) -> float:
        """Cant deficiency, m: base V^2 / (g R) minus the cant."""
        return self.base * self.speed**2 * abs(self.curvature) / gravity - self.cant
