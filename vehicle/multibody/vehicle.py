"""A railway vehicle as data: rigid bodies, suspension elements between them, rotational springs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isfinite

from wheelrail.vehicle.multibody.elements import InvalidVehicle, RotationalSpring, SuspensionElement, check_numbers

COORDINATES = ("x", "y", "z", "roll", "pitch", "yaw")  # of a body in the track frame at its own distance
ROUNDED = 1e-3  # of moments of inertia in a file


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
            self._check_pair(f"elements.{name}", element.upper, element.lower)
            element.check(f"elements.{name}")
        for name, spring in self.rotational_springs.items():
            self._check_pair(f"rotational_springs.{name}", spring.upper, spring.lower)
            spring.check(f"rotational_springs.{name}")
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
            image = element.mirrored
            images = [i for i, other in enumerate(elements) if i > e and other == image]
            pairs.append((e, images[0] if images else -1))
        return tuple(pairs)

    @property
    def turned(self) -> Vehicle:
        """The vehicle turned end for end, with the names of its bodies."""
        elements = {name: element.turned for name, element in self.elements.items()}
        bodies = {name: replace(body, x=-body.x) for name, body in self.bodies.items()}
        return replace(self, bodies=bodies, elements=elements)

    def placed(self, name: str, x: float) -> Vehicle:
        """The vehicle as part of a train, without its speed hold.

        Parameters:
            name: ahead of all its names.
            x: of its reference point, m forward of that of the train.
        """

        def own(part: SuspensionElement) -> SuspensionElement:
            return replace(part.moved(x), upper=f"{name}_{part.upper}", lower=f"{name}_{part.lower}")

        bodies = {f"{name}_{key}": replace(body, x=body.x + x) for key, body in self.bodies.items()}
        springs = {
            f"{name}_{key}": replace(part, upper=f"{name}_{part.upper}", lower=f"{name}_{part.lower}")
            for key, part in self.rotational_springs.items()
        }
        elements = {f"{name}_{key}": own(part) for key, part in self.elements.items()}
        return replace(self, bodies=bodies, elements=elements, rotational_springs=springs, speed_hold=None)

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
            check_numbers("speed_hold", (self.speed_hold.stiffness, self.speed_hold.damping))
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
    check_numbers(f"{key}.torsion", body.torsion)
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
