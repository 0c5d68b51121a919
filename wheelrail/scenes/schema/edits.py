"""Tables of a scene with some values changed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import copy
from pathlib import Path
from typing import Any

from wheelrail.scenes.schema.errors import SceneError


def changed(base: Mapping[str, Any], values: Mapping[str, Any], place: str | Path) -> dict[str, Any]:
    """The tables with values at dotted places: {"vehicle.speed": 30.0, "creepage.0": 1e-3}; new where they differ, else
    those of base themselves.

    Raises SceneError, which place begins, for a key inside something that is no table or array; whether keys of tables
    are known is checked with the scene.
    """
    found = dict(base)
    for name, value in values.items():
        *inner, last = keys_of(name)
        at: Any = found
        for key in inner:
            if isinstance(at, dict) or _inside(at, key):
                at[key] = copy(at.get(key, {}) if isinstance(at, dict) else at[key])
                at = at[key]
            else:
                at = None
        if isinstance(at, dict) or _inside(at, last):
            at[last] = value
        else:
            raise SceneError(f"{place}: {name} = {value!r}: unknown key, the scene has no table or array for it")
    return found


def without(base: Mapping[str, Any], names: Iterable[str], place: str | Path) -> dict[str, Any]:
    """The tables without the values at dotted places; raises SceneError for one that is not there."""
    found = dict(base)
    for name in names:
        *inner, last = keys_of(name)
        at: Any = found
        for key in inner:
            if isinstance(at, dict) and key in at:
                at[key] = copy(at[key])
                at = at[key]
            else:
                at = None
        if not isinstance(at, dict) or last not in at:
            raise SceneError(f"{place}: {name}: must be a key that the scene has")
        del at[last]
    return found


def keys_of(name: str) -> tuple[str | int, ...]:
    """Keys and places in arrays that a dotted name goes through."""
    return tuple(int(part) if part.isdigit() else part for part in name.split("."))


def _inside(at: Any, key: str | int) -> bool:
    return isinstance(at, list) and isinstance(key, int) and key < len(at)
