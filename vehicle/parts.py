"""What a wagon is made of: rigid bodies, stages of suspension, and their shares in the plane model."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import isfinite


def check(thing: object, *, positive: tuple[str, ...] = ()) -> None:
    """Every number is finite and not negative, the named ones not zero; raises ValueError."""
    for item in fields(thing):  # type: ignore[arg-type]
        value = getattr(thing, item.name)
        if not isinstance(value, (int, float)):
            continue
        if not isfinite(value) or value < 0.0 or (value == 0.0 and item.name in positive):
            allowed = "positive" if item.name in positive else "zero or positive"
            raise ValueError(f"{type(thing).__name__}.{item.name} = {value}: must be finite and {allowed}")


@dataclass(frozen=True)
class Body:
    """A rigid body: mass kg, principal moments of inertia kg m2, height of its centre above top of rail m."""

    mass: float
    roll_inertia: float
    pitch_inertia: float
    yaw_inertia: float
    height: float

    def __post_init__(self) -> None:
        check(self, positive=tuple(f.name for f in fields(self)))

    def scaled(self, factor: float) -> Body:
        return replace(
            self,
            mass=factor * self.mass,
            roll_inertia=factor * self.roll_inertia,
            pitch_inertia=factor * self.pitch_inertia,
            yaw_inertia=factor * self.yaw_inertia,
        )


@dataclass(frozen=True)
class Suspension:
    """One stage: a spring and a damper on each side, values of one side in N/m and N s/m, bending stiffness N m/rad.

    Springs and dampers join points at y = +-spring_y, +-damper_y and at spring_height, damper_height, m, that
    coincide in the nominal position. turn: share of the upper body's roll in the axes of a spring. 0 is a spring that
    stands upright on the lower body and is loaded where the upper body has moved to, 0.5 a coil clamped at both ends
    alike.
    """

    lateral_stiffness: float
    vertical_stiffness: float
    lateral_damping: float
    vertical_damping: float
    bending_stiffness: float
    spring_y: float
    spring_height: float
    damper_y: float
    damper_height: float
    turn: float = 0.0

    def __post_init__(self) -> None:
        check(self, positive=("lateral_stiffness", "vertical_stiffness", "spring_y"))
        if self.turn > 1.0:
            raise ValueError(f"Suspension.turn = {self.turn}: a share between 0 and 1")

    def scaled(self, factor: float) -> Suspension:
        return replace(
            self,
            lateral_stiffness=factor * self.lateral_stiffness,
            vertical_stiffness=factor * self.vertical_stiffness,
            lateral_damping=factor * self.lateral_damping,
            vertical_damping=factor * self.vertical_damping,
            bending_stiffness=factor * self.bending_stiffness,
        )


@dataclass(frozen=True)
class Scaling:
    """Shares of the vehicle in the plane model: Table 1 (masses and inertias) and Table 2 (springs and dampers)."""

    car_body: float = 0.25
    bogie: float = 0.5
    wheelset: float = 1.0
    secondary: float = 0.5
    primary: float = 1.0

    def __post_init__(self) -> None:
        check(self, positive=tuple(f.name for f in fields(self)))
