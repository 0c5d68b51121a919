"""Wagon parameters overridden by a table, with units and plausible ranges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from math import inf
from typing import Any, get_args, get_type_hints

from wheelrail.scenes.schema.quantities import Range, reject

HEIGHT = Range(0.05, 5.0, "m above top of rail")
STIFFNESS = Range(1e3, 1e10, "N/m, or points [m, N]")
DAMPING = Range(0.0, 1e9, "N s/m, or points [m/s, N]")
INERTIA = Range(1.0, 1e9, "kg m2")
PLACE = Range(0.0, 5.0, "m")
SERIES = Range(1e3, inf, "N/m, in series with the damper; inf is none")

WAGON = {
    "mass": Range(50.0, 1e6, "kg", "1 t is 1000", usual=(200.0, 2e5)),
    "roll_inertia": INERTIA,
    "pitch_inertia": INERTIA,
    "yaw_inertia": INERTIA,
    "height": HEIGHT,
    "lateral_stiffness": STIFFNESS,
    "vertical_stiffness": STIFFNESS,
    "lateral_damping": DAMPING,
    "vertical_damping": DAMPING,
    "bending_stiffness": Range(0.0, 1e9, "N m/rad"),
    "spring_y": PLACE,
    "spring_height": HEIGHT,
    "damper_y": PLACE,
    "damper_height": HEIGHT,
    "turn": Range(0.0, 1.0, "fraction of the upper body's roll that rotates the axes of springs and dampers"),
    "lateral_series_stiffness": SERIES,
    "vertical_series_stiffness": SERIES,
    "roll_bar": Range(0.0, 1e10, "N m/rad, per bogie"),
    "bumpstop": Range(0.0, inf, "[m, N], the same in both directions"),
    "bumpstop_height": HEIGHT,
    "gravity": Range(0.0, 30.0, "m/s2"),
}
REACH = {False: 1.0, True: 100.0}  # largest abscissa of a force law: m of a spring or stop, m/s of a damper


def overridden(part: Any, values: Mapping[str, Any], prefix: str = "", also: tuple[str, ...] = ()) -> Any:
    """Frozen dataclass with some values replaced, recursively.

    Parameters:
        part: dataclass.
        values: new values by name; a table for a dataclass.
        prefix: of names in errors.
        also: further allowed keys, for errors.

    Raises the validation error of a scene for an unknown key, another type or an invalid value.
    """
    from wheelrail.vehicle.wagon.components import InvalidParameter

    kinds, new = _kinds(type(part)), dict[str, Any]()  # type: ignore[arg-type]
    for key, value in values.items():
        if key not in kinds:
            raise reject(f"unknown key; allowed are {', '.join((*also, *kinds))}", prefix + key)
        new[key] = _read(kinds[key], getattr(part, key), value, prefix + key)
    try:
        changed = replace(part, **new)
    except InvalidParameter as error:
        raise reject(error.allowed, prefix + error.key) from None
    for key in values:
        _check_plausible(key, getattr(changed, key), prefix + key)
    return changed


@cache
def _kinds(part: type) -> dict[str, Any]:
    """Types of the values of a dataclass, by name."""
    return get_type_hints(part)


def _check_plausible(key: str, value: Any, name: str) -> None:
    """Raises the validation error of a scene for a number, or a point of a force law, outside its plausible range."""
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    if isinstance(value, float) and key in WAGON and not WAGON[key].low <= value <= WAGON[key].high:
        raise reject(f"must be {WAGON[key]}", name)
    if isinstance(value, ForceLaw) and max(map(abs, value.abscissae)) > (limit := REACH[key.endswith("damping")]):
        unit = "m/s" if key.endswith("damping") else "m"
        raise reject(f"must have all points within {limit:g} {unit} of 0", name)


def _read(kind: Any, old: Any, value: Any, key: str) -> Any:
    """A number, a force law by points, or a dataclass with changed values, as the type allows."""
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    kinds = get_args(kind) or (kind,)
    if float in kinds and _number(value):
        return float(value)
    if ForceLaw in kinds and isinstance(value, list):
        return _law(value, key)
    if not {float, ForceLaw} & set(kinds):
        if not isinstance(value, Mapping):
            raise reject("must be a table", key)
        return overridden(old, value, f"{key}.")
    texts = {float: "a number", ForceLaw: "an array of points, each [deflection or velocity, force]"}
    raise reject(f"must be {' or '.join(texts[k] for k in kinds)}", key)


def _law(points: list[Any], key: str) -> Any:
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    if not all(isinstance(p, list) and len(p) == 2 and all(map(_number, p)) for p in points):
        raise reject("must be an array of points, each [deflection or velocity, force]", key)
    try:
        return ForceLaw(tuple((float(x), float(f)) for x, f in points))
    except ValueError as error:
        raise reject(f"must be {error}", key) from None


def _number(value: Any) -> bool:
    """Whether a value is a number within the range of floats."""
    return isinstance(value, float) or (isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**1000)
