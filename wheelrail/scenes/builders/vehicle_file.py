"""Reading of vehicle files (TOML): rigid bodies, suspension elements and rotational springs by name."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import ValidationError

from wheelrail.scenes.builders.vehicle_file_tables import ELEMENT_VALUES, AirSpringTable, ElementTable, VehicleFileTable
from wheelrail.scenes.schema.errors import SceneError
from wheelrail.scenes.schema.messages import entry_message, validation_error, warn_of_unusual
from wheelrail.scenes.schema.toml import parse, read_text

if TYPE_CHECKING:
    from wheelrail.vehicle.multibody.elements import Laws, SuspensionElement
    from wheelrail.vehicle.multibody.vehicle import Vehicle

MANCHESTER = Path(__file__).parents[1] / "examples" / "manchester_vehicle.toml"

Part = TypeVar("Part")


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
    if "vehicles" in data:
        data = {"bodies": {}, "elements": {}} | data
    try:
        table = VehicleFileTable.model_validate(data)
    except ValidationError as error:
        raise validation_error(error, VehicleFileTable, data, path) from None
    if warn:
        warn_of_unusual(table, path)
    try:
        vehicle = _vehicle(table, _coupled(table, path))
        static_loads(vehicle)  # validates that every body is carried
        require_held(vehicle)
    except InvalidVehicle as error:
        raise SceneError(f"{path}: {entry_message(tuple(error.key.split('.')), data, error.allowed)}") from None
    return vehicle


def vehicle_text(path: Path) -> str:
    """Text of a vehicle file, and of the files named there. Raises SceneError."""
    text = read_text(path)
    table = parse(text, path).get("vehicles", {})
    names = {str(own["file"]) for own in table.values() if isinstance(own, Mapping) and "file" in own}
    if not names:
        return text
    files = (f"{json.dumps(name)} = {json.dumps(read_text(path.parent / name))}\n" for name in sorted(names))
    return f"{text}\n[files]\n{''.join(files)}"


def _coupled(table: VehicleFileTable, path: str | Path) -> list[Vehicle]:
    """Vehicles of a train at their places. Raises SceneError."""
    found = []
    for name, own in table.vehicles.items():
        file, text = Path(path).parent / own.file, table.files.get(own.file)
        text = read_text(file) if text is None else text
        if "vehicles" in parse(text, file):
            raise SceneError(f"{path}: vehicles.{name}.file = {own.file}: must be a vehicle, no train")
        vehicle = parse_vehicle(text, file)
        found.append((vehicle.turned if own.turned else vehicle).placed(name, own.x))
        for key in ("wheel_y", "gravity"):
            ours, theirs = getattr(table if key in table.model_fields_set else found[0], key), getattr(vehicle, key)
            if ours != theirs:
                text = f"must have the same {key}, {ours:g}, as the other vehicles; it is {theirs:g}"
                raise SceneError(f"{path}: vehicles.{name}.file = {own.file}: {text}")
    return found


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


def _vehicle(table: VehicleFileTable, coupled: Sequence[Vehicle] = ()) -> Vehicle:
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
    hold, bodies = table.speed_hold, {name: VehicleBody(**body.model_dump()) for name, body in table.bodies.items()}
    return Vehicle(
        bodies=_joined("bodies", [part.bodies for part in coupled], bodies),
        elements=_joined("elements", [part.elements for part in coupled], elements),
        rotational_springs=_joined("rotational_springs", [part.rotational_springs for part in coupled], springs),
        speed_hold=None if hold is None else SpeedHold(**hold.model_dump()),
        wheel_y=coupled[0].wheel_y if coupled else table.wheel_y,
        gravity=coupled[0].gravity if coupled else table.gravity,
    )


def _joined(kind: str, parts: Sequence[Mapping[str, Part]], own: Mapping[str, Part]) -> dict[str, Part]:
    """Parts of coupled vehicles, then own ones. Raises InvalidVehicle for a name of both."""
    from wheelrail.vehicle.multibody.elements import InvalidVehicle

    result: dict[str, Part] = {}
    for names in (*parts, own):
        if clash := set(result) & set(names):
            raise InvalidVehicle(f"{kind}.{min(clash)}", "must not be named as a part of another vehicle")
        result |= names
    return result


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
