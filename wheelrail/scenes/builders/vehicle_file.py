"""Reading of vehicle files (TOML): rigid bodies, suspension elements and rotational springs by name."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AllowInfNan, Field, Strict, ValidationError

from wheelrail.scenes.schema import quantities as q
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import entry_message, validation_error, warn_of_unusual
from wheelrail.scenes.schema.tables import SceneTable
from wheelrail.scenes.schema.toml import parse, read_text

if TYPE_CHECKING:
    from wheelrail.vehicle.multibody.elements import Laws, SuspensionElement
    from wheelrail.vehicle.multibody.vehicle import Vehicle

MANCHESTER = Path(__file__).parents[1] / "examples" / "manchester_vehicle.toml"

# Keys of an element that are those of `SuspensionElement`.
ELEMENT_VALUES = {
    "upper", "lower", "series_stiffness", "turn", "friction", "friction_coefficient", "friction_stiffness",
    "surge_mass", "surge_exponent",
}  # fmt: skip

Mass = Annotated[q.Finite, q.Range(1.0, 1e6, "kg", "1 t is 1000", usual=(100.0, 2e5))]
Inertia = Annotated[q.Finite, q.Range(1.0, 1e9, "kg m2")]
Along = Annotated[q.Finite, q.Range(-100.0, 100.0, "m", "forward of the vehicle's reference point")]
Across = Annotated[q.Finite, q.Range(-5.0, 5.0, "m", "to the left")]
Height = Annotated[q.Finite, q.Range(0.05, 5.0, "m", "above top of rail")]
Point = Annotated[tuple[Along, Across, Height], Strict(False)]
LawPoint = Annotated[tuple[q.Finite, q.Finite], Strict(False)]
LawPoints = Annotated[tuple[LawPoint, ...], Strict(False), Field(min_length=2), q.AtMost(1000)]
Stiffness = Annotated[q.Finite, q.Range(0.0, 1e11, "N/m", "or points [m, N]")]
Damping = Annotated[q.Finite, q.Range(0.0, 1e9, "N s/m", "or points [m/s, N]")]
Series = Annotated[float, Strict(), AllowInfNan(True), q.Range(1e3, inf, "N/m, in series with the damper; inf is none")]
Friction = Annotated[q.Finite, q.Range(0.0, 1e7, "N, at which a slider moves")]
FrictionCoefficient = Annotated[q.Finite, q.Range(0.0, 10.0, "of the vertical spring force, in addition to friction")]
FrictionStiffness = Annotated[q.Finite, q.Range(0.0, 1e11, "N/m, in series with the slider")]
SurgeMass = Annotated[q.Finite, q.Range(0.0, 1e6, "kg, between damper and series_stiffness")]
Exponent = Annotated[q.Finite, q.Range(1.0, 3.0, "of the velocity of surge_mass in the force of the damper")]
RotationalDamping = Annotated[q.Finite, q.Range(0.0, 1e9, "N m s/rad")]
Rotational = Annotated[q.Finite, q.Range(0.0, 1e10, "N m/rad")]
TorsionDamping = Annotated[q.Finite, q.Range(0.0, 1e9, "N m s/rad")]


Coordinate = Literal["x", "y", "z", "roll", "pitch", "yaw"]


class VehicleBodyTable(SceneTable):
    """A rigid body: mass, kg, inertia about x, y and z, kg m2, place of its centre, m.

    The height of a wheelset is its rolling radius. Independent wheels turn by themselves, with a spring, N m/rad, and a
    damper, N m s/rad, between them as torsion. Held coordinates follow the track at constant speed.
    """

    mass: Mass
    inertia: Annotated[tuple[Inertia, Inertia, Inertia], Strict(False)]
    x: Along
    height: Height
    wheelset: bool = False
    independent: bool = False
    torsion: Annotated[tuple[Rotational, TorsionDamping], Strict(False)] = (0.0, 0.0)
    held: Annotated[tuple[Coordinate, ...], Strict(False)] = ()


class AirSpringTable(SceneTable):
    """Air spring on a reservoir behind a pipe, which adds to the vertical values of an element.

    Absolute pressure, Pa, effective area, m2, volumes, m3, length, m, and area, m2, of the pipe, and its loss of
    pressure over the dynamic pressure.
    """

    pressure: Annotated[q.Finite, q.Range(1e5, 2e6, "Pa, absolute")]
    area: Annotated[q.Finite, q.Range(1e-3, 2.0, "m2")]
    volume: Annotated[q.Finite, q.Range(1e-4, 1.0, "m3, of the bag")]
    reservoir: Annotated[q.Finite, q.Range(1e-4, 2.0, "m3")]
    pipe_length: Annotated[q.Finite, q.Range(0.01, 20.0, "m")]
    pipe_area: Annotated[q.Finite, q.Range(1e-6, 0.1, "m2")]
    loss: Annotated[q.Finite, q.Range(0.0, 1e4, "of pressure, over the dynamic pressure in the pipe")]


class ElementTable(SceneTable):
    """Equal springs and dampers between two bodies, one at each point, m; values along x, y and z.

    Rods go from a point of `lower_points` to one of `points`; their first values act along them. A bushing has moments,
    N m/rad and N m s/rad about the axes of the lower body, too.
    """

    upper: str
    lower: str
    points: Annotated[tuple[Point, ...], Strict(False), Field(min_length=1), q.AtMost(1000)]
    stiffness: Annotated[tuple[Stiffness | LawPoints, Stiffness | LawPoints, Stiffness | LawPoints], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    damping: Annotated[tuple[Damping | LawPoints, Damping | LawPoints, Damping | LawPoints], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    series_stiffness: Annotated[tuple[Series, Series, Series], Strict(False)] = (inf, inf, inf)
    turn: q.Share = 0.0
    friction: Annotated[tuple[Friction, Friction, Friction], Strict(False)] = (0.0, 0.0, 0.0)
    friction_coefficient: Annotated[
        tuple[FrictionCoefficient, FrictionCoefficient, FrictionCoefficient], Strict(False)
    ] = (0.0, 0.0, 0.0)
    friction_stiffness: Annotated[tuple[FrictionStiffness, FrictionStiffness, FrictionStiffness], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    surge_mass: Annotated[tuple[SurgeMass, SurgeMass, SurgeMass], Strict(False)] = (0.0, 0.0, 0.0)
    surge_exponent: Annotated[tuple[Exponent, Exponent, Exponent], Strict(False)] = (1.0, 1.0, 1.0)
    lower_points: Annotated[tuple[Point, ...], Strict(False), q.AtMost(1000)] = ()
    rotational_stiffness: Annotated[tuple[Rotational, Rotational, Rotational], Strict(False)] = (0.0, 0.0, 0.0)
    rotational_damping: Annotated[tuple[RotationalDamping, RotationalDamping, RotationalDamping], Strict(False)] = (
        0.0,
        0.0,
        0.0,
    )
    air_spring: AirSpringTable | None = None


class RotationalSpringTable(SceneTable):
    """Moments about the axes of the lower body, N m/rad and N m s/rad about x, y and z."""

    upper: str
    lower: str
    stiffness: Annotated[tuple[Rotational, Rotational, Rotational], Strict(False)]
    damping: Annotated[tuple[RotationalDamping, RotationalDamping, RotationalDamping], Strict(False)] = (0.0, 0.0, 0.0)


class SpeedHoldTable(SceneTable):
    """Spring, N/m, and damper, N s/m, along the track that keep a body at its place in the reference motion."""

    body: str
    stiffness: Stiffness = 2e5
    damping: Damping = 1e5


class VehicleFileTable(SceneTable):
    """A vehicle file after its types have been filled in."""

    bodies: dict[str, VehicleBodyTable]
    elements: dict[str, ElementTable]
    rotational_springs: dict[str, RotationalSpringTable] = Field(default_factory=dict)
    speed_hold: SpeedHoldTable | None = None
    wheel_y: Annotated[q.Finite, q.Range(0.2, 1.5, "m", "half the distance of the rolling circles")] = 0.75
    gravity: Annotated[q.Finite, q.Range(0.0, 30.0, "m/s2")] = 9.81


def load_vehicle(path: str | Path = MANCHESTER) -> Vehicle:
    """Vehicle of a TOML file.

    Parameters:
        path: vehicle file; by default Manchester benchmark vehicle 1.

    Warns of unusual values. Raises SceneError naming file, key, value and what is allowed.
    """
    return parse_vehicle(read_text(Path(path)), path, warn=True)


def parse_vehicle(text: str, path: str | Path, *, warn: bool = False) -> Vehicle:
    """Vehicle of a TOML text.

    Parameters:
        text: TOML.
        path: its file, for messages.
        warn: whether to warn of unusual values.

    Raises SceneError as `load_vehicle`.
    """
    return vehicle_of(parse(text, path), path, warn=warn)


def vehicle_of(tables: Mapping[str, Any], path: str | Path, *, warn: bool = False) -> Vehicle:
    """Vehicle of the tables of a file; parameters and errors as of `parse_vehicle`."""
    from wheelrail.vehicle.multibody.elements import InvalidVehicle
    from wheelrail.vehicle.multibody.static_loads import static_loads
    from wheelrail.vehicle.steady.held_bodies import require_held

    data = _with_types(tables, path)
    try:
        table = VehicleFileTable.model_validate(data)
    except ValidationError as error:
        raise validation_error(error, VehicleFileTable, data, path) from None
    if warn:
        warn_of_unusual(table, path)
    try:
        vehicle = _vehicle(table)
        static_loads(vehicle)  # validates that every body is carried
        require_held(vehicle)
    except InvalidVehicle as error:
        raise SceneError(f"{path}: {entry_message(tuple(error.key.split('.')), data, error.allowed)}") from None
    return vehicle


def _with_types(data: Mapping[str, Any], path: str | Path) -> dict[str, Any]:
    """Vehicle tables with values of `type` ahead of the own ones of each body and element. Raises SceneError."""
    result = {key: value for key, value in data.items() if key not in ("body_types", "element_types")}
    for kind, types_key in (("bodies", "body_types"), ("elements", "element_types")):
        types, entries = data.get(types_key, {}), result.get(kind)
        if not isinstance(types, Mapping) or not all(isinstance(values, Mapping) for values in types.values()):
            raise SceneError(f"{path}: {types_key}: must be tables of values by name")
        if isinstance(entries, Mapping):
            result[kind] = {name: _filled(f"{path}: {kind}.{name}", entry, types) for name, entry in entries.items()}
    return result


def _filled(place: str, entry: Any, types: Mapping[str, Mapping[str, Any]]) -> Any:
    if not isinstance(entry, Mapping) or "type" not in entry:
        return entry
    name = entry["type"]
    if not isinstance(name, str) or name not in types:
        raise SceneError(f"{place}.type = {str(name)[:100]!r}: must be one of {', '.join(types) or 'none: no types'}")
    return {**types[name], **{key: value for key, value in entry.items() if key != "type"}}


def _vehicle(table: VehicleFileTable) -> Vehicle:
    """Raises InvalidVehicle."""
    from wheelrail.vehicle.multibody.elements import InvalidVehicle, RotationalSpring
    from wheelrail.vehicle.multibody.vehicle import SpeedHold, Vehicle, VehicleBody

    elements: dict[str, SuspensionElement] = {}
    springs = {name: RotationalSpring(**s.model_dump()) for name, s in table.rotational_springs.items()}
    for name, entry in table.elements.items():
        own = _elements(name, entry)
        elements |= own
        turning = entry.rotational_stiffness, entry.rotational_damping
        if any(map(any, turning)):
            if clash := set(own) & set(springs):
                raise InvalidVehicle(f"rotational_springs.{min(clash)}", f"must not be named as elements.{name}")
            springs |= {each: RotationalSpring(entry.upper, entry.lower, *turning) for each in own}
    hold = table.speed_hold
    return Vehicle(
        bodies={name: VehicleBody(**body.model_dump()) for name, body in table.bodies.items()},
        elements=elements,
        rotational_springs=springs,
        speed_hold=None if hold is None else SpeedHold(**hold.model_dump()),
        wheel_y=table.wheel_y,
        gravity=table.gravity,
    )


def _elements(name: str, entry: ElementTable) -> dict[str, SuspensionElement]:
    """One element for each point, numbered from 1 where there are several. Raises InvalidVehicle."""
    from wheelrail.vehicle.multibody.elements import InvalidVehicle, SuspensionElement

    names = [name] if len(entry.points) == 1 else [f"{name}_{i}" for i in range(1, len(entry.points) + 1)]
    lower = entry.lower_points or (None,) * len(names)
    if len(lower) != len(names):
        raise InvalidVehicle(f"elements.{name}.lower_points", f"must be as many as points, {len(names)}")
    values = entry.model_dump(include=ELEMENT_VALUES)
    values["stiffness"] = _laws(f"elements.{name}.stiffness", entry.stiffness)
    values["damping"] = _laws(f"elements.{name}.damping", entry.damping)
    if entry.air_spring is not None:
        values |= _with_air(name, entry.air_spring, values)
    return {
        each: SuspensionElement(point=point, lower_point=other, **values)
        for each, point, other in zip(names, entry.points, lower, strict=True)
    }


def _with_air(name: str, table: AirSpringTable, values: Mapping[str, Any]) -> dict[str, Any]:
    """Values of an element with an air spring. Raises InvalidVehicle where another part is in its place."""
    from wheelrail.vehicle.multibody.elements import InvalidVehicle
    from wheelrail.vehicle.wagon.air_spring import AirSpring

    air = AirSpring(**table.model_dump())
    own = {"series_stiffness": air.series_stiffness, "surge_mass": air.mass, "surge_exponent": 2.0}
    own["damping"] = air.damping or 1e-9  # without loss: none, but a damper
    result = {key: (*values[key][:2], value) for key, value in own.items()}
    along, across, up = values["stiffness"]
    if not isinstance(up, float) or values["damping"][2] != 0.0 or values["series_stiffness"][2] != inf:
        text = "must be with a vertical stiffness that is a number, and without vertical damping and series_stiffness"
        raise InvalidVehicle(f"elements.{name}.air_spring", text)
    return result | {"stiffness": (along, across, up + air.stiffness)}


def _laws(key: str, values: tuple[float | tuple[tuple[float, float], ...], ...]) -> Laws:
    """Raises InvalidVehicle for points that are no force law."""
    from wheelrail.vehicle.multibody.elements import InvalidVehicle
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    try:
        x, y, z = (ForceLaw(value) if isinstance(value, tuple) else value for value in values)
    except ValueError as error:
        raise InvalidVehicle(key, f"must have {error}") from None
    return x, y, z
