"""Components of a wagon: rigid bodies, suspension stages, and scaling to the plane model."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import inf, isfinite

from wheelrail.vehicle.wagon.force_law import ForceLaw, Law


class InvalidParameter(ValueError):
    """A value out of bounds.

    Parameters:
        instance: dataclass with the value.
        key: field of the value.
        allowed: values.
    """

    def __init__(self, instance: object, key: str, allowed: str) -> None:
        super().__init__(f"{type(instance).__name__}.{key} = {getattr(instance, key)}: {allowed}")
        self.key, self.allowed = key, allowed


def check(instance: object, *, positive: tuple[str, ...] = (), infinite: tuple[str, ...] = ()) -> None:
    """Checks that all numbers of a dataclass are finite and not negative.

    Parameters:
        instance: dataclass to check.
        positive: fields that must not be zero.
        infinite: fields that may be infinite.

    Raises InvalidParameter.
    """
    for item in fields(instance):  # type: ignore[arg-type]
        value = getattr(instance, item.name)
        if not isinstance(value, (int, float)):
            continue
        finite = isfinite(value) or (value == inf and item.name in infinite)
        if not finite or value < 0.0 or (value == 0.0 and item.name in positive):
            sign = "positive" if item.name in positive else "zero or positive"
            raise InvalidParameter(
                instance, item.name, f"must be {sign}{' or inf' if item.name in infinite else ' and finite'}"
            )


@dataclass(frozen=True)
class RigidBody:
    """A rigid body.

    Parameters:
        mass: kg.
        roll_inertia, pitch_inertia, yaw_inertia: principal moments of inertia, kg m2.
        height: of the centre of mass above top of rail, m.
    """

    mass: float
    roll_inertia: float
    pitch_inertia: float
    yaw_inertia: float
    height: float

    def __post_init__(self) -> None:
        check(self, positive=tuple(f.name for f in fields(self)))

    def scaled(self, factor: float) -> RigidBody:
        return replace(
            self,
            mass=factor * self.mass,
            roll_inertia=factor * self.roll_inertia,
            pitch_inertia=factor * self.pitch_inertia,
            yaw_inertia=factor * self.yaw_inertia,
        )


@dataclass(frozen=True)
class Suspension:
    """One suspension stage: a spring and a damper on each side, values for one side.

    Parameters:
        lateral_stiffness, vertical_stiffness: N/m, or a force law over deflection m.
        lateral_damping, vertical_damping: N s/m, or a force law over velocity m/s.
        bending_stiffness: N m/rad.
        spring_y, spring_height, damper_y, damper_height: m, lateral position (+-y) and height above top of rail of the
            attachment points, which coincide in the nominal position.
        turn: fraction of the upper body's roll in the axes of a spring: 0 for a spring upright on the lower body and
            loaded at the displaced point of the upper one, 0.5 for a coil clamped at both ends.
        lateral_series_stiffness, vertical_series_stiffness: N/m, spring in series with the damper (Maxwell element);
            inf: rigid.

    Deflections and velocities of nonlinear laws are those of the upper body relative to the lower, from the nominal
    loaded position: vertical ones positive in extension, lateral ones positive outwards on both sides. The law of a
    vertical spring gives the change of force from the static load. Raises InvalidParameter for values out of bounds.
    """

    lateral_stiffness: Law
    vertical_stiffness: Law
    lateral_damping: Law
    vertical_damping: Law
    bending_stiffness: float
    spring_y: float
    spring_height: float
    damper_y: float
    damper_height: float
    turn: float = 0.0
    lateral_series_stiffness: float = inf
    vertical_series_stiffness: float = inf

    def __post_init__(self) -> None:
        series = {"lateral_series_stiffness": self.lateral_damping, "vertical_series_stiffness": self.vertical_damping}
        check(self, positive=("lateral_stiffness", "vertical_stiffness", "spring_y", *series), infinite=tuple(series))
        if self.turn > 1.0:
            raise InvalidParameter(self, "turn", "must be between 0 and 1")
        for key, damping in series.items():
            increasing = damping.increasing if isinstance(damping, ForceLaw) else damping > 0.0
            if getattr(self, key) < inf and not increasing:
                raise InvalidParameter(
                    self, key, "must be inf, unless the damper's force increases strictly with the velocity"
                )

    def scaled(self, factor: float) -> Suspension:
        return replace(
            self,
            lateral_stiffness=factor * self.lateral_stiffness,
            vertical_stiffness=factor * self.vertical_stiffness,
            lateral_damping=factor * self.lateral_damping,
            vertical_damping=factor * self.vertical_damping,
            bending_stiffness=factor * self.bending_stiffness,
            lateral_series_stiffness=factor * self.lateral_series_stiffness,
            vertical_series_stiffness=factor * self.vertical_series_stiffness,
        )


@dataclass(frozen=True)
class Scaling:
    """Fractions of the vehicle in the plane model: Table 1 (masses and inertias), Table 2 (springs and dampers)."""

    car_body: float = 0.25
    bogie: float = 0.5
    wheelset: float = 1.0
    secondary: float = 0.5
    primary: float = 1.0

    def __post_init__(self) -> None:
        check(self, positive=tuple(f.name for f in fields(self)))
