"""What a wagon is made of: rigid bodies, stages of suspension, and their shares in the plane model."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from math import inf, isfinite

from wheelrail.vehicle.wagon.force_law import ForceLaw, Law


class InvalidParameter(ValueError):
    """A value that is not allowed: which, and what is."""

    def __init__(self, thing: object, key: str, allowed: str) -> None:
        super().__init__(f"{type(thing).__name__}.{key} = {getattr(thing, key)}: {allowed}")
        self.key, self.allowed = key, allowed


def check(thing: object, *, positive: tuple[str, ...] = (), infinite: tuple[str, ...] = ()) -> None:
    """Every number is finite and not negative, except that the named ones are not zero, or may be infinite; raises
    Refused.
    """
    for item in fields(thing):  # type: ignore[arg-type]
        value = getattr(thing, item.name)
        if not isinstance(value, (int, float)):
            continue
        finite = isfinite(value) or (value == inf and item.name in infinite)
        if not finite or value < 0.0 or (value == 0.0 and item.name in positive):
            sign = "positive" if item.name in positive else "zero or positive"
            raise InvalidParameter(
                thing, item.name, f"must be {sign}{' or inf' if item.name in infinite else ' and finite'}"
            )


@dataclass(frozen=True)
class RigidBody:
    """A rigid body: mass kg, principal moments of inertia kg m2, height of its centre above top of rail m."""

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
    """One stage: a spring and a damper on each side, values of one side in N/m and N s/m, bending stiffness N m/rad.

    Stiffness and damping are numbers, or the points of a force law: force over deflection or velocity of the upper body
    against the lower one, vertical ones positive where they part, lateral ones positive outwards on both sides.
    Deflections count from the nominal loaded position: the law of a vertical spring is what its force changes by from
    the static load. Series stiffness: that of a spring in series with the damper; inf is none.

    Springs and dampers join points at y = +-spring_y, +-damper_y and at spring_height, damper_height, m, that
    coincide in the nominal position. turn: share of the upper body's roll in the axes of a spring. 0 is a spring that
    stands upright on the lower body and is loaded where the upper body has moved to, 0.5 a coil clamped at both ends
    alike. Raises Refused for values out of bounds.
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
            raise InvalidParameter(self, "turn", "must be a share between 0 and 1")
        for key, damping in series.items():
            rises = damping.rises if isinstance(damping, ForceLaw) else damping > 0.0
            if getattr(self, key) < inf and not rises:
                raise InvalidParameter(
                    self, key, "must be inf, unless the damper's force rises with the velocity everywhere"
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
    """Shares of the vehicle in the plane model: Table 1 (masses and inertias) and Table 2 (springs and dampers)."""

    car_body: float = 0.25
    bogie: float = 0.5
    wheelset: float = 1.0
    secondary: float = 0.5
    primary: float = 1.0

    def __post_init__(self) -> None:
        check(self, positive=tuple(f.name for f in fields(self)))
