"""Parts of a suspension between two bodies as data: elements at points, rods, rotational springs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import dist, inf, isfinite

from wheelrail.vehicle.wagon.force_law import ForceLaw, Law

Three = tuple[float, float, float]
Laws = tuple[Law, Law, Law]  # along x, y, z
NONE: Three = (0.0, 0.0, 0.0)
SHORTEST = 1e-3  # m, of a rod


class InvalidVehicle(ValueError):
    """A vehicle that is not valid.

    Parameters:
        key: of the invalid value, such as "bodies.front_bogie.mass".
        allowed: what is allowed.
    """

    def __init__(self, key: str, allowed: str) -> None:
        super().__init__(f"{key}: {allowed}")
        self.key, self.allowed = key, allowed


def check_numbers(key: str, values: Iterable[float]) -> None:
    """Raises InvalidVehicle for numbers below zero or not finite."""
    if not all(0.0 <= value < inf for value in values):
        raise InvalidVehicle(key, "must be zero or positive and finite")


@dataclass(frozen=True)
class SuspensionElement:
    """Springs, dampers and friction in three directions between two points that coincide in the nominal position.

    Parameters:
        upper, lower: names of the bodies; the upper one is no wheelset.
        point: (3,) m, x forward of the vehicle's reference point, y to the left, height above top of rail.
        stiffness: (3,) N/m, or force laws over deflection m, along the element's axes.
        damping: (3,) N s/m, or force laws over velocity m/s.
        series_stiffness: (3,) N/m, of a spring in series with the damper (Maxwell element); inf: rigid.
        turn: the element's axes turn with the lower body (0), the upper body (1), or in between.
        friction: (3,) N, force at which a slider moves.
        friction_coefficient: (3,) the same as a part of the vertical spring force, static load included, in addition.
        friction_stiffness: (3,) N/m, of a spring in series with the slider.
        surge_mass: (3,) kg, moved by the spring in series with the damper, as air in the pipe of an air spring.
        surge_exponent: (3,) of the velocity of this mass in the force of a linear damper, then in N (s/m)^exponent.
        lower_point: (3,) m, of a rod from there to `point`, whose first values act along it; None: both coincide.

    Deflections are those of the upper point relative to the lower one, of a rod its change of length. The law of a
    vertical spring gives the change of force from the static load, see `static_loads`.
    """

    upper: str
    lower: str
    point: Three
    stiffness: Laws = NONE
    damping: Laws = NONE
    series_stiffness: Three = (inf, inf, inf)
    turn: float = 0.0
    friction: Three = NONE
    friction_coefficient: Three = NONE
    friction_stiffness: Three = NONE
    surge_mass: Three = NONE
    surge_exponent: Three = (1.0, 1.0, 1.0)
    lower_point: Three | None = None

    def has_friction(self, direction: int) -> bool:
        """Whether there is a slider along x (0), y (1), z (2)."""
        return self.friction[direction] > 0.0 or self.friction_coefficient[direction] > 0.0

    @property
    def carries(self) -> bool:
        """Whether the upper body stands on the lower one: on a vertical spring."""
        return self.stiffness[2] != 0.0

    @property
    def length(self) -> float:
        """Of a rod, m; 0 for other elements."""
        return 0.0 if self.lower_point is None else dist(self.point, self.lower_point)

    @property
    def mirrored(self) -> SuspensionElement:
        """The mirror image in y = 0."""
        return self._reversed((1.0, -1.0, 1.0))

    @property
    def turned(self) -> SuspensionElement:
        """The element of the vehicle turned end for end."""
        return self._reversed((-1.0, -1.0, 1.0))

    def moved(self, x: float) -> SuspensionElement:
        """The element moved forwards by x m."""

        def place(point: Three) -> Three:
            return point[0] + x, point[1], point[2]

        lower = None if self.lower_point is None else place(self.lower_point)
        return replace(self, point=place(self.point), lower_point=lower)

    def _reversed(self, signs: Three) -> SuspensionElement:
        """The element with some axes reversed; forces along a rod stay as they are."""

        def laws(values: Laws) -> Laws:
            if self.lower_point is not None:
                return values
            x, y, z = (law.mirrored if s < 0.0 and isinstance(law, ForceLaw) else law
                       for law, s in zip(values, signs, strict=True))  # fmt: skip
            return x, y, z

        def place(point: Three) -> Three:
            x, y, z = (s * p for s, p in zip(signs, point, strict=True))
            return x, y, z

        return replace(
            self,
            point=place(self.point),
            lower_point=None if self.lower_point is None else place(self.lower_point),
            stiffness=laws(self.stiffness),
            damping=laws(self.damping),
        )

    def check(self, key: str) -> None:
        """Raises InvalidVehicle for values out of bounds; key: of the element."""
        for name in ("point", "lower_point"):
            if not all(isfinite(value) for value in getattr(self, name) or ()):
                raise InvalidVehicle(f"{key}.{name}", "must be three finite numbers, m")
        for part in ("stiffness", "damping"):
            laws = getattr(self, part)
            check_numbers(f"{key}.{part}", (law for law in laws if not isinstance(law, ForceLaw)))
        for part in ("friction", "friction_coefficient", "friction_stiffness", "surge_mass"):
            check_numbers(f"{key}.{part}", getattr(self, part))
        for direction, stiffness in enumerate(self.friction_stiffness):
            if self.has_friction(direction) != (stiffness > 0.0):
                raise InvalidVehicle(f"{key}.friction_stiffness", "must be positive where there is friction, else zero")
        if not 0.0 <= self.turn <= 1.0:
            raise InvalidVehicle(f"{key}.turn", "must be from 0 to 1")
        for series, damping in zip(self.series_stiffness, self.damping, strict=True):
            increasing = damping.increasing if isinstance(damping, ForceLaw) else damping > 0.0
            if not (series == inf or (isfinite(series) and series > 0.0 and increasing)):
                text = "must be inf, or positive with a damper whose force increases strictly with the velocity"
                raise InvalidVehicle(f"{key}.series_stiffness", text)
        self._check_surge(key)
        self._check_rod(key)

    def _check_surge(self, key: str) -> None:
        for mass, series in zip(self.surge_mass, self.series_stiffness, strict=True):
            if mass > 0.0 and series == inf:
                raise InvalidVehicle(f"{key}.surge_mass", "must be zero without series_stiffness")
        for exponent, mass, law in zip(self.surge_exponent, self.surge_mass, self.damping, strict=True):
            if not 1.0 <= exponent <= 3.0:
                raise InvalidVehicle(f"{key}.surge_exponent", "must be from 1 to 3")
            if exponent != 1.0 and (mass == 0.0 or isinstance(law, ForceLaw)):
                raise InvalidVehicle(f"{key}.surge_exponent", "must be 1 without surge_mass, and with a law of damping")

    def _check_rod(self, key: str) -> None:
        if self.lower_point is None:
            return
        if self.length < SHORTEST:
            raise InvalidVehicle(f"{key}.lower_point", f"must be {SHORTEST:g} m from the upper point at least")
        for part in ("stiffness", "damping", "friction"):
            if getattr(self, part)[1:] != (0.0, 0.0):
                raise InvalidVehicle(f"{key}.{part}", "must be [along, 0, 0] of a rod between two points")
        if self.friction_coefficient != NONE:
            raise InvalidVehicle(f"{key}.friction_coefficient", "must be zero of a rod, which bears no static load")


@dataclass(frozen=True)
class RotationalSpring:
    """Moments between two bodies by their relative rotation and its rate, as of a roll bar or a bushing.

    Parameters:
        upper, lower: names of the bodies.
        stiffness: (3,) N m/rad about the axes of the lower body.
        damping: (3,) N m s/rad.
    """

    upper: str
    lower: str
    stiffness: Three
    damping: Three = NONE

    def check(self, key: str) -> None:
        """Raises InvalidVehicle for values out of bounds; key: of the spring."""
        check_numbers(f"{key}.stiffness", self.stiffness)
        check_numbers(f"{key}.damping", self.damping)
