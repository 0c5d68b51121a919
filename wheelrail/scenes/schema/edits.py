"""Changes to the tables of a scene."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from copy import copy
from pathlib import Path
from typing import Any

from wheelrail.scenes.schema.errors import SceneError


def changed(base: Mapping[str, Any], values: Mapping[str, Any], place: str | Path) -> dict[str, Any]:
    """Tables with changed values; unchanged tables are shared with the base.

    Parameters:
        base: tables of a scene.
        values: by dotted name: {"vehicle.speed": 30.0, "creepage.0": 1e-3}.
        place: prefix of errors.

    Raises SceneError for a name that leads through a value other than a table or an array; unknown keys are rejected
    later, when the scene is validated.
    """
    data = dict(base)
    for name, value in values.items():
        *inner, last = keys_of(name)
        at: Any = data
        for key in inner:
            if isinstance(at, dict) or _inside(at, key):
                at[key] = copy(at.get(key, {}) if isinstance(at, dict) else at[key])
                at = at[key]
            else:
                at = None
        if isinstance(at, dict) or _inside(at, last):
            at[last] = value
        else:
            raise SceneError(
                f"{place}: {name} = {value!r}: unknown key; must lead through tables and arrays of the scene"
            )
    return data


def without(base: Mapping[str, Any], names: Iterable[str], place: str | Path) -> dict[str, Any]:
    """Tables without the values of dotted names; raises SceneError for a missing one."""
    data = dict(base)
    for name in names:
        *inner, last = keys_of(name)
        at: Any = data
        for key in inner:
            if isinstance(at, dict) and key in at:
                at[key] = copy(at[key])
                at = at[key]
            else:
                at = None
        if not isinstance(at, dict) or last not in at:
            raise SceneError(f"{place}: {name}: must be a key of the scene")
        del at[last]
    return data


def flat(table: Mapping[str, Any], whole: Collection[str] = ()) -> dict[str, Any]:
    """Values by dotted name of nested tables; whole: keys of inner tables that are values themselves."""
    values: dict[str, Any] = {}
    for name, value in table.items():
        if isinstance(value, Mapping) and value and not set(whole) & value.keys():
            values |= {f"{name}.{inner}": below for inner, below in flat(value, whole).items()}
        else:
            values[name] = value
    return values


def keys_of(name: str) -> tuple[str | int, ...]:
    """Keys and array indices of a dotted name."""
    return tuple(int(part) if part.isdigit() else part for part in name.split("."))


def _inside(at: Any, key: str | int) -> bool:
    return isinstance(at, list) and isinstance(key, int) and key < len(at)
