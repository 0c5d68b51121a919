"""Tables of a vehicle file whose values are varied: `vehicle.elements.primary.stiffness.1` in a study."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wheelrail.scenes.builders.vehicle import check_fit
from wheelrail.scenes.builders.vehicle_file import vehicle_of
from wheelrail.scenes.builders.vehicle_file_tables import VehicleFileTable
from wheelrail.scenes.schema.edits import keys_of
from wheelrail.scenes.schema.messages import unit_of
from wheelrail.scenes.schema.toml import parse, read_text

if TYPE_CHECKING:
    from wheelrail.scenes.schema.scene import RunScene

VEHICLE_FILE = "vehicle_file"  # key of the tables of a vehicle beside those of a scene
TYPES = {"bodies": "body_types", "elements": "element_types"}
KEYS = (*VehicleFileTable.model_fields, *TYPES.values())


def vehicle_tables(file: str | Path) -> dict[str, Any]:
    """Tables of a vehicle file. Raises SceneError."""
    return parse(read_text(Path(file)), file)


def is_of_vehicle(name: str) -> bool:
    """Whether a parameter is a value of a vehicle file: begins with `vehicle.` and one of the file's keys."""
    first, _, rest = name.partition(".")
    return first == "vehicle" and rest.partition(".")[0] in KEYS


def located(name: str, base: Mapping[str, Any]) -> str:
    """Name of a parameter in the tables of a study; a body or element that is missing stands for the type of its name.

    Parameters:
        name: of the parameter.
        base: tables of a scene, with those of the vehicle.
    """
    if VEHICLE_FILE not in base or not is_of_vehicle(name):
        return name
    kind, *rest = name.split(".")[1:]
    vehicle = base[VEHICLE_FILE]
    if kind in TYPES and rest and rest[0] not in vehicle.get(kind, {}) and rest[0] in vehicle.get(TYPES[kind], {}):
        kind = TYPES[kind]
    return ".".join([VEHICLE_FILE, kind, *rest])


def with_own_values(base: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """Tables in which bodies and elements have own values of the parameters, taken from their types.

    Parameters:
        base: tables of a scene, with those of the vehicle.
        names: of the parameters.
    """
    if VEHICLE_FILE not in base:
        return dict(base)
    vehicle = deepcopy(base[VEHICLE_FILE])
    for name in names:
        parts = located(name, base).split(".")
        if parts[0] == VEHICLE_FILE and len(parts) > 3 and parts[1] in TYPES:
            entry = vehicle.get(parts[1], {}).get(parts[2])
            if isinstance(entry, dict) and parts[3] not in entry:
                own = vehicle.get(TYPES[parts[1]], {}).get(entry.get("type"), {})
                entry |= {parts[3]: deepcopy(own[parts[3]])} if parts[3] in own else {}
    return {**base, VEHICLE_FILE: vehicle}


def value_at(base: Mapping[str, Any], name: str) -> Any:
    """Value of a parameter in the tables of a study; None without."""
    at: Any = base
    for key in keys_of(located(name, base)):
        inside = (isinstance(at, Mapping) and key in at) or (isinstance(at, list) and key in range(len(at)))
        at = at[key] if inside else None
    return at


def unit_in_vehicle(name: str, base: Mapping[str, Any]) -> str:
    """Unit of a parameter of a vehicle."""
    kind, *rest = located(name, base).split(".")[1:]
    plain = next((own for own, types in TYPES.items() if types == kind), kind)
    return unit_of(VehicleFileTable, keys_of(".".join([plain, *rest])))


def check_vehicle(tables: Mapping[str, Any], file: str | Path, scene: RunScene) -> None:
    """Raise SceneError for invalid tables of a vehicle, or one that does not fit a scene; file: for errors."""
    check_fit(scene, vehicle_of(tables, file), Path(file))
