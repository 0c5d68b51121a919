"""Values of a dataclass replaced by those of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any, get_args, get_type_hints

from wheelrail.scenes.schema.quantities import refuse
from wheelrail.scenes.schema.wagon_ranges import REACH, WAGON


def overridden(part: Any, values: Mapping[str, Any], prefix: str = "", also: tuple[str, ...] = ()) -> Any:
    """A frozen dataclass with some of its values replaced, tables in it likewise; also: other keys to name as allowed.

    Raises the error of a scene's check for a value that it does not have, of another type, or that it refuses.
    """
    from wheelrail.vehicle.wagon.components import InvalidParameter

    kinds, new = _kinds(type(part)), dict[str, Any]()  # type: ignore[arg-type]
    for key, value in values.items():
        if key not in kinds:
            raise refuse(f"unknown key; allowed are {', '.join((*also, *kinds))}", prefix + key)
        new[key] = _read(kinds[key], getattr(part, key), value, prefix + key)
    try:
        found = replace(part, **new)
    except InvalidParameter as error:
        raise refuse(error.allowed, prefix + error.key) from None
    for key in values:
        _check_plausible(key, getattr(found, key), prefix + key)
    return found


@cache
def _kinds(part: type) -> dict[str, Any]:
    """Of a dataclass's values, by name."""
    return get_type_hints(part)


def _check_plausible(key: str, value: Any, name: str) -> None:
    """Raises the error of a scene's check where a number, or a place of a law, has another unit by the look of it."""
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    if isinstance(value, float) and key in WAGON and not WAGON[key].low <= value <= WAGON[key].high:
        raise refuse(f"must be {WAGON[key]}", name)
    if isinstance(value, ForceLaw) and max(map(abs, value.places)) > (most := REACH[key.endswith("damping")]):
        unit = "m/s" if key.endswith("damping") else "m"
        raise refuse(f"must be of points at most {most:g} {unit} from 0", name)


def _read(kind: Any, old: Any, value: Any, key: str) -> Any:
    """A number, a force law by points, or a table of values for the old dataclass, whichever the kind allows."""
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    kinds = get_args(kind) or (kind,)
    if float in kinds and _number(value):
        return float(value)
    if ForceLaw in kinds and isinstance(value, list):
        return _law(value, key)
    if not {float, ForceLaw} & set(kinds):
        if not isinstance(value, Mapping):
            raise refuse("must be a table", key)
        return overridden(old, value, f"{key}.")
    says = {float: "a number", ForceLaw: "an array of points, each [deflection or velocity, force]"}
    raise refuse(f"must be {' or '.join(says[k] for k in kinds)}", key)


def _law(points: list[Any], key: str) -> Any:
    from wheelrail.vehicle.wagon.force_law import ForceLaw

    if not all(isinstance(p, list) and len(p) == 2 and all(map(_number, p)) for p in points):
        raise refuse("must be an array of points, each [deflection or velocity, force]", key)
    try:
        return ForceLaw(tuple((float(x), float(f)) for x, f in points))
    except ValueError as error:
        raise refuse(f"must be {error}", key) from None


def _number(value: Any) -> bool:
    """Whether it is one, and not beyond floats."""
    return isinstance(value, float) or (isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**1000)
