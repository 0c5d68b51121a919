"""A railway vehicle as data: rigid bodies, suspension elements between them, rotational springs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isfinite

from wheelrail.vehicle.wagon.force_law import ForceLaw, Law

COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")  # of a body in the track frame at its own distance
ROUNDED = 1e-3  # of moments of inertia in a file

Laws = tuple[Law, Law, Law]  # along x, y, z


class InvalidVehicle(ValueError):
    """A vehicle that is not valid.

    Parameters:
        key: of the invalid value, such as "bodies.front_bogie.mass".
        allowed: what is allowed.
    """

    def __init__(self, key: str, allowed: str) -> None:
        super().__init__(f"{key}: {allowed}")
        self.key, self.allowed = key, allowed


@dataclass(frozen=True)
class VehicleBody:
    """A rigid body whose principal axes of inertia are x, y and z.

    Parameters:
        mass: kg.
        inertia: (3,) kg m2, about x, y and z through the centre of mass.
        x: of the centre of mass, m forward of the vehicle's reference point.
        height: of the centre of mass above top of rail, m; of a wheelset its nominal rolling radius.
        wheelset: whether the body is a wheelset: a body of revolution that rolls on the rails.
        held: coordinates that a constraint without work holds at zero, of `COORDINATES`: x at the body's place in the
            reference motion, the pitch of a wheelset at nominal rolling, the others in the nominal position.
        independent: whether the wheels of a wheelset turn by themselves; its pitch is their mean, its inertia about y
            that of both.
        torsion: N m/rad and N m s/rad, of a spring and a damper between independent wheels, such as a soft axle.
    """

    mass: float
    inertia: tuple[float, float, float]
    x: float
    height: float
    wheelset: bool = False
    held: tuple[str, ...] = ()
    independent: bool = False
    torsion: tuple[float, float] = (0.0, 0.0)


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

    Deflections are those of the upper point relative to the lower one. The law of a vertical spring gives the change of
    force from the static load, see `static_loads`.
    """

    upper: str
    lower: str
    point: tuple[float, float, float]
    stiffness: Laws = (0.0, 0.0, 0.0)
    damping: Laws = (0.0, 0.0, 0.0)
    series_stiffness: tuple[float, float, float] = (inf, inf, inf)
    turn: float = 0.0
    friction: tuple[float, float, float] = (0.0, 0.0, 0.0)
    friction_coefficient: tuple[float, float, float] = (0.0, 0.0, 0.0)
    friction_stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def has_friction(self, direction: int) -> bool:
        """Whether there is a slider along x (0), y (1), z (2)."""
        return self.friction[direction] > 0.0 or self.friction_coefficient[direction] > 0.0


@dataclass(frozen=True)
class RotationalSpring:
    """Moments between two bodies proportional to their relative rotation, as of a roll bar.

    Parameters:
        upper, lower: names of the bodies.
        stiffness: (3,) N m/rad about the axes of the lower body.
    """

    upper: str
    lower: str
    stiffness: tuple[float, float, float]


@dataclass(frozen=True)
class SpeedHold:
    """Spring and damper along the track that keep a body at its place in the reference motion.

    Parameters:
        body: name.
        stiffness: N/m.
        damping: N s/m.
    """

    body: str
    stiffness: float = 2e5
    damping: float = 1e5


@dataclass(frozen=True)
class Vehicle:
    """Rigid bodies, suspension elements and rotational springs, each by name.

    Parameters:
        bodies: at least one of them a wheelset, all of the same rolling radius.
        elements, rotational_springs: between the bodies.
        speed_hold: the force that keeps the speed; None: the vehicle coasts.
        wheel_y: m, half the lateral distance of the nominal rolling circles.
        gravity: m/s2.

    Raises InvalidVehicle for values out of bounds, unknown bodies, and bodies without connection to a wheelset.
    """

    bodies: dict[str, VehicleBody]
    elements: dict[str, SuspensionElement]
    rotational_springs: dict[str, RotationalSpring]
    speed_hold: SpeedHold | None = None
    wheel_y: float = 0.75
    gravity: float = 9.81

    def __post_init__(self) -> None:
        for name, body in self.bodies.items():
            _check_body(f"bodies.{name}", body)
        if not self.wheelsets:
            raise InvalidVehicle("bodies", "one of them at least must be a wheelset")
        for name in self.wheelsets:
            if self.bodies[name].height != self.radius:
                raise InvalidVehicle(f"bodies.{name}.height", f"must be {self.radius:g} m as of the first wheelset")
        for name, element in self.elements.items():
            self._check_element(f"elements.{name}", element)
        for name, spring in self.rotational_springs.items():
            self._check_pair(f"rotational_springs.{name}", spring.upper, spring.lower)
            _check_numbers(f"rotational_springs.{name}.stiffness", spring.stiffness)
        self._check_connected()
        self._check_rest()

    @cached_property
    def names(self) -> tuple[str, ...]:
        return tuple(self.bodies)

    @cached_property
    def wheelsets(self) -> tuple[str, ...]:
        """Names of the wheelsets, in order of the bodies."""
        return tuple(name for name, body in self.bodies.items() if body.wheelset)

    @cached_property
    def independent(self) -> tuple[str, ...]:
        """Names of the wheelsets with independent wheels."""
        return tuple(name for name in self.wheelsets if self.bodies[name].independent)

    @cached_property
    def radius(self) -> float:
        """Nominal rolling radius, m."""
        return self.bodies[self.wheelsets[0]].height

    @cached_property
    def weight(self) -> float:
        """Of all bodies, N."""
        return self.gravity * sum(body.mass for body in self.bodies.values())

    @property
    def mean_wheel_load(self) -> float:
        """Weight over the number of wheels, N."""
        return self.weight / (2 * len(self.wheelsets))

    @cached_property
    def mirror_pairs(self) -> tuple[tuple[int, int], ...]:
        """Indices of elements and of their mirror images in y = 0, -1 for none; every element once."""
        elements, pairs = list(self.elements.values()), list[tuple[int, int]]()
        for e, element in enumerate(elements):
            if any(e in pair for pair in pairs):
                continue
            x, y, z = element.point
            laws = (element.stiffness, element.damping)
            stiffness, damping = ((along, _mirrored(across), up) for along, across, up in laws)
            image = replace(element, point=(x, -y, z), stiffness=stiffness, damping=damping)
            images = [i for i, other in enumerate(elements) if i > e and other == image]
            pairs.append((e, images[0] if images else -1))
        return tuple(pairs)

    @property
    def turned(self) -> Vehicle:
        """The vehicle turned end for end, with the names of its bodies."""
        elements = {}
        for name, own in self.elements.items():
            x, y, z = own.point
            laws = own.stiffness, own.damping
            stiffness, damping = ((_mirrored(along), _mirrored(across), up) for along, across, up in laws)
            elements[name] = replace(own, point=(-x, -y, z), stiffness=stiffness, damping=damping)
        bodies = {name: replace(body, x=-body.x) for name, body in self.bodies.items()}
        return replace(self, bodies=bodies, elements=elements)

    def _check_element(self, key: str, element: SuspensionElement) -> None:
        self._check_pair(key, element.upper, element.lower)
        if not all(isfinite(value) for value in element.point):
            raise InvalidVehicle(f"{key}.point", "must be three finite numbers, m")
        for part in ("stiffness", "damping"):
            laws = getattr(element, part)
            _check_numbers(f"{key}.{part}", tuple(law for law in laws if not isinstance(law, ForceLaw)))
        for part in ("friction", "friction_coefficient", "friction_stiffness"):
            _check_numbers(f"{key}.{part}", getattr(element, part))
        for direction, stiffness in enumerate(element.friction_stiffness):
            if element.has_friction(direction) != (stiffness > 0.0):
                raise InvalidVehicle(f"{key}.friction_stiffness", "must be positive where there is friction, else zero")
        if not 0.0 <= element.turn <= 1.0:
            raise InvalidVehicle(f"{key}.turn", "must be from 0 to 1")
        for series, damping in zip(element.series_stiffness, element.damping, strict=True):
            increasing = damping.increasing if isinstance(damping, ForceLaw) else damping > 0.0
            if not (series == inf or (isfinite(series) and series > 0.0 and increasing)):
                text = "must be inf, or positive with a damper whose force increases strictly with the velocity"
                raise InvalidVehicle(f"{key}.series_stiffness", text)

    def _check_pair(self, key: str, upper: str, lower: str) -> None:
        for end, name in (("upper", upper), ("lower", lower)):
            if name not in self.bodies:
                raise InvalidVehicle(f"{key}.{end}", f'no body "{name}"; must be one of {", ".join(self.bodies)}')
        if upper == lower:
            raise InvalidVehicle(f"{key}.upper", "must be another body than lower")
        if self.bodies[upper].wheelset:
            raise InvalidVehicle(f"{key}.upper", f'must not be a wheelset, as "{upper}" is; wheelsets are lower bodies')

    def _check_connected(self) -> None:
        reached = set(self.wheelsets)
        pairs = [{part.upper, part.lower} for part in self.elements.values()]
        for _ in self.bodies:
            reached = reached.union(*(pair for pair in pairs if reached & pair))
        for name in self.bodies:
            if name not in reached:
                raise InvalidVehicle(f"bodies.{name}", "must be connected to a wheelset by suspension elements")

    def _check_rest(self) -> None:
        if self.speed_hold is not None:
            if self.speed_hold.body not in self.bodies:
                raise InvalidVehicle("speed_hold.body", f"must be one of {', '.join(self.bodies)}")
            _check_numbers("speed_hold", (self.speed_hold.stiffness, self.speed_hold.damping))
        for key in ("wheel_y", "gravity"):
            if not 0.0 < getattr(self, key) < inf:
                raise InvalidVehicle(key, "must be positive and finite")


def _check_body(key: str, body: VehicleBody) -> None:
    for name, values in (("mass", (body.mass,)), ("inertia", body.inertia), ("height", (body.height,))):
        if not all(0.0 < value < inf for value in values):
            raise InvalidVehicle(f"{key}.{name}", "must be positive and finite")
    if not isfinite(body.x):
        raise InvalidVehicle(f"{key}.x", "must be finite")
    if body.independent and (not body.wheelset or "pitch" in body.held):
        raise InvalidVehicle(f"{key}.independent", "must be false but for a wheelset whose pitch is not held")
    if any(body.torsion) and not body.independent:
        raise InvalidVehicle(f"{key}.torsion", "must be zero but between independent wheels")
    _check_numbers(f"{key}.torsion", body.torsion)
    if not set(body.held) <= set(COORDINATES):
        raise InvalidVehicle(f"{key}.held", f"must be of {', '.join(COORDINATES)}")
    if len(set(body.held)) < len(body.held):
        raise InvalidVehicle(f"{key}.held", "must name each coordinate once")
    turns = not {"roll", "pitch", "yaw"} & set(body.held)
    if turns and max(body.inertia) > (1.0 + ROUNDED) * (sum(body.inertia) - max(body.inertia)):
        text = "must be that of a body: none of the three greater than the sum of the other two"
        raise InvalidVehicle(f"{key}.inertia", text)
    if body.wheelset and "yaw" not in body.held and body.inertia[0] != body.inertia[2]:
        raise InvalidVehicle(f"{key}.inertia", "of a wheelset must be equal about x and z: a body of revolution")


def _mirrored(law: Law) -> Law:
    """Law of an element along an axis that is reversed."""
    return law.mirrored if isinstance(law, ForceLaw) else law


def _check_numbers(key: str, values: tuple[float, ...]) -> None:
    if not all(0.0 <= value < inf for value in values):
        raise InvalidVehicle(key, "must be zero or positive and finite")
